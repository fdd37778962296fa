//! Decision tables of Grip: preconditions of a new command, the calibration, rows common to all commands, and one
//! file per command.

pub mod accept;
pub mod close_grip;
pub mod command;
pub mod pause;
pub mod position;
pub mod presence;
pub mod servo;
pub mod up_init;

pub use crate::variables::{Addressee, Attachment, Clock};
use interfaces::{
    Reason,
    grip::{Felt, GripVerb},
};
use rcs_core::{Actions, Plain, Variables, commands, handshake::Arrival};

use super::goals;
use crate::execution::{Asked, EXECUTE};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Not started: the command is new, or waits for the calibration.
    Start,
    /// The servo moves the fingers, or presses.
    Move,
    /// The valves are off; the readings settle.
    Settle,
}

/// Step of UP-INIT: progress of the calibration. It outlasts the commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum GripPhase {
    /// Not calibrated: the calibration begins at once, since the gripper is attached when the system starts (VI.3.1).
    Missing,
    /// Not calibrated, or interrupted: the calibration waits for UP-INIT. This is the first phase if the gripper was
    /// still in its holster, or if the process was started in the middle of a job: a part may be held.
    Deferred,
    /// The calibration from before a restart is adopted when the sensors of the gripper agree.
    Adopting,
    /// The fingers close, until the readings are steady.
    Closing,
    /// The fingers open, until the readings are steady.
    Opening,
    /// The air is let out, until the readings are steady.
    Venting,
    /// The fingers open without a calibration, until the readings are steady.
    Widening,
    /// Scale and offset of all sensors are known.
    Valid,
    /// The last attempt failed; UP-INIT tries again.
    Failed,
}

/// Whether opening and force of a command are within the gripper's range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum GripReach {
    /// Within range, or the command has none.
    Within,
    /// Beyond the range.
    Beyond,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain, Actions)]
pub enum GripActivity {
    /// No command has arrived, or the last one has ended.
    Nothing,
    /// The command was refused, or found at the start and not executed.
    Refused,
    /// PAUSE.
    Pause,
    /// UP-INIT.
    UpInit,
    /// POSITION, OPEN-GRIP or CLOSE-GRIP.
    Motion,
    /// OPEN-GRIP to the open end of travel.
    OpenWide,
}

/// The readings during the calibration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Calibrating {
    /// A reading changes.
    Unsteady,
    /// The readings have been steady for long enough.
    Steady,
    /// The readings are steady, but do not distinguish the ends of travel.
    Implausible,
    /// The calibration exceeds its time limit, or the valves of the device have been off without the controller.
    Late,
}

/// Whether fingers within their travel can read these values, by a calibration from before a restart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Sensors {
    /// The readings are possible.
    Plausible,
    /// The readings are impossible.
    Implausible,
    /// The words of the device are old.
    Stale,
    /// The device has not answered for a second.
    Lost,
    /// The valves of the device are off until an operator releases them.
    Tripped,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum GripMotion {
    /// The fingers move, or have just come to rest.
    Moving,
    /// The fingers are at rest.
    Still,
}

/// Whether the readings have settled since the valves went off.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum GripRest {
    /// The readings have not settled yet.
    Waiting,
    /// The readings have settled.
    Rested,
}

/// The opening, compared with the commanded one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum GripOpening {
    /// Much too narrow: a coarse flow cannot overshoot.
    VeryNarrow,
    /// Too narrow: a medium flow cannot overshoot.
    Narrow,
    /// A little too narrow.
    BitNarrow,
    /// Within the dead band.
    Right,
    /// A little too wide.
    BitWide,
    /// Too wide: a medium flow cannot overshoot.
    Wide,
    /// Much too wide: a coarse flow cannot overshoot.
    VeryWide,
}

/// Contact of the fingers during a grasp.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Grasp {
    /// No contact, far from the grasp size.
    Far,
    /// No contact, where the object is expected.
    Near,
    /// No contact for some ticks below the grasp size: the object is missing.
    Missed,
    /// One finger touches.
    OneFinger,
    /// Both fingers touch with much too little force: a medium flow cannot overshoot.
    Loose,
    /// Force a little too low.
    Weak,
    /// Force as commanded.
    Firm,
    /// Force a little too high.
    Strong,
    /// Force much too high.
    Crushing,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Plain)]
pub enum AirFlow {
    /// 0.25 in/s.
    Fine,
    /// 1 in/s.
    Medium,
    /// 4 in/s.
    Coarse,
}

#[derive(Clone, Copy, Debug, Variables)]
pub struct Request {
    /// Whether the command is new.
    pub asked: Asked,
    /// The command.
    pub verb: GripVerb,
    /// The gripper that the command addresses.
    pub addressee: Addressee,
    /// Whether the gripper is attached.
    pub gripper: Attachment,
    /// Whether opening and force are within range.
    pub reach: GripReach,
}

/// The state variables of a tick, for the tables of calibration and commands.
#[derive(Clone, Copy, Debug, Variables)]
pub struct Situation {
    /// The command in execution.
    pub command: GripActivity,
    /// Whether the gripper is attached.
    pub gripper: Attachment,
    /// The readings during the calibration.
    pub readings: Calibrating,
    /// Whether the sensors agree with a calibration from before a restart.
    pub sensors: Sensors,
    /// Time of the command.
    pub clock: Clock,
    /// The motion of the fingers.
    pub motion: GripMotion,
    /// The part presence.
    pub felt: Felt,
    /// Whether the readings have settled.
    pub rest: GripRest,
    /// The opening, compared with the commanded one.
    pub opening: GripOpening,
    /// The contact of the fingers.
    pub grasp: Grasp,
}

/// The readings in inches and pounds; 0 before the first calibration and without the gripper.
#[derive(Clone, Copy, Debug, Default)]
pub struct Measured {
    /// Opening by the newest reading, in.
    pub opening: f64,
    /// Opening by the mean of the last readings, in.
    pub mean_opening: f64,
    /// Opening velocity, in/s.
    pub velocity: f64,
    /// Force of the left finger, lb.
    pub left: f64,
    /// Force of the right finger, lb.
    pub right: f64,
}

#[derive(Clone, Copy, Debug)]
pub struct StateVariables {
    pub arrival: Arrival,
    pub request: Request,
    /// The state variables; EXECUTE and ACCEPT set `command`.
    pub situation: Situation,
    pub measured: Measured,
}

/// The remaining decision after [`up_init::CALIBRATION`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum GripDuty {
    /// No decision remains; the valves stay as they are.
    Nothing,
    /// No decision remains; the valves go off with a refused command.
    Refused,
    /// The table of the command decides.
    Command,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Action {
    /// The valves stay as they are.
    Keep,
    /// All valves off: a refused command ends the current motion.
    Refuse,
    /// All valves off: trapped air holds opening and force.
    Stop,
    /// All valves off; report done.
    Finish,
    /// The valves stay as they are; report done.
    Pause,
    /// Open with a flow, or a smaller one for the commanded speed.
    Open(AirFlow),
    /// Close with a flow, or a smaller one for the commanded speed.
    Close(AirFlow),
    /// Continue to close with one finger in contact; report `paused`.
    AwaitFinger,
    /// All valves off; report an error.
    Fail(Reason),
    /// The calibration begins: all close flows.
    Begin,
    /// All close flows.
    CloseFully,
    /// The fingers begin to open without a calibration: all open flows.
    Widen,
    /// Take the readings as those of the closed end; all open flows.
    NoteClosed,
    /// All open flows.
    OpenFully,
    /// Take the readings as those of the open end; vent.
    NoteOpen,
    /// Vent both sides.
    Vent,
    /// Take the readings as those without force: set scale and offset of the sensors; all valves off.
    Calibrate,
    /// The same, and report done.
    CalibrateAndFinish,
    /// All valves off: the calibration has failed, but no command with it.
    GiveUp,
    /// Adopt the calibration from before the restart.
    Adopt,
    /// Discard the calibration from before the restart.
    Forget,
}

commands! {
    pub fn of_command(GripVerb, Step, Situation) -> Action {
        others: EXECUTE, accept::ACCEPT, up_init::UP_INIT, up_init::CALIBRATION, command::COMMAND,
            command::START, presence::TOUCH, presence::PRESENCE;
        Position | OpenGrip: goals::OPENING => servo::servo then position::position;
        CloseGrip: goals::FORCE             => servo::servo then close_grip::close_grip;
        None | Pause: goals::REST           => pause::pause;
        UpInit: goals::CALIBRATED           => pause::pause;
    }
}
