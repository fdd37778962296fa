//! The T3 controller with its robot: the start-up of IV.3.3 as a state machine, without I/O and without a clock.

mod keys;
mod stage;

use depc::{
    Limits, Plate,
    controller::{Controller, ControllerInputs, ControllerState, JointProblem, Robot, Warning, joints_for},
    wire::{NO_FUNCTION, Response},
};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rcs_core::{
    frame::Vector,
    interface::device::LinkBytes,
    kinematics::{HOME_JOINTS, Joints, T3},
    pose::WireFrame,
};

pub use self::stage::Stage;
use crate::{arm::Arm, message::Message};

/// From MANUAL ON to the pressure, seconds ("a short delay", ASSUMED).
const PUMP_S: f64 = 0.5;
/// Speed of motions that the controller makes by itself, degrees/s of the fastest joint (ASSUMED).
const OWN_SPEED: f64 = 10.0;
/// The two short vertical motions of the program: up by this much, inches, and down again (ASSUMED).
const VERTICAL_IN: f64 = 1.0;
/// Time for each of them, seconds (ASSUMED).
const VERTICAL_S: f64 = 0.5;
/// Where the last shift has left the arm: greatest distance of each joint from its arrow, degrees (ASSUMED).
const LEFT_OFF: f64 = 2.0;
/// How well a person brings a joint to its arrow: greatest error, degrees (ASSUMED).
const BY_EYE: f64 = 0.5;

/// What comes from the line in a step.
#[derive(Clone, Copy, Debug, Default)]
pub struct StepInputs {
    /// Seconds since the last step.
    pub elapsed: f64,
    /// Bytes of the host.
    pub rx: LinkBytes,
    /// The host's DTR.
    pub cts: bool,
}

/// What goes to the line.
#[derive(Clone, Copy, Debug, Default)]
pub struct StepOutputs {
    /// Bytes to the host.
    pub tx: LinkBytes,
    /// The step began a move or an answer.
    pub busy: bool,
}

/// What was counted since the program started.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Data commands executed.
    pub moves: u64,
    /// NAKs sent.
    pub naks: u64,
    /// Reports sent.
    pub reports: u64,
}

/// The set point of the servos, in words of the line.
#[derive(Clone, Debug)]
struct SetPoint {
    plate: Plate,
    joints: Joints,
}

impl Robot for SetPoint {
    fn present(&self) -> Plate {
        self.plate
    }

    fn move_to(&mut self, goal: &Plate) -> Result<(), JointProblem> {
        self.joints = joints_for(&T3, goal, &self.joints)?;
        self.plate = *goal;
        Ok(())
    }
}

/// The controller and its robot.
#[derive(Debug)]
pub struct Machine {
    stage: Stage,
    limits: Limits,
    arm: Arm,
    noise: ChaCha8Rng,
    aligned: [bool; 6],
    /// Axes on their way to the arrow.
    aligning: [bool; 6],
    /// Seconds in this stage.
    since: f64,
    /// Height of the hand when the pressure came, for the message.
    before_jump: Option<Vector>,
    /// Vertical motions done.
    motions: u8,
    depc: Controller,
    set_point: SetPoint,
    /// Keys for the next step of the function.
    keys: ControllerInputs,
    /// The RS232 board is in its slot.
    board: bool,
    /// Its transmitter works.
    transmitter: bool,
    counts: Counts,
    messages: Vec<Message>,
}

impl Machine {
    /// A controller without power, its robot sunk onto the shot pin near HOME. `seed` says how far the joints are off.
    #[must_use]
    pub fn new(limits: Limits, seed: u64) -> Self {
        let mut noise = ChaCha8Rng::seed_from_u64(seed);
        let left = off_home(&mut noise, LEFT_OFF);
        Self {
            stage: Stage::Dark,
            limits,
            arm: Arm::sunk_below(left),
            noise,
            aligned: [false; 6],
            aligning: [false; 6],
            since: 0.0,
            before_jump: None,
            motions: 0,
            depc: Controller::new(limits),
            set_point: SetPoint { plate: Plate::default(), joints: HOME_JOINTS },
            keys: ControllerInputs::default(),
            board: true,
            transmitter: true,
            counts: Counts::default(),
            messages: Vec::new(),
        }
    }

    /// How far the start-up has come.
    #[must_use]
    pub fn stage(&self) -> Stage {
        self.stage
    }

    /// The DEPC function; of interest in [`Stage::Depc`].
    #[must_use]
    pub fn depc(&self) -> &Controller {
        &self.depc
    }

    /// Axes that have their asterisk.
    #[must_use]
    pub fn aligned(&self) -> [bool; 6] {
        self.aligned
    }

    /// Hold is on.
    #[must_use]
    pub fn hold(&self) -> bool {
        self.keys.hold
    }

    /// The robot stands where it was sent to.
    #[must_use]
    pub fn at_rest(&self) -> bool {
        self.arm.settled()
    }

    /// What was counted.
    #[must_use]
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// The displayed position (IV.3.3 step 11).
    #[must_use]
    pub fn position(&self) -> WireFrame {
        WireFrame::from_frame(&self.arm.tool())
    }

    /// Messages since the last call, in order.
    pub fn messages(&mut self) -> Vec<Message> {
        std::mem::take(&mut self.messages)
    }

    /// Let time pass: the robot moves, and the DEPC function takes one step if it is reached.
    pub fn step(&mut self, inputs: &StepInputs) -> StepOutputs {
        let program = matches!(self.stage, Stage::Homing | Stage::Rehearsing);
        self.arm.advance(inputs.elapsed, self.keys.hold && program);
        self.since += inputs.elapsed;
        match self.stage {
            Stage::Rising => self.rise(),
            Stage::Manual => self.watch_axes(),
            Stage::Homing if self.arm.settled() => {
                self.enter(Stage::Auto);
                self.messages.push(Message::Position(self.position()));
            }
            Stage::Rehearsing if self.arm.settled() => return self.rehearse(inputs),
            Stage::Depc => return self.depc_step(inputs, false),
            _ => {}
        }
        StepOutputs::default()
    }

    fn enter(&mut self, stage: Stage) {
        self.stage = stage;
        self.since = 0.0;
    }

    fn lamp(&mut self, text: &'static str) {
        self.messages.push(Message::Lamp(text));
    }

    fn robot(&mut self, text: impl Into<String>) {
        self.messages.push(Message::Robot(text.into()));
    }

    fn end_program(&mut self, stage: Stage) {
        self.depc = Controller::new(self.limits);
        self.keys = ControllerInputs { hold: self.keys.hold, ..ControllerInputs::default() };
        self.enter(stage);
    }

    fn go_home(&mut self) {
        self.end_program(Stage::Homing);
        self.robot("moves directly to HOME");
        self.travel(HOME_JOINTS);
    }

    /// Move all joints at the controller's own speed.
    fn travel(&mut self, goal: Joints) {
        let ways = goal.iter().zip(self.arm.command()).map(|(goal, at)| (goal - at).abs());
        let longest = ways.fold(0.0, f64::max);
        self.arm.reach(goal, longest / OWN_SPEED.to_radians());
    }

    /// The pump runs; then the servos have pressure and jump to their command.
    fn rise(&mut self) {
        match self.before_jump {
            None if self.since >= PUMP_S => {
                self.before_jump = Some(self.arm.tool().position);
                self.arm.set_pressure(true);
            }
            Some(before) if self.arm.settled() => {
                let jump = (self.arm.tool().position - before).norm();
                self.before_jump = None;
                self.enter(Stage::Manual);
                self.robot(format!("the hand has jumped by {jump:.1} in and stands"));
                self.messages.push(Message::Aligned(self.aligned));
            }
            _ => {}
        }
    }

    fn watch_axes(&mut self) {
        if self.aligning == [false; 6] || !self.arm.settled() {
            return;
        }
        for (aligned, arrived) in self.aligned.iter_mut().zip(std::mem::take(&mut self.aligning)) {
            *aligned |= arrived;
        }
        self.messages.push(Message::Aligned(self.aligned));
    }

    /// Up, down, and on to the DEPC function.
    fn rehearse(&mut self, inputs: &StepInputs) -> StepOutputs {
        self.motions += 1;
        let mut raised = T3.forward(&HOME_JOINTS);
        raised.position.z += VERTICAL_IN;
        match (self.motions, T3.inverse(&raised, &HOME_JOINTS)) {
            (1, Ok(up)) => self.arm.reach(up, VERTICAL_S),
            (2, _) => self.arm.reach(HOME_JOINTS, VERTICAL_S),
            _ => {
                // HOME lies well within the words of the line.
                let home = Plate::from_frame(&T3.forward_plate(&HOME_JOINTS), &Plate::default());
                self.set_point = SetPoint { plate: home.unwrap_or_default(), joints: HOME_JOINTS };
                self.enter(Stage::Depc);
                return self.depc_step(inputs, true);
            }
        }
        StepOutputs::default()
    }

    fn depc_step(&mut self, inputs: &StepInputs, start: bool) -> StepOutputs {
        let (state, warning) = (self.depc.state(), self.depc.warning());
        let answered = self.keys.enter || start;
        let panel = ControllerInputs {
            rx: inputs.rx,
            cts: inputs.cts,
            board: self.board,
            transmitter_fault: !self.transmitter,
            start,
            ..self.keys
        };
        let out = self.depc.step(&panel, &mut self.set_point);
        self.keys = ControllerInputs { hold: self.keys.hold, ..ControllerInputs::default() };
        if out.moving {
            self.counts.moves += 1;
            self.arm.reach(self.set_point.joints, f64::from(self.limits.period_us()) / 1e6);
        }
        if out.function != NO_FUNCTION {
            self.messages.push(Message::Function(out.function));
        }
        self.tell(out.tx.as_slice(), state, warning, answered);
        StepOutputs { tx: out.tx, busy: out.moving || out.tx.length > 0 }
    }

    /// Messages and stages that follow from a step of the function.
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
                self.robot("pre-manual mode");
            }
            (_, ControllerState::Ended) => {
                self.messages.push(Message::Ended);
                self.go_home();
            }
            _ => {}
        }
    }
}

/// HOME with every joint off by a seeded angle of at most `greatest` degrees.
fn off_home(noise: &mut ChaCha8Rng, greatest: f64) -> Joints {
    HOME_JOINTS.map(|joint| {
        // 53 random bits make the fraction of an f64 in 0..1.
        let fraction = (noise.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        joint + (greatest * (2.0 * fraction - 1.0)).to_radians()
    })
}

#[cfg(test)]
mod tests;
