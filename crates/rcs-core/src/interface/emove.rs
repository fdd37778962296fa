//! Subtask and E-move (V.2.2).

use core::fmt;

use crate::{
    Plain,
    interface::{
        ChangingPose, Header, Reason, Report, device::VisionRequest, grip::GripCommand, jaws::JawsCommand,
        prim::PrimCommand, quick_change::QuickChangeCommand, subtask::LocationKind,
    },
    name::{Name10, Name16},
};

use super::words::{Place, words};

/// Commands of E-move (V.2.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
#[text(upper)]
pub enum EmoveVerb {
    /// None yet.
    #[text = ""]
    None,
    /// Do nothing.
    #[text = "E-PAUSE"]
    Pause,
    /// Move to a location.
    MovToLoc,
    /// Move to an object at a location, fingers open for it.
    MovToObj,
    /// Move the held object to a location.
    MovObjTo,
    /// Move to where pictures are taken.
    MovToVu,
    /// Find the object with the vision system.
    LocateObj,
    /// Close the fingers on the object.
    GraspObj,
    /// Open the fingers.
    Release,
    /// Move to a holster, fingers closed for it.
    MovToHol,
    /// Put the attached gripper into the holster and leave it there.
    QcDetach,
    /// Take the gripper out of the holster.
    QcAttach,
    /// A DELTA-MOVE from above.
    Withdraw,
    /// Insert a tool into the tool drum.
    InsertTool,
    /// Let go of a tool in the drum.
    ReleaseTool,
    /// Move to a tool in the drum and grasp it.
    AcquireTool,
    /// Pull a tool out of the drum.
    RemoveTool,
}

/// Command from Subtask to E-move.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct EmoveCommand {
    /// `command-#-in`.
    pub number: u32,
    /// `"command-in"`.
    pub command: EmoveVerb,
    /// `"obj"`.
    pub object: Name16,
    /// Grip number of the object (extension: the manual has it only in the records that `obj-para-^` names).
    pub grip: i32,
    /// `obj-para-^`: record of END-EFF-PARA, if the object has that grip.
    pub object_parameters: Option<u32>,
    /// `obj-grip-loc-^`: record of OBJ-GRIPS, if an object is named.
    pub object_grips: Option<u32>,
    /// `obj-vision-para-^`: record of VISION-PARA, if vision is used.
    pub object_vision: Option<u32>,
    /// `locpt-name`.
    pub location: Name10,
    /// `locpt-type`.
    pub location_kind: LocationKind,
    /// `locpt-^-in`: record of LOCPT; a static array has none.
    pub location_record: Option<u32>,
    /// Record of ARRAY-TABLE if the location is a sector (extension).
    pub location_array: Option<u32>,
    /// `pose-^-in`: the goal pose.
    pub pose: u32,
    /// `endeff-id#-in`.
    pub end_effector_id: u8,
}

/// Status from E-move to Subtask.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct EmoveStatus {
    /// `command-#-echo-out`.
    pub echo: u32,
    /// `status-report`.
    pub report: Report,
    /// `status-para-out`.
    pub reason: Reason,
    /// `ref-pose-^`: the feedback pose, if the resolvers can be believed.
    pub reference_pose: Option<u32>,
    /// `obj-held-status-out`: the object held (its name is an extension).
    pub held: Option<Name16>,
    /// `pres-endeff-id#-out`.
    pub end_effector_id: u8,
    /// Where the robot is, if that is known: location of the last completed move (extension).
    pub at: Option<Name10>,
}

/// Dormancy flags of the gripper processes (II.2.3): a dormant process is not stepped.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Dormancy {
    /// Grip.
    pub grip: bool,
    /// V-Grip.
    pub v_grip: bool,
    /// Tool-Grip.
    pub tool_grip: bool,
}

/// Changing poses of E-move: the pose departed from, the goal, a point between, and the located object.
pub const EMOVE_POSES: usize = 4;

/// Output buffers of E-move.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct EmoveOutputs {
    /// Stamp and row.
    pub header: Header,
    /// To Subtask.
    pub status: EmoveStatus,
    /// To Prim.
    pub prim: PrimCommand,
    /// To Quick Change.
    pub quick_change: QuickChangeCommand,
    /// To Grip.
    pub grip: GripCommand,
    /// To V-Grip.
    pub v_grip: JawsCommand,
    /// To Tool-Grip.
    pub tool_grip: JawsCommand,
    /// Which gripper processes are dormant (II.2.3): all but that of the attached gripper.
    pub dormant: Dormancy,
    /// To the vision system.
    pub vision: VisionRequest,
    /// Departure, goal, point between, located object.
    pub poses: [ChangingPose; EMOVE_POSES],
}

/// `MOV-TO-OBJ LINKBAR1 at TRAY`.
impl fmt::Display for EmoveCommand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        words(f, self.command.text(), &[&self.object, &Place("at", &self.location, 0)])
    }
}
