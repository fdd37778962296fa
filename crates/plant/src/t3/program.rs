//! Automatic actions of the controller: pressure, axes, the motion to HOME, and the program with its DEPC function.

use depc::{
    controller::{Controller, ControllerInputs, ControllerState, Warning},
    wire::{NO_FUNCTION, Response},
};
use geometry::{
    frame::Vector,
    kinematics::{HOME_JOINTS, Joints, T3},
};

use super::{Cut, Message, RobotEvent, SetPoint, Stage, StepInputs, StepOutputs, T3Controller};

/// Speed of the fastest joint in motions that the controller makes by itself, degrees/s (ASSUMED).
const OWN_SPEED: f64 = 10.0;
/// Height of the two short vertical motions of the program, up and down again, in (ASSUMED).
const VERTICAL_IN: f64 = 1.0;
const VERTICAL_S: f64 = 0.5; // duration of each of them, s (ASSUMED)

impl T3Controller {
    pub(super) fn end_program(&mut self, stage: Stage) {
        self.depc = Controller::new(self.limits);
        self.keys = ControllerInputs { hold: self.keys.hold, ..ControllerInputs::default() };
        self.enter(stage);
    }

    pub(super) fn go_home(&mut self) {
        self.end_program(Stage::Homing);
        self.robot(RobotEvent::GoesHome);
        self.travel(HOME_JOINTS);
    }

    /// Move all joints at the controller's own speed.
    pub(super) fn travel(&mut self, goal: Joints) {
        let ways = goal.iter().zip(self.arm.command()).map(|(goal, at)| (goal - at).abs());
        let longest = ways.fold(0.0, f64::max);
        self.arm.reach(goal, longest / OWN_SPEED.to_radians());
    }

    /// Wait while the pump starts. The servos then get pressure and jump to their command.
    pub(super) fn rise(&mut self) {
        match self.before_jump {
            None if self.since < self.pump_delay => {}
            None if !self.pump => self.fault(Cut::PressureLost),
            None => {
                self.before_jump = Some(self.arm.tool().position.into());
                self.arm.set_pressure(true);
                self.cut = None;
            }
            Some(before) if self.arm.settled() => {
                let inches = (self.arm.tool().position - Vector::from(before)).norm();
                self.before_jump = None;
                self.enter(Stage::Manual);
                self.robot(RobotEvent::Jumped { inches });
                self.messages.push(Message::Aligned(self.aligned));
            }
            Some(_) => {}
        }
    }

    pub(super) fn watch_axes(&mut self) {
        if self.aligning == [false; 6] || !self.arm.settled() {
            return;
        }
        for (aligned, arrived) in self.aligned.iter_mut().zip(std::mem::take(&mut self.aligning)) {
            *aligned |= arrived;
        }
        self.messages.push(Message::Aligned(self.aligned));
    }

    pub(super) fn rehearse(&mut self, inputs: &StepInputs) -> StepOutputs {
        self.motions += 1;
        let mut raised = T3.forward(&HOME_JOINTS);
        raised.position.z += VERTICAL_IN;
        match (self.motions, T3.inverse(&raised, &HOME_JOINTS)) {
            (1, Ok(up)) => self.arm.reach(up, VERTICAL_S),
            (2, _) => self.arm.reach(HOME_JOINTS, VERTICAL_S),
            _ => {
                if let Ok(home) = SetPoint::at(&HOME_JOINTS) {
                    self.set_point = home;
                }
                self.enter(Stage::Depc);
                self.keys.start = true;
                return self.depc_step(inputs);
            }
        }
        StepOutputs::default()
    }

    pub(super) fn depc_step(&mut self, inputs: &StepInputs) -> StepOutputs {
        let (state, warning) = (self.depc.state(), self.depc.warning());
        let answered = self.keys.enter || self.keys.start;
        let panel = ControllerInputs {
            rx: inputs.rx,
            cts: inputs.cts,
            board: self.board,
            transmitter_fault: !self.transmitter,
            ..self.keys
        };
        let out = self.depc.step(&panel, &mut self.set_point);
        self.keys = ControllerInputs { hold: self.keys.hold, ..ControllerInputs::default() };
        if out.moving {
            self.counts.moves += 1;
            self.reach_set_point(1.0);
        }
        if out.function != NO_FUNCTION {
            self.messages.push(Message::Function(out.function));
        }
        self.tell(out.tx.as_slice(), state, warning, answered);
        StepOutputs { tx: out.tx, dtr: out.dtr, busy: out.moving || out.tx.length > 0 }
    }

    /// Add the messages and enter the stage that follow from a step of the function.
    fn tell(&mut self, tx: &[u8], state: ControllerState, warning: Warning, answered: bool) {
        match tx {
            [nak] if *nak == Response::Nak.byte() => self.counts.naks += 1,
            [_, _, ..] => {
                self.counts.reports += 1;
                if state != ControllerState::Running {
                    self.messages.push(Message::Reported(self.depc.commanded()));
                }
            }
            _ => {}
        }
        let shown = self.depc.warning();
        if shown != Warning::None && (shown != warning || answered) {
            self.messages.push(Message::Warning(shown));
        }
        match (state, self.depc.state()) {
            (ControllerState::PreManual, ControllerState::Off) => {
                self.end_program(Stage::PreManual);
                self.robot(RobotEvent::PreManual);
            }
            (_, ControllerState::Ended) => {
                self.messages.push(Message::Ended);
                self.go_home();
            }
            _ => {}
        }
    }
}
