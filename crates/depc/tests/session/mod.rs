//! Both ends of the link, the line, a robot that checks its moves, and the true state of every command.

#![allow(dead_code, unreachable_pub, reason = "each test uses a part of it")]

use depc::link::{LinkBytes, LinkFault};
use depc::{
    Limits, Plate,
    controller::{Controller, ControllerInputs, ControllerState, Refusal, Robot, Warning, joints_for},
    fault::{Direction, Injector, Numbers, Plan},
    host::{ANSWER_TICKS, Host, HostEvent, Intent},
    step::{Position, step},
    wire::{DataCommand, NO_FUNCTION},
};
use geometry::{
    frame::{Frame, Vector, rotation_by},
    kinematics::{HOME_JOINTS, Joints, T3},
};
use rcs_core::tick::Tick;

const OPERATOR_TICKS: u32 = 50; // until the operator answers a warning or restarts
const REPORT_TICKS: u32 = 32; // ticks to report a stopped controller: the answer time, then a second of silence

/// A robot that reaches every position exactly and checks every step.
#[derive(Clone, PartialEq, Debug)]
pub struct Watched {
    joints: Joints,
    pub at: Plate,
    pub moves: usize,
}

impl Robot for Watched {
    fn present(&mut self) -> Plate {
        self.at
    }

    fn accept(&mut self, goal: &Plate) -> Result<(), Refusal> {
        self.joints = joints_for(&T3, goal, &self.joints)?;
        let way = goal.to_frame().position - self.at.to_frame().position;
        assert!(way.norm() < 0.5601, "a jump of {} in", way.norm());
        for place in 3..6 {
            let change = (i32::from(goal.words[place]) - i32::from(self.at.words[place])).rem_euclid(36_000);
            assert!(change.min(36_000 - change) <= 229, "a jump of {change} in word {place}");
        }
        self.moves += usize::from(*goal != self.at);
        self.at = *goal;
        Ok(())
    }
}

/// Wrong conclusions. None occur if checksums detect every fault and noise never looks like a frame without checksum.
#[derive(Clone, Copy, Default, Debug, PartialEq)]
pub struct Truth {
    pub started: u64,
    pub false_reports: u64,  // accepted, but never true or outdated
    pub false_commands: u64, // executed or refused with a warning, but not sent in this form
    pub false_acks: u64,     // accepted for a command that was neither executed nor refused with a warning
    pub late_commands: u64,  // executed after the host had given them up and restarted
    pub repeated: u64,       // with their function
    pub false_cancels: u64,
    pub velocity_warnings: u64,
    pub warnings: u64,
}

impl Truth {
    pub fn deceptions(&self) -> u64 {
        self.false_reports
            + self.false_commands
            + self.false_acks
            + self.late_commands
            + self.repeated
            + self.false_cancels
    }

    pub fn add(&mut self, other: &Self) {
        self.started += other.started;
        self.false_reports += other.false_reports;
        self.false_commands += other.false_commands;
        self.false_acks += other.false_acks;
        self.late_commands += other.late_commands;
        self.repeated += other.repeated;
        self.false_cancels += other.false_cancels;
        self.velocity_warnings += other.velocity_warnings;
        self.warnings += other.warnings;
    }
}

/// Uses the host like T3I, with a number in the function bytes of each command.
pub struct Session {
    pub host: Host,
    pub controller: Controller,
    pub robot: Watched,
    pub injector: Injector,
    pub truth: Truth,
    pub executed: Vec<u16>, // as sent
    pub tick: u64,
    to_host: LinkBytes,
    dtr: bool,
    position: Position,
    goal: Frame,
    numbers: Numbers,
    sent: Vec<Position>, // number 1 is the first
    frame: LinkBytes,    // the last command, and the bytes at the controller in the last tick and in this one
    arrived: [LinkBytes; 2],
    moving_to: Option<Plate>, // executed in the last tick
    late: bool,               // it was not the last one sent
    refused: Option<u16>,     // last refused with a warning
    silent: u32, // ticks since the host last accepted bytes; data of a stopped controller may still arrive
    stopped: u32,
    answers: u32,
}

impl Session {
    pub fn new(seed: u64, plan: &Plan) -> Self {
        let goal = T3.forward(&HOME_JOINTS);
        let at = Plate::from_tool(&goal, &T3, &Plate::default()).unwrap();
        Self {
            host: Host::new(ANSWER_TICKS),
            controller: Controller::new(Limits::NBS),
            robot: Watched { joints: HOME_JOINTS, at, moves: 0 },
            injector: Injector::new(plan),
            truth: Truth::default(),
            executed: Vec::new(),
            tick: 0,
            to_host: LinkBytes::default(),
            dtr: false,
            position: Position::default(),
            goal,
            numbers: Numbers::new(seed, 1),
            sent: Vec::new(),
            frame: LinkBytes::default(),
            arrived: [LinkBytes::default(); 2],
            moving_to: None,
            late: false,
            refused: None,
            silent: 0,
            stopped: OPERATOR_TICKS,
            answers: 0,
        }
    }

    fn within(&mut self, most: f64) -> f64 {
        (f64::from(self.numbers.draw()) / f64::from(u32::MAX) * 2.0 - 1.0) * most
    }

    pub fn new_goal(&mut self) {
        let home = T3.forward(&HOME_JOINTS);
        let shift = Vector::new(self.within(6.0), self.within(6.0), self.within(6.0));
        let turn = Vector::new(self.within(0.3), self.within(0.3), self.within(0.3));
        self.goal = Frame { position: home.position + shift, rotation: rotation_by(&turn) * home.rotation };
    }

    pub fn at_goal(&self) -> bool {
        self.robot.at.same(&Plate::from_tool(&self.goal, &T3, &self.robot.at).unwrap())
    }

    pub fn tick(&mut self) -> bool {
        let acknowledged = self.receive();
        let next = step(&self.position, &self.goal, &T3, &Limits::NBS).unwrap();
        let reached = self.host.can_send() && next.reached && next.position.plate == self.position.plate;
        let number = u16::try_from(self.sent.len() + 1).unwrap();
        let command = DataCommand { function: number.to_be_bytes(), plate: next.position.plate };
        let mut tx = LinkBytes::default();
        if self.host.transmit(&Intent::Position(command), &mut tx) {
            self.sent.push(next.position);
            self.frame = tx;
        }
        self.control(&tx);
        if let Some(number) = acknowledged {
            let executed = self.executed.contains(&number);
            self.truth.false_acks += u64::from(!executed && self.refused != Some(number));
        }
        self.check_that_a_stop_is_reported();
        self.tick += 1;
        reached
    }

    fn receive(&mut self) -> Option<u16> {
        self.silent += 1;
        match self.host.receive(&self.to_host, self.dtr) {
            HostEvent::Acknowledged => {
                self.silent = 0;
                self.position = *self.sent.last().unwrap();
                u16::try_from(self.sent.len()).ok()
            }
            HostEvent::Started => {
                self.silent = 0;
                self.position = Position::reported(self.host.position(), &T3);
                self.truth.started += 1;
                self.truth.false_reports += u64::from(self.position.plate != self.robot.at);
                self.host.clear_fault();
                None
            }
            HostEvent::None | HostEvent::Lost => None,
        }
    }

    fn control(&mut self, tx: &LinkBytes) {
        let now = Tick(self.tick);
        let (rx, cts) = self.injector.carry(Direction::ToController, now, tx, true);
        self.arrived = [self.arrived[1], rx];
        let answer = self.stopped >= OPERATOR_TICKS;
        if answer {
            (self.stopped, self.answers) = (0, self.answers + 1);
        }
        let (before, state) = (self.controller.warning(), self.controller.state());
        let warned = state == ControllerState::Warning;
        let give_up = self.answers % 4 == 3; // every fourth warning gets a CANCEL
        let inputs = ControllerInputs {
            rx,
            cts,
            board: true,
            start: answer && matches!(state, ControllerState::Off | ControllerState::Ended),
            enter: answer && warned && !give_up,
            cancel: answer && (warned && give_up || state == ControllerState::PreManual),
            ..Default::default()
        };
        let out = self.controller.step(&inputs, &mut self.robot);
        if out.function != NO_FUNCTION {
            self.note_executed(u16::from_be_bytes(out.function));
        }
        let understood = state == ControllerState::Running && out.tx.as_slice() == [0x06];
        if understood && !out.moving && self.controller.state() == ControllerState::Warning {
            if self.frame_has_arrived() {
                self.refused = u16::try_from(self.sent.len()).ok();
            } else {
                self.truth.false_commands += 1;
            }
        }
        self.late = out.moving && !self.frame_has_arrived();
        self.moving_to = out.moving.then(|| self.controller.commanded());
        let warning = self.controller.warning();
        if warning != before && warning != Warning::None {
            self.truth.warnings += 1;
            self.truth.velocity_warnings +=
                u64::from(matches!(warning, Warning::Translation | Warning::Orientation));
        }
        if state == ControllerState::Running && self.controller.state() == ControllerState::Ended {
            self.truth.false_cancels += 1;
        }
        self.stopped = if self.controller.state() == ControllerState::Running { 0 } else { self.stopped + 1 };
        (self.to_host, self.dtr) = self.injector.carry(Direction::ToHost, now, &out.tx, out.dtr);
    }

    fn frame_has_arrived(&self) -> bool {
        let [before, now] = &self.arrived;
        let bytes = [before.as_slice(), now.as_slice()].concat();
        bytes.windows(usize::from(self.frame.length)).any(|bytes| bytes == self.frame.as_slice())
    }

    fn note_executed(&mut self, number: u16) {
        let sent = usize::from(number).checked_sub(1).and_then(|place| self.sent.get(place));
        if sent.map(|sent| sent.plate) != self.moving_to {
            self.truth.false_commands += 1;
        } else if self.executed.last().is_some_and(|last| *last >= number) {
            self.truth.repeated += 1;
        } else {
            self.truth.late_commands += u64::from(self.late);
            self.executed.push(number);
        }
    }

    fn check_that_a_stop_is_reported(&self) {
        assert!(
            self.stopped <= REPORT_TICKS
                || self.silent <= REPORT_TICKS
                || self.host.fault() != LinkFault::None
                || self.host.is_silent()
                || !self.host.has_dtr()
                || self.truth.false_acks > 0,
            "tick {}: the controller has stopped and the host does not say so: {:?} {:?}",
            self.tick,
            self.host,
            self.controller,
        );
    }

    /// Runs on a repaired line until the goal is reached and held, for at most `most` ticks.
    pub fn until_reached(&mut self, most: u32) {
        for _ in 0..most {
            if self.tick() && self.at_goal() && self.controller.state() == ControllerState::Running {
                return;
            }
        }
        panic!("the goal is not reached in {most} ticks: {:?} {:?}", self.host, self.controller);
    }
}
