//! E-move and Prim (V.1.2).

use crate::{
    coded_enum,
    handshake::Lower,
    interface::{ChangingPose, Header, Reason, t3i::T3iCommand},
    name::Name10,
    record,
};

coded_enum! {
    /// Commands of Prim (V.1.1).
    pub enum PrimVerb {
        /// None yet.
        None = "",
        /// Do nothing: hold position.
        Pause = "PAUSE",
        /// Initialize the DEPC link.
        RobotInit = "ROBOT-INIT",
        /// Move near a point on the way to the next.
        GoThru = "GO-THRU",
        /// Move to a point and stop.
        GotoPt = "GOTO-PT",
        /// Guarded move: move until a sensor condition comes.
        GoUntil = "GO-UNTIL",
        /// Move unless a sensor condition comes.
        GoWhile = "GO-WHILE",
        /// Move relative to a pose.
        DeltaMove = "DELTA-MOVE",
        /// Take the force sensor's reading as no force.
        CalSensor = "CAL-SENSOR",
    }
}

record! {
    /// Command from E-move to Prim.
    pub struct PrimCommand {
        /// `command-#-in`.
        pub number: u32,
        /// `"command"`.
        pub command: PrimVerb,
        /// `"sensor"` of a guarded move.
        pub sensor: Name10,
        /// `^-pose`: record of POSE, or a changing record.
        pub pose: u32,
        /// `^-movtab`: record of MOVTAB applied to the pose; 0 for none.
        pub movetable: u32,
        /// `^-traj-para`: record of TRAJ-PARA.
        pub trajectory_parameters: u32,
        /// `endeff-id#-in`.
        pub end_effector_id: u8,
    }
}

coded_enum! {
    /// `status-report` of Prim.
    pub enum PrimReport {
        /// Nothing was commanded yet (extension).
        Idle = "idle",
        /// The current command is executing.
        Executing = "executing",
        /// The current command is finished.
        Done = "done",
        /// The condition of a GO-UNTIL was not achieved.
        NotDetected = "not-detected",
        /// The joystick box is active.
        JoystickOn = "joystick-on",
        /// The DEPC link is off.
        T3LinkOff = "t3-link-off",
        /// The DEPC link reports an error.
        T3LinkErr = "t3-link-err",
        /// T3I does not answer.
        NoRespT3i = "no-resp-t3i",
        /// T3I refused a command.
        T3BadCommand = "t3-X-command",
        /// A sensor overload or malfunction has been identified.
        SensorError = "sensor-error",
        /// The condition of a GO-WHILE was detected on the way.
        DetectedErr = "detected-err",
        /// The command names records that do not exist, or the robot does not come to rest (extension).
        Error = "error",
    }
}

impl PrimReport {
    /// The report as a state variable of E-move.
    #[must_use]
    pub const fn lower(self) -> Lower {
        match self {
            Self::Idle | Self::Done => Lower::Done,
            Self::Executing | Self::NotDetected => Lower::Executing,
            Self::JoystickOn => Lower::Joystick,
            Self::T3LinkOff
            | Self::T3LinkErr
            | Self::NoRespT3i
            | Self::T3BadCommand
            | Self::SensorError
            | Self::DetectedErr
            | Self::Error => Lower::Error,
        }
    }
}

coded_enum! {
    /// `joy-grip-status`: the gripper buttons of the joystick box. The codes are ASSUMED.
    pub enum JoystickGrip {
        /// Neither button is pressed.
        None = "none",
        /// Open.
        Open = "open",
        /// Close.
        Close = "close",
    }
}

record! {
    /// Status from Prim to E-move.
    pub struct PrimStatus {
        /// `command-#-echo`.
        pub echo: u32,
        /// `status-report`.
        pub report: PrimReport,
        /// Why it failed (extension).
        pub reason: Reason,
        /// `restart-status`: a RESTART is being sent to T3I.
        pub restarting: bool,
        /// The DEPC link runs and Prim commands the robot (extension).
        pub link_running: bool,
        /// `pres-pose-^-out`: the position commanded to T3I.
        pub present_pose: u32,
        /// `sensor-pose-^-out`: where the resolvers say that the robot is; the command from T3I to DEPC is `frame-feedback` of T3I.
        pub sensor_pose: u32,
        /// `detected-pose-^-out`: where the condition of a GO-UNTIL was detected; 0 for none.
        pub detected_pose: u32,
        /// `hol-R-status`.
        pub holster_right: u8,
        /// `hol-L-status`.
        pub holster_left: u8,
        /// `hol-C-status`.
        pub holster_centre: u8,
        /// `joy-grip-status`.
        pub joystick_grip: JoystickGrip,
        /// `pres-pose-^-out` when the record button of the joystick box was pressed last; 0 for never (extension).
        pub recorded_pose: u32,
        /// A pose has been recorded: Prim and E-move are suspended until the operator goes on (III.3.3; extension).
        pub recording: bool,
        /// What the sensor of the guarded move reads: lb, in lb, or 1 while a switch is on (extension).
        pub sensed: i32,
        /// Distance to the goal, 0.01 in of path (extension).
        pub distance: i32,
    }
}

/// Changing poses of Prim: present, sensor, detected, recorded.
pub const PRIM_POSES: usize = 4;

record! {
    /// Output buffers of Prim.
    pub struct PrimOutputs {
        /// Stamp and row.
        pub header: Header,
        /// To E-move.
        pub status: PrimStatus,
        /// To T3I.
        pub t3i: T3iCommand,
        /// LEDs b, c, d, e of the joystick box.
        pub joystick_leds: u8,
        /// Present, sensor, detected and recorded pose.
        pub poses: [ChangingPose; PRIM_POSES],
    }
}
