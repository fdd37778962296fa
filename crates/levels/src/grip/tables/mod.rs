//! Decision tables of Grip: what a new command needs, the calibration, what commands have in common, and a
//! file a command.

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

/// Step of all commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Not begun: the command is new, or waits for the calibration.
    Start,
    /// The servo moves the fingers, or presses.
    Move,
    /// The valves are off; the readings settle.
    Settle,
}

/// Step of UP-INIT: how far the calibration has come. It outlasts the commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum GripPhase {
    /// Never done: begins at once, since the gripper is there when the system is booted (VI.3.1).
    Missing,
    /// Never done, or interrupted: waits for UP-INIT. So begins a process whose gripper comes later, which is
    /// then still in its holster, and one that was started in the middle of a job: a part may be held.
    Deferred,
    /// Done before the process was restarted: counts again when the sensors of the gripper agree.
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

/// Can a gripper of this sort reach the opening and the force of a command?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum GripReach {
    /// Yes, or the command names none.
    Within,
    /// No.
    Beyond,
}

/// The command that is being executed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain, Actions)]
pub enum GripActivity {
    /// None: nothing was commanded yet, or it has ended.
    Nothing,
    /// None: it was refused, or found at the start and not executed.
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

/// What the sensors read while calibrating.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Calibrating {
    /// Something changes.
    Unsteady,
    /// Steady for long enough.
    Steady,
    /// Steady, and the sensors do not tell the ends of travel apart.
    Implausible,
    /// The calibration takes longer than its limit.
    Late,
}

/// Do the sensors read what fingers within their travel can read, by a calibration from before a restart?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Sensors {
    /// Yes.
    Plausible,
    /// No.
    Implausible,
    /// The words of their device are old.
    Stale,
    /// Their device has not answered for a second.
    Lost,
    /// The valves of their device are off until an operator releases them.
    Tripped,
}

/// What the fingers do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum GripMotion {
    /// They move, or have come to rest only just now.
    Moving,
    /// They are at rest.
    Still,
}

/// Have the readings settled since the valves went off?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum GripRest {
    /// Not yet.
    Waiting,
    /// Yes.
    Rested,
}

/// Opening of the fingers, seen from the commanded one.
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

/// What the fingers feel on the way to a grasp.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Grasp {
    /// Nothing, far from the grasp size.
    Far,
    /// Nothing, where the object is expected.
    Near,
    /// Nothing for some ticks, though the grasp size is passed: there is no object.
    Missed,
    /// One finger touches, the other does not.
    OneFinger,
    /// Both touch, force much too low: a medium flow cannot overshoot.
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

/// How much air flows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Plain)]
pub enum AirFlow {
    /// 0.25 in/s.
    Fine,
    /// 1 in/s.
    Medium,
    /// 4 in/s.
    Coarse,
}

/// What a new command needs, for [`accept::ACCEPT`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct Request {
    /// Is the command new?
    pub asked: Asked,
    /// The command.
    pub verb: GripVerb,
    /// For which gripper is it?
    pub addressee: Addressee,
    /// Is the gripper there?
    pub gripper: Attachment,
    /// Are opening and force attainable?
    pub reach: GripReach,
}

/// The state variables of a tick, for the tables of calibration and commands.
#[derive(Clone, Copy, Debug, Variables)]
pub struct Situation {
    /// The command that is being executed.
    pub command: GripActivity,
    /// Is the gripper there?
    pub gripper: Attachment,
    /// What the sensors read while calibrating.
    pub readings: Calibrating,
    /// Do the sensors agree with a calibration from before a restart?
    pub sensors: Sensors,
    /// Time of the command.
    pub clock: Clock,
    /// What the fingers do.
    pub motion: GripMotion,
    /// What is between them.
    pub felt: Felt,
    /// Have the readings settled?
    pub rest: GripRest,
    /// The opening, seen from the commanded one.
    pub opening: GripOpening,
    /// What the fingers feel.
    pub grasp: Grasp,
}

/// What the sensors say in inches and pounds; 0 before the first calibration and without the gripper.
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

/// What preprocess has found in a tick.
#[derive(Clone, Copy, Debug)]
pub struct StateVariables {
    /// What the command buffer holds.
    pub arrival: Arrival,
    /// What a new command needs.
    pub request: Request,
    /// The state variables; EXECUTE and ACCEPT decide on `command`.
    pub situation: Situation,
    /// Opening and forces.
    pub measured: Measured,
}

/// What [`up_init::CALIBRATION`] leaves to decide.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum GripDuty {
    /// Nothing: the valves stay as they are.
    Nothing,
    /// Nothing: the valves go off with a command that is refused.
    Refused,
    /// The table of the command decides.
    Command,
}

/// What a row can ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Action {
    /// The valves stay as they are.
    Keep,
    /// All valves off: a refused command ends what was under way.
    Refuse,
    /// All valves off: trapped air holds opening and force.
    Stop,
    /// All valves off; report done.
    Finish,
    /// The valves stay as they are; report done.
    Pause,
    /// Open with a flow, or a smaller one if the commanded speed asks for that.
    Open(AirFlow),
    /// Close with a flow, or a smaller one if the commanded speed asks for that.
    Close(AirFlow),
    /// Close on with one finger in contact; report `paused`.
    AwaitFinger,
    /// All valves off; report an error.
    Fail(Reason),
    /// The calibration begins: all close flows.
    Begin,
    /// All close flows.
    CloseFully,
    /// The fingers begin to open without a calibration: all open flows.
    Widen,
    /// The readings are those of the closed end; all open flows.
    NoteClosed,
    /// All open flows.
    OpenFully,
    /// The readings are those of the open end; vent.
    NoteOpen,
    /// Vent both sides.
    Vent,
    /// The readings are those without force: set scale and offset of the sensors; all valves off.
    Calibrate,
    /// The same, and report done.
    CalibrateAndFinish,
    /// All valves off: there is no calibration, and no command that fails with it.
    GiveUp,
    /// The calibration from before the restart counts.
    Adopt,
    /// The calibration from before the restart does not count.
    Forget,
}

commands! {
    /// Consult the table of a command.
    pub fn of_command(GripVerb, Step, Situation) -> Action {
        others: EXECUTE, accept::ACCEPT, up_init::UP_INIT, up_init::CALIBRATION, command::COMMAND,
            command::START, presence::TOUCH, presence::PRESENCE;
        Position | OpenGrip: goals::OPENING => servo::servo then position::position;
        CloseGrip: goals::FORCE             => servo::servo then close_grip::close_grip;
        None | Pause: goals::REST           => pause::pause;
        UpInit: goals::CALIBRATED           => pause::pause;
    }
}
