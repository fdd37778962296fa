//! Subtask and E-move (V.2.2).

use core::fmt;

use crate::{
    Plain,
    interface::{
        ChangingPose, Header, Reason, Report, device::VisionRequest, grip::GripCommand, jaws::JawsCommand,
        prim::PrimCommand, quick_change::QuickChangeCommand, subtask::LocationKind,
    },
    name::{Name10, Name16},
    pose::Pose,
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
    /// `obj-para-^`: record of END-EFF-PARA.
    pub object_parameters: u32,
    /// `obj-grip-loc-^`: record of OBJ-GRIPS.
    pub object_grips: u32,
    /// `obj-vision-para-^`: record of VISION-PARA, 0 if vision is not used.
    pub object_vision: u32,
    /// `locpt-name`.
    pub location: Name10,
    /// `locpt-type`.
    pub location_kind: LocationKind,
    /// `locpt-^-in`: record of LOCPT.
    pub location_record: u32,
    /// Record of ARRAY-TABLE if the location is a sector (extension); 0 for none.
    pub location_array: u32,
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
    /// `ref-pose-^`: the feedback pose.
    pub reference_pose: u32,
    /// `obj-held-status-out`.
    pub object_held: bool,
    /// `pres-endeff-id#-out`.
    pub end_effector_id: u8,
    /// Name of the object held (extension).
    pub held_object: Name16,
    /// Where the robot is: location of the last completed move; empty if unknown (extension).
    pub at: Name10,
}

/// An object and how it is gripped: approach and depart points belong to both.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct ObjectGrip {
    /// The object.
    pub object: Name16,
    /// Its grip number.
    pub grip: i32,
}

/// What a move goes to. It decides which data lead there, and away from there.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub enum GoneTo {
    /// A location as such.
    Location,
    /// An object at a location, or a held object's destination.
    Object(ObjectGrip),
    /// The place from which pictures of an object are taken.
    View(ObjectGrip),
    /// The tool drum, with the fingers around a tool in it: only the tool commands lead away from there.
    Drum,
}

/// A place of the robot: where a move ended, or where one leads.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct RobotPlace {
    /// What is gone to.
    pub gone_to: GoneTo,
    /// Name of the location.
    pub location: Name10,
    /// What the location is.
    pub kind: LocationKind,
    /// Its record of LOCPT.
    pub record: u32,
    /// Its record of ARRAY-TABLE.
    pub array: u32,
    /// Where the tool is there.
    pub pose: Pose,
}

/// Part of a way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Leg {
    /// The depart points of the place left.
    Depart,
    /// The points of the intermediate trajectory.
    Trajectory,
    /// The approach points of the goal, and the goal.
    Approach,
}

/// Which way the robot goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Direction {
    /// To the goal.
    Forward,
    /// Back to the end of the depart leg.
    Back,
}

/// The way that the robot is on: published so that an interrupted move can go on (docs/design/recovery.md).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Way {
    /// The place left.
    pub from: RobotPlace,
    /// The goal.
    pub to: RobotPlace,
    /// The next point in the direction of the goal, from 0, through all legs; the goal is the last.
    pub next: u16,
    /// The leg of that point.
    pub leg: Leg,
    /// It leads straight from one pose to the other, without points, as that of the camera over a part.
    pub straight: bool,
    /// Which way the robot went last.
    pub direction: Direction,
    /// Where the robot was commanded to be last.
    pub rest: Pose,
    /// The joystick box has moved the robot since.
    pub by_hand: bool,
}

/// What the attached gripper holds, by its sensors.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub enum Holding {
    /// Nothing.
    Nothing,
    /// An object that was grasped and is still felt.
    Object(ObjectGrip),
    /// Something that was not grasped by name.
    Something,
    /// The sensors cannot tell. Counts as held.
    NotKnown,
}

/// What the gripper holds, or has tried to grasp.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Grasped {
    /// The object and its grip.
    pub object: ObjectGrip,
    /// Its record of END-EFF-PARA.
    pub parameters: u32,
    /// `endeff-id#` of the gripper that holds it.
    pub gripper: u8,
    /// Grasp size of the object, 0.01 in.
    pub grasp_size: i32,
    /// Opening when it was grasped, 0.01 in.
    pub opening: i32,
    /// Where the robot stood.
    pub pose: Pose,
}

/// An object that vision has located and that nothing has moved since.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Located {
    /// The object.
    pub object: Name16,
    /// Record of LOCPT where it is.
    pub record: u32,
    /// Record of ARRAY-TABLE where it is.
    pub array: u32,
    /// Its part frame.
    pub pose: Pose,
}

/// What E-move believes of the world and cannot read from a sensor alone. It is an output, so that E-move has
/// it again after a restart; each belief counts only as long as the sensors do not contradict it.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Beliefs {
    /// Where the robot stands.
    pub place: Option<RobotPlace>,
    /// The way that it is on.
    pub way: Option<Way>,
    /// What the gripper holds.
    pub held: Option<Grasped>,
    /// What it was told last to grasp.
    pub grasping: Option<Grasped>,
    /// The fingers were empty, and have not been told to close since.
    pub empty: bool,
    /// The object that the gripper has let go, and where.
    pub placed: Option<RobotPlace>,
    /// What vision has located.
    pub located: Option<Located>,
    /// The place of the holster in which the robot changes a gripper.
    pub exchange: Option<RobotPlace>,
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
    /// What E-move believes (extension).
    pub beliefs: Beliefs,
    /// Departure, goal, point between, located object.
    pub poses: [ChangingPose; EMOVE_POSES],
}

/// `MOV-TO-OBJ LINKBAR1 at TRAY`.
impl fmt::Display for EmoveCommand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        words(f, self.command.text(), &[&self.object, &Place("at", &self.location, 0)])
    }
}
