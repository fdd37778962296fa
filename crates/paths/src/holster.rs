//! The records that a change of the gripper needs (V.3.1 GET-ENDEFF, V.2.1 QC-ATTACH and QC-DETACH), checked before
//! the job begins. Subtask and E-move check them only on the way.

use std::fmt;

use interfaces::HwsCommand;
use rcs_core::name::{Name10, Name16};
use taskdata::{
    files::{Location, LocptId, RefType, TaskData},
    load::{At, Store},
};

use crate::{finding::Finding, plan::Datum};

pub const WORN: i32 = 1; // of a gripper's object on the robot (VII.7.3)
pub const TAKEN: i32 = 2; // with which the bare robot takes a gripper
pub const PUT: [&str; 3] = ["QCD-DOWN", "QCD-SEAT", "QCD-UP"]; // moves into the holster, in order
/// The moves out of the holster, in order.
pub const TAKE: [&str; 5] = ["QCA-FAST", "QCA-SLOW", "QCA-BACK", "QCA-LIFT", "QCA-UP"];
const GRIPPERS: [&str; 3] = ["GRIPPER-1", "GRIPPER-2", "GRIPPER-3"]; // `endeff-id#` 1 to 3

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MissingRecord {
    pub gripper: Name16,
    what: What,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum What {
    Grip(i32),              // no such object or grip
    Holster,                // assigned to no location point
    Movetable(i32, Name10), // none for the grip at the holster
    Approach(i32, Name10),  // none with the grip
    Move(&'static str, Name10),
}

impl fmt::Display for MissingRecord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { gripper, what } = self;
        write!(f, "GET-ENDEFF needs the holster of {gripper}: ")?;
        match what {
            What::Grip(grip) => write!(f, "no object form has {gripper} with grip {grip:+}"),
            What::Holster => write!(f, "{gripper} is assigned to no location point"),
            What::Movetable(grip, at) => write!(f, "grip {grip:+} of {gripper} has no movetable at {at}"),
            What::Approach(grip, at) => write!(f, "grip {grip:+} of {gripper} has no approach at {at}"),
            What::Move(name, at) => write!(f, "there is no relative move {name} at {at}"),
        }
    }
}

impl MissingRecord {
    #[must_use]
    pub fn help(&self) -> String {
        let Self { gripper, what } = self;
        match what {
            What::Grip(grip) => format!("add `-obj- {gripper} {grip}` with its sizes (VII.7.1)"),
            What::Holster => format!(
                "add `-o-loc- {gripper} lpt` with its holster (VII.7.3), and check the name of that location point"
            ),
            What::Movetable(grip, at) => format!("add `-grip- {gripper} {grip} lpt {at}` (VII.7.5)"),
            What::Approach(grip, at) => format!("add `-appr obj {gripper} {grip} lpt {at}` (VII.7.7)"),
            What::Move(name, at) => format!("add `-rel- {name} lpt {at}`, see data/guarded.blk"),
        }
    }

    /// The finding names the record of the gripper, or of the object that needs it.
    #[must_use]
    pub fn finding(&self, command: &HwsCommand, store: &Store) -> Finding {
        finding(&self.to_string(), Some(self.help()), self.datum(command, store))
    }

    fn datum(&self, command: &HwsCommand, store: &Store) -> Option<Datum> {
        let (data, origins) = (store.view(), store.origins());
        let of_gripper =
            || Some((self.gripper, *origins.objects.get(data.object_named(&self.gripper)?.index()?)?));
        let of_object = || {
            let object = command.object?;
            Some((object, *origins.obj_grips.get(data.obj_grips_id(&object)?.index()?)?))
        };
        of_gripper().or_else(of_object).map(|(name, at): (Name16, At)| Datum { name: name.to_string(), at })
    }
}

#[must_use]
pub fn finding(message: &str, help: Option<String>, datum: Option<Datum>) -> Finding {
    Finding {
        code: "path.gripper",
        error: true,
        line: 0,
        message: message.to_owned(),
        help,
        data: datum.into_iter().collect(),
        key: format!("path.gripper {message}"),
        depth: 0.0,
    }
}

/// End effector id to fetch; `None` if the attached gripper is right, or if the command needs none.
#[must_use]
pub fn wanted(command: &HwsCommand, attached: Option<u8>, data: &TaskData<'_>) -> Option<u8> {
    let grips = data.obj_grips(&command.object?)?;
    u8::try_from(grips.endeff_id).ok().filter(|id| *id != 0 && Some(*id) != attached)
}

/// The first missing record for a change of gripper. Does not allocate if there is none.
#[must_use]
pub fn lacking(attached: Option<u8>, wanted: u8, data: &TaskData<'_>) -> Option<MissingRecord> {
    let put =
        attached.and_then(|own| holster(own, WORN, data).and_then(|at| moves(own, &at, &PUT, data)).err());
    let take = || holster(wanted, TAKEN, data).and_then(|at| moves(wanted, &at, &TAKE, data)).err();
    put.or_else(take)
}

fn moves(id: u8, at: &Location, names: &[&'static str], data: &TaskData<'_>) -> Result<(), MissingRecord> {
    let known = |name: &str| data.relative_move(&Name16::clipped(name), &at.place).is_some();
    match names.iter().find(|name| !known(name)) {
        Some(name) => Err(MissingRecord { gripper: object_of(id), what: What::Move(name, at.name) }),
        None => Ok(()),
    }
}

#[must_use]
pub fn object_of(id: u8) -> Name16 {
    let name = usize::from(id).checked_sub(1).and_then(|at| GRIPPERS.get(at));
    Name16::clipped(name.copied().unwrap_or_default())
}

/// The location point that is assigned to the gripper's object (VII.7.3).
pub fn holster(id: u8, grip: i32, data: &TaskData<'_>) -> Result<Location, MissingRecord> {
    let gripper = object_of(id);
    let lacks = |what| MissingRecord { gripper, what };
    for needed in [WORN, grip] {
        data.object(&gripper, needed).ok_or_else(|| lacks(What::Grip(needed)))?;
    }
    let record = data.object_named(&gripper).ok_or_else(|| lacks(What::Grip(grip)))?;
    let mut assigned = data.object_locations(record).filter(|one| one.kind == RefType::LocationPoint);
    let point = assigned.next().and_then(|one| data.locpt(LocptId::new(one.number)));
    let at = point.and_then(|point| data.resolve_location::<10, 16>(&point.name, None, None).ok());
    let at = at.ok_or_else(|| lacks(What::Holster))?;
    data.grip_movetable(&gripper, grip, &at.place).ok_or_else(|| lacks(What::Movetable(grip, at.name)))?;
    data.approach(&gripper, grip, &at.place).ok_or_else(|| lacks(What::Approach(grip, at.name)))?;
    Ok(at)
}
