//! Objects and locations of commands to E-move.
//!
//! Task names one location with each command. Holsters, pedestal and tool drum are looked up when the command
//! arrives, before anything moves, and their poses are published in Subtask's own changing records.

use geometry::pose::Pose;
use interfaces::{
    emove::{EmoveCommand, EmoveVerb, Holding},
    location::Site,
    subtask::{SubtaskCommand, SubtaskVerb},
};
use rcs_core::{
    Plain,
    name::{Name10, Name16},
};
use taskdata::files::{EndEffId, Location, LocptId, RefType, TaskData, VisionId};

use crate::places::{Missing, named};

/// By convention (VII.7), the grip of a holster's object with which the robot puts its gripper in.
const PUT_IN: i32 = 1;
/// The grip with which the bare robot takes the gripper out.
const TAKE_OUT: i32 = 2;
/// The grippers 1, 2 and 3 as objects that can be placed in holsters.
pub const GRIPPERS: [&str; 3] = ["GRIPPER-1", "GRIPPER-2", "GRIPPER-3"];

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct SubtaskAim {
    pub object: Option<Name16>,
    pub grip: i32,
    pub parameters: EndEffId, // record of END-EFF-PARA, if the object has that grip
    pub end_effector_id: Option<u8>,
    pub site: Site,
    pub pose: Option<u32>, // record number, once it is assigned
}

/// The targets that a command of Task does not name, and their poses.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Aims {
    /// GET-ENDEFF: the holster of the attached gripper. FIX-GRIP: the object, moved to the pedestal. Tool commands:
    /// the drum.
    pub first: SubtaskAim,
    /// GET-ENDEFF: the holster of the wanted gripper. FIX-GRIP: the robot at PED-SAFE.
    pub second: SubtaskAim,
    /// FIX-GRIP: the object, taken from the pedestal, at the pose of `first`.
    pub third: SubtaskAim,
    pub poses: [Pose; 2], // poses of `first` and `second`
}

impl SubtaskAim {
    #[must_use]
    pub const fn of_command(command: &SubtaskCommand) -> Self {
        // The object is taken with the source grip and placed with the destination grip.
        let grip = match command.command {
            SubtaskVerb::PlaceObj | SubtaskVerb::MoveObjToDest => command.destination_grip,
            SubtaskVerb::Position if command.source_grip == 0 => command.destination_grip,
            _ => command.source_grip,
        };
        Self {
            object: command.object,
            grip,
            parameters: command.object_parameters,
            end_effector_id: command.end_effector_id,
            site: command.site,
            pose: command.pose,
        }
    }

    /// A location without an object; its pose record is not assigned yet.
    const fn at(site: Site, end_effector_id: Option<u8>) -> Self {
        Self { object: None, grip: 0, parameters: EndEffId::NULL, end_effector_id, site, pose: None }
    }

    fn with_object(self, object: Option<Name16>, grip: i32, data: &TaskData<'_>) -> Result<Self, Missing> {
        let (id, _) = object.and_then(|object| data.object(&object, grip)).ok_or(Missing::Grip)?;
        Ok(Self { object, grip, parameters: id, ..self })
    }

    /// The same target in the grip in which the object is held.
    #[must_use]
    pub fn as_held(self, held: &Holding, data: &TaskData<'_>) -> Self {
        match held {
            Holding::Object(held) => self.with_object(Some(held.object), held.grip, data).unwrap_or(self),
            Holding::Nothing | Holding::Something | Holding::NotKnown => self,
        }
    }

    #[must_use]
    pub fn command(&self, verb: EmoveVerb, data: &TaskData<'_>) -> EmoveCommand {
        let (object, place) = (self.object.as_ref(), self.site.place());
        EmoveCommand {
            number: 0,
            command: verb,
            object: self.object,
            grip: self.grip,
            object_parameters: self.parameters,
            object_grips: object.and_then(|object| data.obj_grips_id(object)).unwrap_or_default(),
            object_vision: object
                .and_then(|object| data.view(object, &place))
                .map_or(VisionId::NULL, |(id, _)| id),
            site: self.site,
            pose: self.pose,
            end_effector_id: self.end_effector_id,
        }
    }
}

impl Aims {
    /// `attached` is the id of the gripper on the robot, `exchange` that of an interrupted exchange. The error is the
    /// first data that the command needs and the task data lack.
    pub fn new(
        command: &SubtaskCommand,
        attached: Option<u8>,
        exchange: Option<u8>,
        data: &TaskData<'_>,
    ) -> Result<Self, Missing> {
        match command.command {
            SubtaskVerb::GetEndeff => Self::holsters(command.end_effector_id, attached, exchange, data),
            SubtaskVerb::FixGrip => Self::pedestal(command, data),
            SubtaskVerb::InsertTool
            | SubtaskVerb::ReleaseTool
            | SubtaskVerb::AcquireTool
            | SubtaskVerb::RemoveTool => Self::drum(command, data),
            SubtaskVerb::None
            | SubtaskVerb::Pause
            | SubtaskVerb::GetObject
            | SubtaskVerb::PlaceObj
            | SubtaskVerb::GotoEndpt
            | SubtaskVerb::GotoDest
            | SubtaskVerb::MoveObjToDest
            | SubtaskVerb::Position
            | SubtaskVerb::Release => Ok(Self::default()),
        }
    }

    fn holsters(
        wanted: Option<u8>,
        attached: Option<u8>,
        exchange: Option<u8>,
        data: &TaskData<'_>,
    ) -> Result<Self, Missing> {
        let mut aims = Self::default();
        // An interrupted exchange is finished in its own holster.
        let own = exchange.or(attached);
        let wanted = wanted.or(own);
        if exchange.is_none() && attached.is_some() && attached == wanted {
            return Ok(aims);
        }
        let [own_pose, wanted_pose] = &mut aims.poses;
        if let Some(own) = own.filter(|_| own != wanted) {
            aims.first = holster(own, PUT_IN, data, own_pose)?;
        }
        aims.second = holster(wanted.ok_or(Missing::Holster)?, TAKE_OUT, data, wanted_pose)?;
        Ok(aims)
    }

    /// FIX-GRIP: the object at the pedestal in both grips, and PED-SAFE, where the robot waits.
    fn pedestal(command: &SubtaskCommand, data: &TaskData<'_>) -> Result<Self, Missing> {
        let (pedestal, safe) = (point(named::PEDESTAL, data)?, point(named::PED_SAFE, data)?);
        let at = SubtaskAim::at(pedestal.site(), command.end_effector_id);
        Ok(Self {
            first: at.with_object(command.object, command.source_grip, data)?,
            second: SubtaskAim::at(safe.site(), command.end_effector_id),
            third: at.with_object(command.object, command.destination_grip, data)?,
            poses: [Pose::from_frame(&pedestal.frame), Pose::from_frame(&safe.frame)],
        })
    }

    fn drum(command: &SubtaskCommand, data: &TaskData<'_>) -> Result<Self, Missing> {
        let location = point(named::TOOL_TRNS, data)?;
        let at = SubtaskAim::at(location.site(), command.end_effector_id);
        let first = SubtaskAim {
            object: command.object,
            grip: command.source_grip,
            parameters: command.object_parameters,
            ..at
        };
        let poses = [Pose::from_frame(&location.frame), Pose::default()];
        Ok(Self { first, poses, ..Self::default() })
    }
}

fn holster(id: u8, grip: i32, data: &TaskData<'_>, pose: &mut Pose) -> Result<SubtaskAim, Missing> {
    let name = usize::from(id).checked_sub(1).and_then(|position| GRIPPERS.get(position));
    let object = Name16::clipped(name.ok_or(Missing::Holster)?);
    let record = data.object_named(&object).ok_or(Missing::Holster)?;
    let assigned = data
        .object_locations(record)
        .find(|assigned| assigned.kind == RefType::LocationPoint)
        .ok_or(Missing::Holster)?;
    let point = LocptId::new(assigned.number);
    let locpt = data.locpt(point).ok_or(Missing::Holster)?;
    *pose = Pose::from_frame(&locpt.frame);
    SubtaskAim::at(Site::point(locpt.name, point), Some(id)).with_object(Some(object), grip, data)
}

fn point(name: &str, data: &TaskData<'_>) -> Result<Location, Missing> {
    data.resolve_location(&Name10::clipped(name), None, None::<&Name16>).map_err(Missing::from)
}
