//! The T3 controller with its arm: the start-up of IV.3.3, the emergency stops of III.6 and the DEPC function
//! of appendix A as one state machine, without I/O and without a clock.
//!
//! ```text
//!   keys (console, pendant, E-stops) ──► stage: start-up, program, DEPC ──► arm: servos, hydraulics
//!                                          │      ▲
//!                                        bytes to and from the host, once a period
//! ```
//!
//! [`T3Controller::step`] is a period of the controller; [`T3Controller::advance`] lets time pass for the arm. The
//! program, with the DEPC function, runs only under pressure; without it the controller's DTR is off (A 2.3; ASSUMED:
//! the manual does not describe the effect of an emergency stop on the host).

mod key;
mod keys;
mod message;
mod program;
mod refusal;
mod stage;
#[cfg(test)]
mod tests;

use depc::{
    Limits, Plate,
    controller::{Controller, ControllerInputs, JointProblem, Refusal as Refused, Robot, joints_for},
};
use geometry::{
    frame::Frame,
    kinematics::{HOME_JOINTS, Joints, T3},
    pose::WireFrame,
};
use interfaces::{
    device::LinkBytes,
    station::{EStop, Key},
};
use serde::{Deserialize, Serialize};

pub use self::{
    key::Cut,
    message::{HOME, HOME_TOLERANCE, Lamps, Message, RobotEvent, explained, off_home as off_printed_home},
    refusal::Refusal,
    stage::Stage,
};
use crate::{
    arm::Arm,
    description::Actuators,
    linkage::Load,
    noise::{Noise, Stream},
};

/// Greatest distance of each joint from its arrow before the start-up, degrees (ASSUMED).
const LEFT_OFF: f64 = 2.0;
/// Greatest error of an operator who aligns a joint to its arrow, degrees (ASSUMED).
const BY_EYE: f64 = 0.5;

/// Screen text while FAULT RESET is lit (IV.1 step 2; ASSUMED also after an emergency stop, IV.3.1).
const FAULT: &str = "ERROR-E22";

const fn powered() -> bool {
    true
}

#[derive(Clone, Copy, Debug, Default)]
pub struct StepInputs {
    pub rx: LinkBytes,
    pub cts: bool,
}

#[derive(Clone, Copy, Debug, Default)]
pub struct StepOutputs {
    pub tx: LinkBytes,
    /// The controller's DTR, the host's CTS (A.2).
    pub dtr: bool,
    /// True if the step began a move or an answer.
    pub busy: bool,
}

#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq, Serialize)]
pub struct Counts {
    pub moves: u64,
    pub naks: u64,
    pub reports: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DriveError {
    #[error("the position is beyond the controller's coordinates of 327.67 in")]
    OutOfRange,
    #[error("the arm cannot take the position: {0:?}")]
    Joints(JointProblem),
    #[error("the arm has no hydraulic pressure")]
    NoPressure,
}

/// The set point of the servos, in words of the line.
#[derive(Clone, Debug, Deserialize, Serialize)]
struct SetPoint {
    #[serde(with = "crate::image::record")]
    plate: Plate,
    joints: Joints,
}

impl SetPoint {
    fn at(joints: &Joints) -> Result<Self, DriveError> {
        let plate = Plate::from_frame(&T3.forward_plate(joints), &Plate::default())
            .map_err(|_| DriveError::OutOfRange)?;
        Ok(Self { plate, joints: *joints })
    }

    fn take(&mut self, plate: &Plate) -> Result<(), JointProblem> {
        self.joints = joints_for(&T3, plate, &self.joints)?;
        self.plate = *plate;
        Ok(())
    }
}

impl Robot for SetPoint {
    fn present(&mut self) -> Plate {
        self.plate
    }

    fn accept(&mut self, goal: &Plate) -> Result<(), Refused> {
        Ok(self.take(goal)?)
    }
}

#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct T3Controller {
    stage: Stage,
    #[serde(with = "crate::image::record")]
    limits: Limits,
    arm: Arm,
    pump_delay: f64,
    noise: Noise,
    aligned: [bool; 6],
    aligning: [bool; 6], // axes that are moving to their arrow
    since: f64,
    /// Position of the hand when the pressure returned, in, for the message.
    before_jump: Option<[f64; 3]>,
    motions: u8,
    #[serde(with = "crate::image::record")]
    depc: Controller,
    set_point: SetPoint,
    /// Keys for the next step of the function.
    #[serde(with = "crate::image::record")]
    keys: ControllerInputs,
    board: bool, // the RS232 board is in its slot
    transmitter: bool,
    estops: [bool; 5], // the emergency stops that are pressed
    /// The Prim Interface Box has power. Only the console of `rcs-cell` removes it, so every saved cell has it.
    #[serde(skip, default = "powered")]
    prim_box: bool,
    pump: bool,       // the pump and its lines work
    cut: Option<Cut>, // cause of the loss of pressure; `None` under pressure
    counts: Counts,
    messages: Vec<Message>,
}

impl T3Controller {
    /// A controller without power, with an arm near HOME that has sagged. `seed` determines the offsets of the joints.
    #[must_use]
    pub fn dark(limits: Limits, actuators: &Actuators, seed: u64) -> Self {
        let mut noise = Noise::new(seed, Stream::Alignment);
        let left = off_home(&mut noise, LEFT_OFF);
        let set_point = SetPoint { plate: Plate::default(), joints: left };
        Self::of(limits, actuators, Arm::sunk_from(actuators, left), set_point, noise)
    }

    /// A controller after its start-up: the axes are aligned, the arm is at `start` (radians), and the program enters
    /// the DEPC function with the first step. Fails with [`DriveError::OutOfRange`] if the end plate is out of range of
    /// the words of the line.
    pub fn started(
        limits: Limits,
        actuators: &Actuators,
        start: &Joints,
        seed: u64,
    ) -> Result<Self, DriveError> {
        let noise = Noise::new(seed, Stream::Alignment);
        let arm = Arm::new(actuators, *start);
        Ok(Self {
            stage: Stage::Depc,
            aligned: [true; 6],
            keys: ControllerInputs { start: true, ..ControllerInputs::default() },
            cut: None,
            ..Self::of(limits, actuators, arm, SetPoint::at(start)?, noise)
        })
    }

    fn of(limits: Limits, actuators: &Actuators, arm: Arm, set_point: SetPoint, noise: Noise) -> Self {
        Self {
            stage: Stage::Dark,
            limits,
            arm,
            pump_delay: actuators.hydraulics.pump_delay_s,
            noise,
            aligned: [false; 6],
            aligning: [false; 6],
            since: 0.0,
            before_jump: None,
            motions: 0,
            depc: Controller::new(limits),
            set_point,
            keys: ControllerInputs::default(),
            board: true,
            transmitter: true,
            estops: [false; 5],
            prim_box: true,
            pump: true,
            cut: Some(Cut::ControlPower),
            counts: Counts::default(),
            messages: Vec::new(),
        }
    }

    #[must_use]
    pub fn stage(&self) -> Stage {
        self.stage
    }

    /// The error on the screen while FAULT RESET is lit (IV.1 step 2, IV.3.1).
    #[must_use]
    pub fn error(&self) -> Option<&'static str> {
        (self.stage == Stage::Faulted).then_some(FAULT)
    }

    /// The DEPC function; it runs in [`Stage::Depc`].
    #[must_use]
    pub fn depc(&self) -> &Controller {
        &self.depc
    }

    #[must_use]
    pub fn arm(&self) -> &Arm {
        &self.arm
    }

    /// Axes that are aligned: their asterisk is on the screen.
    #[must_use]
    pub fn aligned(&self) -> [bool; 6] {
        self.aligned
    }

    #[must_use]
    pub fn hold(&self) -> bool {
        self.keys.hold
    }

    #[must_use]
    pub fn is_pressed(&self, site: EStop) -> bool {
        self.estops[usize::from(site.code())]
    }

    /// Cause of the loss of pressure; `None` under pressure.
    #[must_use]
    pub fn cut(&self) -> Option<Cut> {
        self.cut
    }

    #[must_use]
    pub fn at_rest(&self) -> bool {
        self.arm.settled()
    }

    /// True while an action that a key has started is in progress and ends by itself.
    #[must_use]
    pub fn busy(&self) -> bool {
        match self.stage {
            Stage::Rising | Stage::Homing | Stage::Rehearsing => !self.keys.hold,
            Stage::Manual => self.aligning != [false; 6],
            _ => false,
        }
    }

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

    /// Advance the arm by `seconds`. `loads` are the forces on it in addition to the weight of its links.
    pub fn advance(&mut self, seconds: f64, loads: &[Load]) {
        let program = matches!(self.stage, Stage::Homing | Stage::Rehearsing);
        self.arm.advance(seconds, self.keys.hold && program, loads);
        self.since += seconds;
    }

    /// One period of the controller: continues the start-up, or takes one step of the DEPC function.
    pub fn step(&mut self, inputs: &StepInputs) -> StepOutputs {
        match self.stage {
            Stage::Rising => self.rise(),
            Stage::Manual => self.watch_axes(),
            Stage::Homing if self.arm.settled() => {
                self.enter(Stage::Auto);
                self.messages.push(Message::Position(self.position()));
            }
            Stage::Rehearsing if self.arm.settled() => return self.rehearse(inputs),
            Stage::Depc => return self.depc_step(inputs),
            _ => {}
        }
        StepOutputs::default()
    }

    /// Move the arm to an end-plate frame (in, world) within a period, without the line's limits. On error, the command
    /// is unchanged.
    pub fn drive(&mut self, plate: &Frame) -> Result<(), DriveError> {
        if !self.arm.has_pressure() {
            return Err(DriveError::NoPressure);
        }
        let words = Plate::from_frame(plate, &self.set_point.plate).map_err(|_| DriveError::OutOfRange)?;
        self.set_point.take(&words).map_err(DriveError::Joints)?;
        self.reach_set_point(1.0);
        Ok(())
    }

    /// Follow the position of another robot within `periods` of a period. An arm without pressure does not move. Fails
    /// with [`JointProblem`] if this arm cannot reach the position; the command is unchanged.
    pub fn follow(&mut self, plate: &Plate, periods: f64) -> Result<(), JointProblem> {
        if self.arm.has_pressure() && *plate != self.set_point.plate {
            self.set_point.take(plate)?;
            self.reach_set_point(periods);
        }
        Ok(())
    }

    fn reach_set_point(&mut self, periods: f64) {
        self.arm.reach(self.set_point.joints, periods * f64::from(self.limits.period_us()) / 1e6);
    }

    fn enter(&mut self, stage: Stage) {
        self.stage = stage;
        self.since = 0.0;
    }

    fn lamps(&mut self, change: Lamps) {
        self.messages.push(Message::Lamps(change));
    }

    fn robot(&mut self, event: RobotEvent) {
        self.messages.push(Message::Robot(event));
    }
}

/// HOME with an error of each joint of up to `greatest` degrees, from the seed.
fn off_home(noise: &mut Noise, greatest: f64) -> Joints {
    HOME_JOINTS.map(|joint| joint + noise.within(greatest).to_radians())
}
