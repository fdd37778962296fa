//! An emulated EGM robot in pose mode after the application manual (3HAC073318), with the arm of the T3. It has not
//! been compared with a controller of ABB.
//!
//! ```text
//!   speed = k (reference - position) + speedRef, limited to MaxSpeedDeviation, through a low pass, ramped in
//! ```
//!
//! References are poses; the loop is closed on the joints. Each cycle reads one message; without one, the last
//! reference and its speed stay in effect.

use std::{collections::VecDeque, f64::consts::TAU};

use egm::{
    Pose, Twist,
    message::{
        Header, MciState, MessageType, Motion, MotorState, RapidState, Robot, Sensor, Values, WirePose,
    },
};
use geometry::kinematics::{HOME_JOINTS, Joints, T3};

use crate::egm::Placement;

pub const CYCLE_NS: u64 = 4_032_000; // cycle time of the robot, ns
const CYCLE_S: f64 = 0.004_032; // cycle time of the robot, s
const MOST_WAITING: usize = 10; // greatest number of messages in the queue
const FINE: f64 = 1e-4; // the robot is in a fine point if no joint is faster than this, rad/s
/// `mciConvergenceMet` is set if all joints are nearer to their reference than this, rad.
const CONVERGED: f64 = 1e-4;

/// Settings of the RAPID program and of the controller's configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuning {
    /// Proportional gain of the position loop, 1/s: 0 to 20.
    pub gain: f64,
    /// Corner frequency of the low pass, Hz: 0 to 100; 0 switches it off.
    pub low_pass: f64,
    /// Time over which corrections are ramped in, s: 0.005 to 10.
    pub ramp_s: f64,
    /// `\MaxSpeedDeviation`: greatest speed of a joint, degrees/s. The controller's default is 1.0.
    pub max_speed_deviation: f64,
    pub comm_timeout_s: f64, // s
    /// "Do Not Restart after Motors Off".
    pub do_not_restart: bool,
    /// Increment of the sequence number per message.
    pub seqno_step: u32,
}

impl Default for Tuning {
    /// The controller's defaults, except a speed deviation of 90 degrees/s, so that the robot can move.
    fn default() -> Self {
        Self {
            gain: 5.0,
            low_pass: 20.0,
            ramp_s: 0.5,
            max_speed_deviation: 90.0,
            comm_timeout_s: 1.0,
            do_not_restart: true,
            seqno_step: 1,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stopped {
    Program,
    Emergency,
    /// No message for `\CommTimeout`: ERR_UDPUC_COMM.
    Communication,
    /// The joints cannot reach a target: a singularity, a limit, or out of reach.
    Joints,
}

impl Stopped {
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::Program => "the program is stopped",
            Self::Emergency => "emergency stop",
            Self::Communication => "no message within CommTimeout (ERR_UDPUC_COMM)",
            Self::Joints => "a target that the joints cannot take",
        }
    }
}

#[derive(Clone, Debug)]
pub struct EgmRobot {
    tuning: Tuning,
    placement: Placement,
    joints: Joints,
    speed: Joints,
    reference: Option<(Joints, Joints)>, // target of the joints, rad, and its speed, rad/s
    stopped: Option<Stopped>,            // `None` while EGM runs
    motors: bool,
    starting: bool, // EGM waits for a fine point before it runs
    running_s: f64, // time since EGM began to run, s
    silent_s: f64,  // time since the last message was read, s
    waiting: VecDeque<Sensor>,
    seqno: u32,
    time_ns: u64,
}

fn each(joints: &Joints, other: &Joints, with: impl Fn(f64, f64) -> f64) -> Joints {
    std::array::from_fn(|joint| with(joints[joint], other[joint]))
}

fn fastest(joints: &Joints) -> f64 {
    joints.iter().fold(0.0, |most, joint| joint.abs().max(most))
}

impl EgmRobot {
    /// A robot at HOME of the T3, with motors on and its program at the EGM instruction.
    #[must_use]
    pub fn new(tuning: Tuning, placement: Placement) -> Self {
        Self {
            tuning,
            placement,
            joints: HOME_JOINTS,
            speed: [0.0; 6],
            reference: None,
            stopped: None,
            motors: true,
            starting: true,
            running_s: 0.0,
            silent_s: 0.0,
            waiting: VecDeque::with_capacity(MOST_WAITING),
            seqno: 0,
            time_ns: 0,
        }
    }

    #[must_use]
    pub const fn joints(&self) -> &Joints {
        &self.joints
    }

    /// Pose of the tool in the work object, mm.
    #[must_use]
    pub fn pose(&self) -> Pose {
        self.placement.pose(&T3.forward_plate(&self.joints))
    }

    /// Why EGM does not run; `None` while it runs.
    #[must_use]
    pub const fn stopped(&self) -> Option<Stopped> {
        self.stopped
    }

    /// Emergency stop: motors off, brakes on.
    pub fn emergency_stop(&mut self) {
        self.motors = false;
        self.speed = [0.0; 6];
        self.stopped = Some(Stopped::Emergency);
    }

    pub fn stop(&mut self) {
        self.stopped = self.stopped.or(Some(Stopped::Program));
    }

    /// Motors on. With "Do Not Restart after Motors Off" the program waits for a start.
    pub fn motors_on(&mut self) {
        self.motors = true;
        if self.stopped == Some(Stopped::Emergency) && !self.tuning.do_not_restart {
            self.stopped = None;
            self.running_s = 0.0;
        }
    }

    pub fn start(&mut self) {
        if self.motors {
            (self.stopped, self.starting, self.reference) = (None, true, None);
            (self.running_s, self.silent_s) = (0.0, 0.0);
            self.waiting.clear();
        }
    }

    /// Puts a received datagram into the queue. Errors: the decoding error; the robot does not answer.
    pub fn receive(&mut self, datagram: &[u8]) -> Result<(), egm::Error> {
        let message = Sensor::decode(datagram)?;
        if self.waiting.len() < MOST_WAITING {
            self.waiting.push_back(message);
        }
        Ok(())
    }

    /// Executes a cycle: reads a message, moves, and returns the message with the robot's state.
    pub fn cycle(&mut self) -> Robot {
        self.time_ns = self.time_ns.saturating_add(CYCLE_NS);
        if self.starting && self.stopped.is_none() && fastest(&self.speed) < FINE {
            self.starting = false;
        }
        let message = self.waiting.pop_front();
        if self.runs() {
            self.silent_s = if message.is_some() { 0.0 } else { self.silent_s + CYCLE_S };
            if let Some(message) = message {
                self.take(&message);
            }
            if self.reference.is_some() && self.silent_s >= self.tuning.comm_timeout_s {
                self.stopped = Some(Stopped::Communication);
            }
        }
        self.drive();
        self.message()
    }

    fn runs(&self) -> bool {
        self.motors && self.stopped.is_none() && !self.starting
    }

    /// Takes the reference of a message. The emulator ignores a message without a pose, such as a joint message.
    fn take(&mut self, message: &Sensor) {
        let Some(Ok(pose)) = message.planned.and_then(|planned| planned.cartesian).map(|pose| pose.pose())
        else {
            return;
        };
        let speed = message.speed_ref.map(|speed| speed.twist()).unwrap_or_default();
        match self.joints_for(&pose, &speed) {
            Some(reference) => self.reference = Some(reference),
            None => self.stopped = Some(Stopped::Joints),
        }
    }

    fn joints_for(&self, pose: &Pose, speed: &Twist) -> Option<(Joints, Joints)> {
        let solve = |pose: &Pose, near: &Joints| {
            let joints = T3.inverse(&self.placement.tool_frame(pose), near).ok()?;
            let within =
                joints.iter().zip(T3.limits).all(|(joint, (low, high))| (low..=high).contains(joint));
            within.then_some(joints)
        };
        let joints = solve(pose, &self.joints)?;
        let later =
            T3.inverse(&self.placement.tool_frame(&pose.moved(&speed.scaled(CYCLE_S))), &joints).ok()?;
        Some((joints, each(&later, &joints, |later, now| (later - now) / CYCLE_S)))
    }

    fn drive(&mut self) {
        let wanted = match self.reference.filter(|_| self.runs()) {
            Some((at, speed)) => {
                self.running_s += CYCLE_S;
                let ramp = (self.running_s / self.tuning.ramp_s.max(CYCLE_S)).min(1.0);
                let most = self.tuning.max_speed_deviation.to_radians();
                let lack = each(&at, &self.joints, |at, here| self.tuning.gain * (at - here));
                each(&lack, &speed, |lack, speed| (ramp * (lack + speed)).clamp(-most, most))
            }
            None => [0.0; 6],
        };
        let part = match self.tuning.low_pass {
            corner if corner > 0.0 => 1.0 - (-TAU * corner * CYCLE_S).exp(),
            _ => 1.0,
        };
        if self.motors {
            self.speed = each(&self.speed, &wanted, |speed, wanted| speed + (wanted - speed) * part);
            self.joints = each(&self.joints, &self.speed, |joint, speed| joint + speed * CYCLE_S);
        }
    }

    fn message(&mut self) -> Robot {
        self.seqno = self.seqno.wrapping_add(self.tuning.seqno_step);
        let milliseconds = u32::try_from(self.time_ns / 1_000_000 % (1 << 32)).unwrap_or_default();
        let motion = |joints: &Joints| Motion {
            joints: Some(Values::of(&joints.map(f64::to_degrees))),
            cartesian: Some(WirePose::of(&self.placement.pose(&T3.forward_plate(joints)))),
            ..Motion::default()
        };
        let planned = self.reference.map_or(self.joints, |(joints, _)| joints);
        let most = self.tuning.max_speed_deviation.to_radians();
        Robot {
            header: Some(Header::new(self.seqno, milliseconds, MessageType::Data)),
            feedback: Some(motion(&self.joints)),
            planned: Some(motion(&planned)),
            motor_state: Some(if self.motors { MotorState::On } else { MotorState::Off }),
            mci_state: Some(match self.stopped {
                None if self.runs() => MciState::Running,
                Some(Stopped::Communication | Stopped::Joints) => MciState::Error,
                _ => MciState::Stopped,
            }),
            mci_convergence_met: Some(fastest(&each(&planned, &self.joints, |to, at| to - at)) < CONVERGED),
            rapid_state: Some(if self.stopped.is_none() { RapidState::Running } else { RapidState::Stopped }),
            utilization_rate: Some(100.0 * fastest(&self.speed) / most),
            move_index: Some(0),
            ..Robot::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egm::message::MOST_BYTES;

    struct Bench {
        robot: EgmRobot,
        target: Pose,
        speed: Option<Twist>,
    }

    impl Bench {
        fn new(tuning: Tuning) -> Self {
            let robot = EgmRobot::new(tuning, Placement::default());
            Self { target: robot.pose(), speed: None, robot }
        }

        fn cycles(&mut self, count: u32) -> Robot {
            let mut last = Robot::default();
            for cycle in 0..count {
                let answer = Sensor::target(cycle, 0, &self.target, self.speed.as_ref());
                self.robot.receive(answer.encode(&mut [0; MOST_BYTES]).unwrap()).unwrap();
                last = self.robot.cycle();
            }
            last
        }

        fn off(&self) -> f64 {
            self.robot.pose().distance(&self.target).0
        }
    }

    #[test]
    fn a_step_is_approached_with_the_time_of_the_gain() {
        let mut bench = Bench::new(Tuning { low_pass: 0.0, ramp_s: 0.005, ..Tuning::default() });
        bench.cycles(10);
        bench.target.position[2] += 20.0;
        // After one time constant of 0.2 s the distance is 1/e.
        bench.cycles(50);
        assert!((bench.off() / 20.0 - (-1.0_f64).exp()).abs() < 0.02, "{}", bench.off());
        bench.cycles(800);
        assert!(bench.off() < 0.01, "{}", bench.off());
    }

    #[test]
    fn the_default_speed_deviation_hardly_moves_the_robot() {
        let mut bench = Bench::new(Tuning { max_speed_deviation: 1.0, ..Tuning::default() });
        bench.target.position[2] += 50.0;
        let message = bench.cycles(100);
        assert!(bench.off() > 30.0 && message.utilization_rate.is_some_and(|rate| rate > 99.0));
    }

    #[test]
    fn speed_ref_removes_the_lag() {
        let follow = |with_speed: bool| {
            let mut bench = Bench::new(Tuning::default());
            let twist = Twist { linear: [0.0, 0.0, 100.0], angular: [0.0; 3] };
            bench.speed = with_speed.then_some(twist);
            bench.cycles(1);
            for _ in 0..500 {
                bench.target = bench.target.moved(&twist.scaled(CYCLE_S));
                bench.cycles(1);
            }
            bench.off()
        };
        let (without, with) = (follow(false), follow(true));
        assert!((without - 20.0).abs() < 2.0, "100 mm/s over a gain of 5: {without}");
        assert!(with < 2.5, "{with}");
    }

    #[test]
    fn states_follow_the_events() {
        let mut bench = Bench::new(Tuning::default());
        let message = bench.cycles(3);
        assert_eq!((message.mci_state, message.motor_state), (Some(MciState::Running), Some(MotorState::On)));
        for _ in 0..260 {
            bench.robot.cycle();
        }
        assert_eq!(bench.robot.stopped(), Some(Stopped::Communication));
        assert_eq!(bench.robot.cycle().mci_state, Some(MciState::Error));
        bench.robot.start();
        assert_eq!(bench.cycles(3).mci_state, Some(MciState::Running));
        bench.target.position[0] += 5000.0;
        bench.cycles(1);
        assert_eq!(bench.robot.stopped(), Some(Stopped::Joints));
    }

    #[test]
    fn egm_resumes_after_an_emergency_stop_only_if_configured() {
        for (do_not_restart, has_next) in [(true, false), (false, true)] {
            let mut bench = Bench::new(Tuning { do_not_restart, ..Tuning::default() });
            bench.target.position[2] += 100.0;
            bench.cycles(20);
            bench.robot.emergency_stop();
            let stood = bench.robot.pose();
            let message = bench.cycles(20);
            assert_eq!(message.motor_state, Some(MotorState::Off));
            assert_eq!(bench.robot.pose(), stood);
            bench.robot.motors_on();
            bench.cycles(100);
            assert_eq!(bench.robot.pose() != stood, has_next);
            bench.robot.start();
            bench.cycles(1000);
            assert!(bench.off() < 0.1);
        }
    }

    #[test]
    fn the_last_reference_is_used_and_one_message_per_cycle_is_read() {
        let mut bench = Bench::new(Tuning::default());
        bench.cycles(2);
        for step in 1..=5 {
            let pose = Pose { position: [0.0, 0.0, f64::from(step)], ..bench.target };
            let moved = bench.target.moved(&Twist { linear: pose.position, angular: [0.0; 3] });
            let answer = Sensor::target(step, 0, &moved, None);
            bench.robot.receive(answer.encode(&mut [0; MOST_BYTES]).unwrap()).unwrap();
        }
        bench.robot.cycle();
        assert_eq!(bench.robot.waiting.len(), 4);
        for _ in 0..240 {
            bench.robot.cycle();
        }
        bench.target.position[2] += 5.0;
        assert!(bench.off() < 0.5, "{}", bench.off());
    }
}
