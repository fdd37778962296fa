//! A robot that the caller of the library provides, behind a DEPC function in this process.

use depc::{
    Limits, Plate,
    controller::{Controller, ControllerInputs, ControllerOutputs, ControllerState, Robot},
    link::LinkBytes,
    warning::Warning,
};
use interfaces::device::DeviceInputs;
use plant::t3::explained;

/// A robot instead of the T3, for [`Run::with_robot`](crate::Run::with_robot).
///
/// The calls of a tick are first [`advance`](Self::advance), then at most one point ([`Robot::accept`]) or request for
/// the present position ([`Robot::present`]), then [`position`](Self::position).
pub trait OwnRobot: Robot {
    /// A tick of 40 ms begins: move towards the last accepted point.
    fn advance(&mut self);

    /// Position of the end plate, `None` while unknown. The arm of the simulated cell, and everything that it carries,
    /// follows it.
    fn position(&self) -> Option<Plate>;
}

/// The robot, and its DEPC function.
pub struct OwnPort {
    robot: Box<dyn OwnRobot>,
    function: Controller,
    outputs: ControllerOutputs,
}

impl OwnPort {
    /// The function has not started.
    pub fn new(robot: Box<dyn OwnRobot>) -> Self {
        Self { robot, function: Controller::new(Limits::NBS), outputs: ControllerOutputs::default() }
    }

    /// Before the controller's tick: pass on the answers of the function.
    pub const fn receive(&self, inputs: &mut DeviceInputs) {
        inputs.link_rx = self.outputs.tx;
        inputs.link_ready = self.outputs.dtr;
        inputs.link_unsent = false;
    }

    /// After the controller's tick: pass the host's bytes to the function. It starts again whenever the robot reports
    /// no trouble.
    pub fn send(&mut self, tx: &LinkBytes) {
        self.robot.advance();
        let running = matches!(self.function.state(), ControllerState::Running | ControllerState::Warning);
        let start = !running && self.robot.warning().is_none();
        let inputs =
            ControllerInputs { rx: *tx, cts: true, board: true, start, ..ControllerInputs::default() };
        self.outputs = self.function.step(&inputs, &mut *self.robot);
    }

    /// Position of the robot.
    pub fn position(&self) -> Option<Plate> {
        self.robot.position()
    }

    /// The warning that prevents commands to the robot, as text.
    pub fn trouble(&self) -> Option<String> {
        let shown = Some(self.function.warning()).filter(|shown| *shown != Warning::None);
        shown.or_else(|| self.robot.warning()).map(explained)
    }
}
