//! The records that a change of the gripper needs (V.3.1 GET-ENDEFF, V.2.1 QC-ATTACH and QC-DETACH). Subtask and E-move
//! would refuse the change for the same reasons, but only when the job has begun.

use std::fmt;

use interfaces::HwsCommand;
use rcs_core::name::{Name10, Name16};
use taskdata::{
    files::{Location, LocptId, RefType, TaskData},
    load::{At, Store},
};

use crate::{finding::Finding, plan::Datum};

/// Grip of a gripper's object that is on the robot (VII.7.3).
pub const WORN: i32 = 1;
/// Grip of a gripper's object with which the bare robot takes it.
pub const TAKEN: i32 = 2;
/// The relative moves that put a gripper into its holster, in order.
pub const PUT: [&str; 3] = ["QCD-DOWN", "QCD-SEAT", "QCD-UP"];
/// The relative moves that take it out, in order.
pub const TAKE: [&str; 5] = ["QCA-FAST", "QCA-SLOW", "QCA-BACK", "QCA-LIFT", "QCA-UP"];
/// The objects of the grippers with `endeff-id#` 1 to 3.
const GRIPPERS: [&str; 3] = ["GRIPPER-1", "GRIPPER-2", "GRIPPER-3"];

/// A record that the task data need for the change of a gripper, and do not have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lacking {
    pub gripper: Name16,
    what: What,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum What {
    /// It is no object, or has no such grip.
    Grip(i32),
    /// It is assigned to no location point.
    Holster,
    /// The grip has no movetable at the holster.
    Movetable(i32, Name10),
    /// There is no approach with the grip.
    Approach(i32, Name10),
    Move(&'static str, Name10),
}

impl fmt::Display for Lacking {
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

impl Lacking {
    /// What to write into the task data.
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

    /// The finding of a command, and the record that it blames: the gripper's, or that of the object which needs the
    /// gripper.
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

/// A finding about the change of a gripper.
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

/// The gripper that a command has to fetch, by its end effector id; `None` if the attached one is right, or any is.
#[must_use]
pub fn wanted(command: &HwsCommand, attached: Option<u8>, data: &TaskData<'_>) -> Option<u8> {
    let grips = data.obj_grips(&command.object?)?;
    u8::try_from(grips.endeff_id).ok().filter(|id| *id != 0 && Some(*id) != attached)
}

/// The first missing record for fetching a gripper and leaving the attached one; `None` if there are all. Then it does
/// not allocate.
#[must_use]
pub fn lacking(attached: Option<u8>, wanted: u8, data: &TaskData<'_>) -> Option<Lacking> {
    let put =
        attached.and_then(|own| holster(own, WORN, data).and_then(|at| moves(own, &at, &PUT, data)).err());
    let take = || holster(wanted, TAKEN, data).and_then(|at| moves(wanted, &at, &TAKE, data)).err();
    put.or_else(take)
}

fn moves(id: u8, at: &Location, names: &[&'static str], data: &TaskData<'_>) -> Result<(), Lacking> {
    let known = |name: &str| data.relative_move(&Name16::clipped(name), &at.place).is_some();
    match names.iter().find(|name| !known(name)) {
        Some(name) => Err(Lacking { gripper: object_of(id), what: What::Move(name, at.name) }),
        None => Ok(()),
    }
}

/// The object of the gripper with an end effector id.
#[must_use]
pub fn object_of(id: u8) -> Name16 {
    let name = usize::from(id).checked_sub(1).and_then(|at| GRIPPERS.get(at));
    Name16::clipped(name.copied().unwrap_or_default())
}

/// The holster of a gripper: the location point that is assigned to its object (VII.7.3).
///
/// # Errors
/// [`Lacking`] if the task data do not have it, or no motion to it with the grip.
pub fn holster(id: u8, grip: i32, data: &TaskData<'_>) -> Result<Location, Lacking> {
    let gripper = object_of(id);
    let lacks = |what| Lacking { gripper, what };
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
