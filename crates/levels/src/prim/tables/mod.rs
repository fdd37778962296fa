//! Decision tables of Prim: preconditions of a new command, preconditions of a motion, one file per command, and those
//! of every tick: finished commands, the path clock, the record button.

pub mod accept;
pub mod attend;
pub mod cal_sensor;
pub mod field;
pub mod go_thru;
pub mod go_until;
pub mod go_while;
pub mod goto_pt;
pub mod link;
pub mod path_clock;
pub mod pause;
pub mod record_pose;
pub mod robot_init;

use geometry::frame::Frame;
use interfaces::{Reason, device::GroupHealth, prim::PrimVerb, t3i::ReportCheck};
use rcs_core::{Actions, Plain, Variables, commands, handshake::Arrival};

use super::goals;
use crate::{
    confirm::{CONFIRM, Proof},
    execution::{Asked, Course, EXECUTE, Ending},
    halt::Above,
};

/// The answer of T3I to the last command (VI.1.2 status-report, status-arg-out).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Interface {
    /// T3I has enough points, has not echoed the command yet, or is held.
    Busy,
    /// T3I is ready for a new point.
    Ready,
    /// T3I has finished all points.
    Finished,
    /// T3I does not answer.
    Silent,
    /// The robot controller's DTR is off.
    LinkOff,
    /// DTR is on, but the DEPC link does not respond, or has stopped while Prim commands the robot.
    LinkSilent,
    /// The DEPC link has another error.
    LinkError,
    /// The robot has left its path, and T3I has stopped it.
    OffPath,
    /// T3I refused a command.
    Refused,
}

/// The commanded motion of the robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Posture {
    /// None: the robot's position was never taken over, or is lost.
    Unpositioned,
    /// The path is being sent.
    Moving,
    /// The last point of the path is sent, but not finished.
    Ending,
    /// The robot is at its commanded position.
    Standing,
}

/// Whether the command needs a commanded position.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Position {
    /// PAUSE and ROBOT-INIT need none.
    NotNeeded,
    /// Motions and CAL-SENSOR need one.
    Needed,
}

/// The RESTARTs that Prim has sent by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Restarts {
    /// Fewer than 10 in the last 10 s.
    Few,
    /// 10 in the last 10 s: the link is unusable.
    Many,
}

/// The path to the goal of the command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum PrimPath {
    /// The path is being followed, or has ended.
    Kept,
    /// The link was restarted: the robot rests, and the path starts again.
    Lost,
}

/// The operator at the joystick box (III.3.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum PrimOperator {
    /// The operator does not move the robot.
    Idle,
    /// A frame switch is on, the velocity knob is not at zero, and a stick or button is moved beyond its play.
    Moves,
}

/// The DEPC link after a RESTART.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum PrimLink {
    /// The link does not run yet.
    Down,
    /// The link runs, and T3I feeds back a frame.
    Running,
}

/// A through point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Passage {
    /// The robot is farther away than the brake distance.
    UnderWay,
    /// Nearer than the brake distance: the next goal may be given.
    Passing,
}

/// How a motion comes to rest (docs/design/motion.md "Rest").
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum PrimRest {
    /// Points are still to be finished.
    UnderWay,
    /// All points are finished; the resolvers do not show rest yet.
    Settling,
    /// The resolvers show that the robot is at rest.
    Arrived,
    /// The time for coming to rest is over.
    Late,
}

/// The sensor of a guarded move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Guard {
    /// The condition does not hold.
    Clear,
    /// The condition holds.
    Met,
    /// The sensor is overloaded, not calibrated, or not there.
    Faulty,
}

/// The readings for the bias of the force sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Samples {
    /// Another reading is needed.
    Wanted,
    /// All readings are taken.
    Complete,
    /// The sensor is overloaded, or not there.
    Faulty,
}

/// The frame switches of the joystick box (III.3.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Switches {
    /// No switch is on.
    Off,
    /// One switch is on: the box may move the robot.
    One,
    /// Two or more switches, or one that the box does not have: no frame is selected.
    Several,
}

/// Kind of a command, for the joystick box.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum CommandKind {
    /// ROBOT-INIT, CAL-SENSOR: it ends, and moves nothing afterwards.
    Single,
    /// GO-THRU, GOTO-PT, GO-UNTIL, GO-WHILE, DELTA-MOVE: it moves the robot.
    Motion,
    /// PAUSE: it never ends.
    Lasting,
}

/// PAUSE to T3I after a start of Prim, since the buffer may hold a command from before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum FirstPause {
    /// Prim has not sent the PAUSE yet.
    Due,
    /// The PAUSE is sent.
    Sent,
}

/// Push-button X of the joystick box (III.3.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Button {
    /// Not pressed, or held down since an earlier tick.
    Idle,
    /// Pressed in this tick.
    Pressed,
}

/// The first thing that a new command lacks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum PrimMissing {
    /// The command is complete.
    Nothing,
    /// A command word.
    Command,
    /// The sensor of a guarded move.
    Sensor,
    /// The record of the pose.
    Pose,
    /// The record of the movetable.
    Movetable,
    /// The record of TRAJ-PARA.
    Parameters,
    /// Limits above 0 in the record of TRAJ-PARA.
    Limits,
}

#[derive(Clone, Copy, Debug, Default, Variables)]
pub struct Request {
    /// Whether the command is new.
    pub asked: Asked,
    /// The first thing that it lacks.
    pub missing: PrimMissing,
}

#[derive(Clone, Copy, Debug, Variables)]
pub struct Attendance {
    /// The decision of EXECUTE.
    pub course: Course,
    /// The kind of the command.
    pub kind: CommandKind,
    /// The operator.
    pub operator: PrimOperator,
}

/// The devices behind field I/O, for [`field::FIELD`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct Devices {
    /// Whether the command needs a commanded position.
    pub position: Position,
    /// The connection with the worst of all devices.
    pub connection: GroupHealth,
}

/// The state variables of a tick, for the tables of the commands.
#[derive(Clone, Copy, Debug, Variables)]
pub struct Situation {
    /// T3I.
    pub t3i: Interface,
    /// E-move.
    pub emove: Above,
    /// The frame switches of the joystick box.
    pub switches: Switches,
    /// The commanded motion of the robot.
    pub posture: Posture,
    /// Whether the command needs a commanded position.
    pub position: Position,
    /// The operator.
    pub operator: PrimOperator,
    /// The link after a RESTART.
    pub link: PrimLink,
    /// T3I's check of the report after the last RESTART.
    pub report: ReportCheck,
    /// The recent RESTARTs.
    pub restarts: Restarts,
    /// The path to the goal.
    pub way: PrimPath,
    /// The through point of a GO-THRU.
    pub passage: Passage,
    /// Rest at the goal of the command.
    pub goal: PrimRest,
    /// Rest wherever the robot is.
    pub rest: PrimRest,
    /// The sensor of a guarded move.
    pub guard: Guard,
    /// The bias of the force sensor.
    pub samples: Samples,
}

#[derive(Clone, Copy, Debug, Variables)]
pub struct Path {
    /// The first command to T3I.
    pub first_pause: FirstPause,
    /// The commanded motion of the robot, after the command's row of this tick.
    pub posture: Posture,
    /// T3I.
    pub t3i: Interface,
    /// The record button.
    pub button: Button,
}

#[derive(Clone, Copy, Debug)]
pub struct StateVariables {
    pub arrival: Arrival,
    /// The new command, or the one that was accepted last.
    pub verb: PrimVerb,
    pub request: Request,
    pub field: Devices,
    /// The goal of the command, compared with the sensors.
    pub proof: Proof,
    pub situation: Situation,
    pub button: Button,
    /// The frame that T3I feeds back while the link runs.
    pub feedback: Option<Frame>,
    /// The resolver frame, if it is valid.
    pub resolvers: Option<Frame>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Action {
    /// Nothing new; a motion continues.
    Wait,
    /// Move to the goal.
    Go,
    /// Ramp down and stop.
    Halt,
    /// RESTART to T3I; the position is discarded.
    Restart,
    /// The same after a link failure; these RESTARTs are counted.
    Recover,
    /// Take the frame that T3I feeds back as the commanded one; plan the path to the goal again.
    Resume,
    /// Take the frame that T3I feeds back as the commanded one; report done.
    TakePosition,
    /// Report `joystick-on`, ramp down and stop.
    Yield,
    /// Report `joystick-on`, and move as the box commands.
    Drive,
    /// Publish the robot's position, ramp down and stop.
    Detect,
    /// Report `not-detected`.
    Miss,
    /// Take a reading of the force sensor.
    Sample,
    /// Take the mean of the readings as zero; report done.
    Calibrate,
    /// Report done.
    Finish,
    /// Report an error, ramp down and stop.
    Fail(Reason),
}

impl Ending for Action {
    const WAIT: Self = Self::Wait;

    fn fail(reason: Reason) -> Self {
        Self::Fail(reason)
    }

    fn ends(&self) -> bool {
        matches!(self, Self::Finish | Self::TakePosition | Self::Calibrate)
    }
}

commands! {
    pub fn of_command(PrimVerb, enum Step, Situation) -> Action {
        others: EXECUTE, accept::ACCEPT, attend::ATTEND, path_clock::PATH_CLOCK, record_pose::RECORD_POSE,
            field::FIELD, link::LINK, CONFIRM;
        before: EXECUTE, ATTEND by attend, ACCEPT(request), FIELD(field),
            LINK(situation in link);
        after: CONFIRM;
        None | Pause: goals::REST           => pause::pause;
        RobotInit: goals::POSITIONED        => robot_init::robot_init;
        GoThru: goals::PASSING              => go_thru::go_thru;
        GotoPt | DeltaMove: goals::POINT    => goto_pt::goto_pt;
        GoUntil: goals::CONTACT             => go_until::go_until;
        GoWhile: goals::POINT               => go_while::go_while then goto_pt::goto_pt;
        CalSensor: goals::CALIBRATED        => cal_sensor::cal_sensor;
    }
}
