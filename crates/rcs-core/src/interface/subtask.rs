//! Task and Subtask (V.3.2).

use crate::{
    coded_enum,
    interface::{ChangingPose, Header, Reason, Report, emove::EmoveCommand, pedestal::PedestalCommand},
    name::{Name10, Name16},
    record,
};

coded_enum! {
    /// Commands of Subtask (V.3.1).
    pub enum SubtaskVerb {
        /// None yet.
        None = "",
        /// Do nothing.
        Pause = "S-PAUSE",
        /// Connect the proper gripper.
        GetEndeff = "GET-ENDEFF",
        /// Move to an object and grasp it.
        GetObject = "GET-OBJECT",
        /// Move an object to a location and release it.
        PlaceObj = "PLACE-OBJ",
        /// Move to the end-at location.
        GotoEndpt = "GOTO-ENDPT",
        /// Move to the destination.
        GotoDest = "GOTO-DEST",
        /// Move an object to the destination and hold it there.
        MoveObjToDest = "MOVE-OBJ>D",
        /// Move to a position with the parameters of an object.
        Position = ">POSITION",
        /// Open the gripper.
        Release = "RELEASE",
        /// Regrip the object with the Active Pedestal.
        FixGrip = "FIX-GRIP",
        /// Insert a tool into the tool drum.
        InsertTool = "INSERT-TOOL",
        /// Let go of a tool in the drum.
        ReleaseTool = "RELEASE-TOOL",
        /// Move to a tool in the drum and grasp it.
        AcquireTool = "ACQUIRE-TOOL",
        /// Pull a tool out of the drum.
        RemoveTool = "REMOVE-TOOL",
    }
}

coded_enum! {
    /// `locpt-type`: what a location is (VII.3 to VII.5, contradiction 26).
    pub enum LocationKind {
        /// No location.
        None = "",
        /// `lpt`: a location point.
        Point = "lpt",
        /// `arr`: a sector of an array.
        Array = "arr",
        /// `own`: an owner.
        Owner = "own",
    }
}

record! {
    /// Command from Task to Subtask.
    pub struct SubtaskCommand {
        /// `command-#-in`.
        pub number: u32,
        /// `"command-in"`.
        pub command: SubtaskVerb,
        /// `"obj"`.
        pub object: Name16,
        /// `obj-endeff-id#`.
        pub end_effector_id: u8,
        /// `src-grip-#-in`.
        pub source_grip: i32,
        /// `dst-grip-#-in`.
        pub destination_grip: i32,
        /// `obj-para-^`: record of END-EFF-PARA.
        pub object_parameters: u32,
        /// `locpt-name-in`.
        pub location: Name10,
        /// `locpt-type-in`.
        pub location_kind: LocationKind,
        /// `locpt-^-in`: record of LOCPT.
        pub location_record: u32,
        /// Record of ARRAY-TABLE if the location is a sector (extension); 0 for none.
        pub location_array: u32,
        /// `pose-^-in`: the goal, a T-POSE of Task.
        pub pose: u32,
    }
}

record! {
    /// Status from Subtask to Task.
    pub struct SubtaskStatus {
        /// `command-#-echo`.
        pub echo: u32,
        /// `status-report`.
        pub report: Report,
        /// `status-para-out`.
        pub reason: Reason,
        /// `ref-pose-^-out`.
        pub reference_pose: u32,
        /// `obj-held-status-out`.
        pub object_held: bool,
        /// Name of the object held (extension).
        pub held_object: Name16,
        /// `pres-endeff-id#-out`.
        pub end_effector_id: u8,
        /// Where the robot is, as E-move reports it; empty if unknown (extension).
        pub at: Name10,
    }
}

/// Changing poses of Subtask: the location that it names itself (holster, pedestal), one after the other.
pub const SUBTASK_POSES: usize = 2;

record! {
    /// Output buffers of Subtask.
    pub struct SubtaskOutputs {
        /// Stamp and row.
        pub header: Header,
        /// To Task.
        pub status: SubtaskStatus,
        /// To E-move.
        pub emove: EmoveCommand,
        /// To the Active Pedestal.
        pub pedestal: PedestalCommand,
        /// Poses of locations that no Task command names.
        pub poses: [ChangingPose; SUBTASK_POSES],
    }
}
