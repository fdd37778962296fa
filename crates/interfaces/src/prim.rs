//! E-move and Prim (V.1.2).

use core::fmt;

use rcs_core::{Plain, handshake::Lower, name::Name10};

use super::words::name;
use crate::{
    ChangingPose, Header, Reason,
    record_number::{MovtabId, TrajParaId},
    t3i::T3iCommand,
};

/// Commands of Prim (V.1.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
#[text(upper)]
pub enum PrimVerb {
    /// No command yet.
    #[text = ""]
    None,
    /// Do nothing: hold position.
    Pause,
    /// Initialize the DEPC link.
    RobotInit,
    /// Move near a point, on the way to the next.
    GoThru,
    /// Move to a point and stop.
    GotoPt,
    /// Guarded move: move until a sensor condition occurs.
    GoUntil,
    /// Move unless a sensor condition occurs.
    GoWhile,
    /// Move relative to a pose.
    DeltaMove,
    /// Take the present reading of the force sensor as zero force.
    CalSensor,
}

/// Command from E-move to Prim.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct PrimCommand {
    /// `command-#-in`.
    pub number: u32,
    /// `"command"`.
    pub command: PrimVerb,
    /// `"sensor"` of a guarded move.
    pub sensor: Option<Name10>,
    /// `^-pose`: record of POSE, or a changing record.
    pub pose: u32,
    /// `^-movtab`: record of MOVTAB applied to the pose, if there is one.
    pub movetable: MovtabId,
    /// `^-traj-para`: record of TRAJ-PARA.
    pub trajectory_parameters: TrajParaId,
    /// `endeff-id#-in`, if a gripper is attached.
    pub end_effector_id: Option<u8>,
}

/// `status-report` of Prim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum PrimReport {
    /// No command yet (extension).
    Idle,
    /// The current command is executing.
    Executing,
    /// The current command is finished.
    Done,
    /// The condition of a GO-UNTIL was not achieved.
    NotDetected,
    /// The joystick box is active.
    JoystickOn,
    /// The DEPC link is off.
    T3LinkOff,
    /// The DEPC link reports an error.
    T3LinkErr,
    /// T3I does not answer.
    NoRespT3i,
    /// T3I refused a command.
    #[text = "t3-X-command"]
    T3BadCommand,
    /// A sensor overload or malfunction has been identified.
    SensorError,
    /// The condition of a GO-WHILE was detected before the goal.
    DetectedErr,
    /// The command names records that do not exist, or the robot does not come to rest (extension).
    Error,
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

/// `joy-grip-status`: the gripper buttons of the joystick box. The codes are ASSUMED.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum JoystickGrip {
    /// Neither button is pressed.
    None,
    /// The open button is pressed.
    Open,
    /// The close button is pressed.
    Close,
}

/// Status from Prim to E-move.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct PrimStatus {
    /// `command-#-echo`.
    pub echo: u32,
    /// `status-report`.
    pub report: PrimReport,
    /// Reason of a failure (extension).
    pub reason: Reason,
    /// `restart-status`: a RESTART is being sent to T3I.
    pub restarting: bool,
    /// The DEPC link runs and Prim commands the robot (extension).
    pub link_running: bool,
    /// The controller's DTR is off, as T3I reports: the arm may be without pressure (extension).
    pub controller_off: bool,
    /// `pres-pose-^-out`: the position commanded to T3I, if Prim commands the robot.
    pub present_pose: Option<u32>,
    /// `sensor-pose-^-out`: pose by the resolvers, if they are valid. The command from T3I to DEPC is
    /// `frame-feedback` of T3I.
    pub sensor_pose: Option<u32>,
    /// `detected-pose-^-out`: pose at which the condition of the last GO-UNTIL was detected.
    pub detected_pose: Option<u32>,
    /// `hol-R-status`.
    pub holster_right: u8,
    /// `hol-L-status`.
    pub holster_left: u8,
    /// `hol-C-status`.
    pub holster_centre: u8,
    /// `joy-grip-status`.
    pub joystick_grip: JoystickGrip,
    /// `pres-pose-^-out` at the last press of the joystick box's record button (extension).
    pub recorded_pose: Option<u32>,
    /// A pose was recorded: Prim and E-move are suspended until the operator continues (III.3.3; extension).
    pub recording: bool,
    /// Reading of the guarded move's sensor: lb, in lb, or 1 while a switch is on (extension).
    pub sensed: i32,
    /// Distance to the goal, 0.01 in of path (extension).
    pub distance: i32,
}

/// Changing poses of Prim: present, sensor, detected, recorded.
pub const PRIM_POSES: usize = 4;

/// Connected axes of the force sensor: forces along tool X, Y, Z and the moment about tool Y (III.3.8).
pub const FORCE_AXES: usize = 4;

/// Output buffers of Prim.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
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
    /// Calibrated zero of the force sensor: counts from the middle of the converters as tool Fx, Fy, Fz, My (III.3.8;
    /// extension).
    pub bias: Option<[f64; FORCE_AXES]>,
}

/// `GO-UNTIL SEAT-F`: the sensor appears only with guarded moves.
impl fmt::Display for PrimCommand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.command.text())?;
        match self.command {
            PrimVerb::GoUntil | PrimVerb::GoWhile => name(f, self.sensor.as_ref()),
            PrimVerb::None
            | PrimVerb::Pause
            | PrimVerb::RobotInit
            | PrimVerb::GoThru
            | PrimVerb::GotoPt
            | PrimVerb::DeltaMove
            | PrimVerb::CalSensor => Ok(()),
        }
    }
}
