//! A robot that the caller of the library provides, with a DEPC function in this process.

use std::time::Duration;

use closed_loop::RobotInputs;
use depc::{
    Limits, Plate,
    controller::{Controller, ControllerInputs, ControllerOutputs, ControllerState, Robot},
    link::LinkBytes,
    track::{LAG_MS, MOST_LAG_MS},
    warning::Warning,
};
use plant::t3::explained;

/// A robot instead of the T3, for [`Run::with_robot`](crate::Run::with_robot). In a tick: [`advance`](Self::advance),
/// at most one point ([`Robot::accept`]) or request for the present position ([`Robot::present`]),
/// [`position`](Self::position).
///
/// The robot is supervised (docs/design/link.md "Following"): one that is off the path of the last points gets no
/// further point, and [`Robot::stop`] is called once. It must stop in place, and [`Robot::present`] must return that
/// position.
pub trait OwnRobot: Robot {
    /// A tick of 40 ms begins: move towards the last accepted point.
    fn advance(&mut self);

    /// Position of the end plate, if known. The arm of the simulated cell, and everything that it carries, follows it.
    fn position(&self) -> Option<Plate>;

    /// Expected lag behind the points, at most 1 s, including the 80 ms of the simulated arm, which follows the robot.
    /// A robot that is more than 0.5 in off the path of this time is stopped.
    fn lag(&self) -> Duration {
        Duration::from_millis(LAG_MS.into())
    }
}

pub struct OwnPort {
    robot: Box<dyn OwnRobot>,
    function: Controller,
    outputs: ControllerOutputs,
    held: bool,            // true from a stop of the robot to the start of the next path
    news: Option<Warning>, // the warning of this tick, if it is new
}

impl OwnPort {
    pub fn new(robot: Box<dyn OwnRobot>) -> Self {
        let (function, outputs) = (Controller::new(Limits::NBS), ControllerOutputs::default());
        Self { robot, function, outputs, held: false, news: None }
    }

    /// Before the controller's tick, passes on the answers of the function.
    pub const fn receive(&self) -> RobotInputs {
        RobotInputs { rx: self.outputs.tx, ready: self.outputs.dtr, unsent: false, resolvers: None }
    }

    /// After the controller's tick, passes the host's bytes to the function, or stops the robot. Without trouble the
    /// function starts again.
    pub fn send(&mut self, tx: &LinkBytes, hold: bool) {
        self.robot.advance();
        if hold && !self.held {
            self.robot.stop();
        }
        self.held = hold;
        let running = matches!(self.function.state(), ControllerState::Running | ControllerState::Warning);
        let start = !running && self.robot.warning().is_none();
        let inputs =
            ControllerInputs { rx: *tx, cts: true, board: true, start, ..ControllerInputs::default() };
        let before = self.function.warning();
        self.outputs = self.function.step(&inputs, &mut *self.robot);
        let warning = self.function.warning();
        self.news = (warning != before && warning != Warning::None).then_some(warning);
    }

    /// The new warning of the function in this tick: the robot has refused a point, or reports a fault.
    pub const fn news(&self) -> Option<Warning> {
        self.news
    }

    /// Expected lag of the robot, ms.
    pub fn lag_ms(&self) -> u16 {
        u16::try_from(self.robot.lag().as_millis()).unwrap_or(u16::MAX).min(MOST_LAG_MS)
    }

    pub fn position(&self) -> Option<Plate> {
        self.robot.position()
    }

    /// The warning that prevents commands to the robot, as text.
    pub fn trouble(&self) -> Option<String> {
        let shown = Some(self.function.warning()).filter(|shown| *shown != Warning::None);
        shown.or_else(|| self.robot.warning()).map(explained)
    }
}
