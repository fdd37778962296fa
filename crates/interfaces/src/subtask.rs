//! Task and Subtask (V.3.2).

use core::fmt;

use rcs_core::{Plain, name::Name16};

use super::words::{location, name};
use crate::{
    ChangingPose, Header, Reason, StatusReport, Unconfirmed,
    emove::{EmoveCommand, Holding, Offset, Pins, PlacedObject, Seat, Standing},
    location::Site,
    pedestal::PedestalCommand,
    record_number::EndEffId,
};

/// Commands of Subtask (V.3.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
#[text(upper)]
pub enum SubtaskVerb {
    /// No command yet.
    #[text = ""]
    None,
    /// Do nothing.
    #[text = "S-PAUSE"]
    Pause,
    /// Attach the gripper for the object.
    GetEndeff,
    /// Move to an object and grasp it.
    GetObject,
    /// Move an object to a location and release it.
    PlaceObj,
    /// Move to the end-at location.
    GotoEndpt,
    /// Move to the destination.
    GotoDest,
    /// Move an object to the destination and hold it there.
    #[text = "MOVE-OBJ>D"]
    MoveObjToDest,
    /// Move to a position with the parameters of an object.
    #[text = ">POSITION"]
    Position,
    /// Open the gripper.
    Release,
    /// Regrip the object with the Active Pedestal.
    FixGrip,
    /// Insert a tool into the tool drum.
    InsertTool,
    /// Release a tool in the drum.
    ReleaseTool,
    /// Move to a tool in the drum and grasp it.
    AcquireTool,
    /// Pull a tool out of the drum.
    RemoveTool,
}

/// Command from Task to Subtask.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct SubtaskCommand {
    /// `command-#-in`.
    pub number: u32,
    /// `"command-in"`.
    pub command: SubtaskVerb,
    /// `"obj"`, if one is named.
    pub object: Option<Name16>,
    /// `obj-endeff-id#`; none if any gripper is suitable.
    pub end_effector_id: Option<u8>,
    /// `src-grip-#-in`.
    pub source_grip: i32,
    /// `dst-grip-#-in`.
    pub destination_grip: i32,
    /// `obj-para-^`: record of END-EFF-PARA, if the object has that grip.
    pub object_parameters: EndEffId,
    /// `locpt-name-in`, `locpt-type-in` and `locpt-^-in`.
    pub site: Site,
    /// `pose-^-in`: the goal, a T-POSE of Task, if a location is named.
    pub pose: Option<u32>,
}

/// Status from Subtask to Task.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct SubtaskStatus {
    /// `command-#-echo`.
    pub echo: u32,
    /// `status-report`.
    pub report: StatusReport,
    /// `status-para-out`.
    pub reason: Reason,
    /// Part of the goal that no sensor confirms, with `done` (extension).
    pub unconfirmed: Unconfirmed,
    /// `ref-pose-^-out`: the feedback pose, as E-move reports it.
    pub reference_pose: Option<u32>,
    /// `obj-held-status-out`: the held object, as E-move reports it (more than yes or no is an extension).
    pub held: Holding,
    /// Position of the object along the fingers, or at its release, as E-move reports it (extension).
    pub seat: Seat,
    /// The object of the last RELEASE, as E-move reports it (extension).
    pub placed: Option<PlacedObject>,
    /// `pres-endeff-id#-out`, if a gripper is attached.
    pub end_effector_id: Option<u8>,
    /// Confirmation of the gripper by the id pins, as E-move reports it (extension).
    pub pins: Pins,
    /// The robot's place, if E-move knows it (extension).
    pub at: Option<Standing>,
    /// Distance of the robot from its place, as E-move reports it (extension).
    pub offset: Offset,
    /// The fingers surround a tool in the tool drum, as E-move reports it (extension).
    pub drum: bool,
    /// The part is in the pedestal's hand, possibly also in the robot's gripper (extension).
    pub pedestal_part: bool,
}

/// The part that Subtask passed to the pedestal's hand. As an output it survives a restart of Subtask
/// (docs/design/recovery.md "Estimates"). It is valid as long as the hand senses a part.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Regrip {
    /// The object.
    pub object: Name16,
}

/// Changing poses of Subtask for locations that no Task command names (holster, pedestal), used alternately.
pub const SUBTASK_POSES: usize = 2;

/// Output buffers of Subtask.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct SubtaskOutputs {
    /// Stamp and row.
    pub header: Header,
    /// To Task.
    pub status: SubtaskStatus,
    /// To E-move.
    pub emove: EmoveCommand,
    /// To the Active Pedestal.
    pub pedestal: PedestalCommand,
    /// The part in the pedestal's hand (extension).
    pub regrip: Option<Regrip>,
    /// Poses of locations that no Task command names.
    pub poses: [ChangingPose; SUBTASK_POSES],
}

/// `GET-OBJECT LINKBAR1 at TRAY`, `GET-ENDEFF gripper 1`: the verb with its fields.
impl fmt::Display for SubtaskCommand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.command.text())?;
        let (object, at) = (self.object.as_ref(), self.site.name());
        match self.command {
            SubtaskVerb::None | SubtaskVerb::Pause => Ok(()),
            SubtaskVerb::GetEndeff => self.end_effector_id.map_or(Ok(()), |id| write!(f, " gripper {id}")),
            SubtaskVerb::GotoEndpt | SubtaskVerb::GotoDest => location(f, "at", at, None),
            SubtaskVerb::Release
            | SubtaskVerb::FixGrip
            | SubtaskVerb::InsertTool
            | SubtaskVerb::ReleaseTool
            | SubtaskVerb::AcquireTool
            | SubtaskVerb::RemoveTool => name(f, object),
            SubtaskVerb::GetObject
            | SubtaskVerb::PlaceObj
            | SubtaskVerb::MoveObjToDest
            | SubtaskVerb::Position => {
                name(f, object)?;
                location(f, "at", at, None)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emove::EmoveVerb;
    use rcs_core::name::Name10;

    #[test]
    fn command_text_has_only_the_fields_of_its_verb() {
        let full = SubtaskCommand {
            object: Some(Name16::clipped("LINKBAR1")),
            end_effector_id: Some(2),
            site: Site { location: Name10::clipped("TRAY"), ..Site::default() },
            ..SubtaskCommand::default()
        };
        for (command, text) in [
            (SubtaskVerb::Pause, "S-PAUSE"),
            (SubtaskVerb::GetEndeff, "GET-ENDEFF gripper 2"),
            (SubtaskVerb::GotoEndpt, "GOTO-ENDPT at TRAY"),
            (SubtaskVerb::Release, "RELEASE LINKBAR1"),
            (SubtaskVerb::PlaceObj, "PLACE-OBJ LINKBAR1 at TRAY"),
        ] {
            assert_eq!(SubtaskCommand { command, ..full }.to_string(), text);
        }
        let full = EmoveCommand { object: full.object, site: full.site, ..EmoveCommand::default() };
        for (command, text) in [
            (EmoveVerb::Pause, "E-PAUSE"),
            (EmoveVerb::MovToLoc, "MOV-TO-LOC at TRAY"),
            (EmoveVerb::Release, "RELEASE LINKBAR1"),
            (EmoveVerb::GraspObj, "GRASP-OBJ LINKBAR1 at TRAY"),
        ] {
            assert_eq!(EmoveCommand { command, ..full }.to_string(), text);
        }
    }
}
