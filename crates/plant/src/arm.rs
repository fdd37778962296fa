//! The hydraulic arm: its servos follow a command under pressure; its joints sag without.
//!
//! Under pressure the joints follow their command with a first-order lag, up to their greatest speed. The lag is
//! integrated exactly: an arm at rest is at its command. Its deflection under load is in [`crate::gripper`].
//!
//! Without pressure (III.6) each joint is a damper that yields to the weight of the links, to loads on them, and to
//! contacts:
//!
//! ```text
//!   damping x rate = torque of the weights + torque of the contacts
//! ```
//!
//! Inertia is neglected: it has no effect at three degrees per second. The equation is implicit in the large stiffness
//! of the contacts, so that an arm on an obstacle comes to rest. The servos keep their command within their following
//! error, and jump back to it when the pressure returns.

use geometry::{
    frame::{Frame, Vector},
    kinematics::{HOME_JOINTS, Joints, T3},
};
use nalgebra::{Matrix6, Vector6};
use serde::{Deserialize, Serialize};

use crate::{
    description::{Actuators, Hydraulics},
    linkage::{Chain, END_PLATE, FOREARM, Load, UPPER_ARM},
};

const SHOULDER: usize = 1; // indices of shoulder, elbow and pitch among the joints
const ELBOW: usize = 2;
const PITCH: usize = 3;
const WRIST: usize = 4; // index of the link that the yaw joint turns

/// Distance of the upper arm's centre of mass from the shoulder, in (ASSUMED: in its middle).
const UPPER_ARM_CENTRE: f64 = 0.5 * T3.upper_arm;
/// Distance of the forearm's centre of mass from the elbow, in (ASSUMED: the wrist's actuators sit at the elbow).
const FOREARM_CENTRE: f64 = 0.4 * T3.forearm;
/// Distance of the wrist's centre of mass from the yaw axis, in (ASSUMED).
const WRIST_CENTRE: f64 = 1.5;
/// Distance of the centre of mass of quick change and gripper from the yaw axis, in (ASSUMED: in the middle).
pub const TOOL_CENTRE: f64 = T3.yaw_to_plate + T3.plate_to_tool / 2.0;

/// An arm without pressure is at rest if no joint is faster than this, rad/s.
const AT_REST: f64 = 0.2 * (core::f64::consts::PI / 180.0);
/// Full friction from this speed on, in/s; below it, friction is proportional to speed.
const STICKING: f64 = 0.1;
const STEP_S: f64 = 0.0025; // longest step of the servo equation, s
/// A joint within this distance of its command has settled, rad.
const SETTLED: f64 = 0.005 * (core::f64::consts::PI / 180.0);

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
struct Ramp {
    from: Joints,
    goal: Joints,
    elapsed: f64,
    duration: f64,
}

impl Ramp {
    const fn at(joints: Joints) -> Self {
        Self { from: joints, goal: joints, elapsed: 0.0, duration: 0.0 }
    }

    fn is_over(&self) -> bool {
        self.elapsed >= self.duration
    }

    fn present(&self) -> Joints {
        if self.is_over() {
            return self.goal;
        }
        let share = self.elapsed / self.duration;
        core::array::from_fn(|joint| self.from[joint] + (self.goal[joint] - self.from[joint]) * share)
    }
}

/// Joints, servos and pressure. Angles in radians.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Arm {
    actuators: Actuators,
    dampers: [f64; 6], // damping of each joint without pressure, lb·in·s/rad
    joints: Joints,
    command: Ramp,
    pressure: bool,
    pin: f64,        // shoulder angle at the shot pin, which is extended without pressure, rad
    rates: [f64; 6], // rates of the joints in the last step without pressure, rad/s
    sinking: f64,    // time since the loss of pressure, s
}

impl Arm {
    #[must_use]
    pub fn new(actuators: &Actuators, joints: Joints) -> Self {
        Self {
            dampers: dampers(&actuators.hydraulics),
            actuators: actuators.clone(),
            joints,
            command: Ramp::at(joints),
            pressure: true,
            pin: T3.limits[SHOULDER].0,
            rates: [0.0; 6],
            sinking: 0.0,
        }
    }

    #[must_use]
    pub fn sunk_from(actuators: &Actuators, joints: Joints) -> Self {
        const SAG_TIME_S: u32 = 600;
        let mut arm = Self::new(actuators, joints);
        arm.set_pressure(false);
        for _ in 0..SAG_TIME_S * 20 {
            arm.sag(0.05, &[arm.tool_weight()]);
        }
        arm
    }

    #[must_use]
    pub fn tool_weight(&self) -> Load {
        let chain = Chain::new(&self.joints);
        Load::weight(END_PLATE, chain.along(END_PLATE, TOOL_CENTRE), self.actuators.hydraulics.tool_weight)
    }

    /// Turn the pressure on or off. The loss of pressure stops the motion, keeps the present command, and
    /// extends the shot pin.
    pub fn set_pressure(&mut self, on: bool) {
        if self.pressure && !on {
            self.stop();
            let below = self.joints[SHOULDER] - self.actuators.hydraulics.shot_pin.to_radians();
            self.pin = below.max(T3.limits[SHOULDER].0);
        }
        self.pressure = on;
        self.rates = [0.0; 6];
        self.sinking = 0.0;
    }

    #[must_use]
    pub const fn has_pressure(&self) -> bool {
        self.pressure
    }

    /// Move the command at constant speed to `goal` within `seconds`.
    pub fn reach(&mut self, goal: Joints, seconds: f64) {
        self.command = Ramp { from: self.command.present(), goal, elapsed: 0.0, duration: seconds.max(0.0) };
    }

    pub fn stop(&mut self) {
        self.command = Ramp::at(self.command.present());
    }

    /// Advance by `seconds`. While `held` the command does not move. `loads` are the forces on the arm in addition to
    /// the weight of its links; they move it only without pressure.
    pub fn advance(&mut self, seconds: f64, held: bool, loads: &[Load]) {
        let mut left = seconds;
        while left > 0.0 {
            let dt = left.min(STEP_S);
            left -= dt;
            if self.pressure {
                if !held {
                    self.command.elapsed += dt;
                }
                self.follow(dt);
            } else {
                self.sag(dt, loads);
            }
        }
    }

    fn follow(&mut self, dt: f64) {
        let share = 1.0 - libm::exp(-dt / self.actuators.lag_s);
        let command = self.command.present();
        for ((joint, command), speed) in self.joints.iter_mut().zip(command).zip(self.actuators.speeds) {
            let greatest = speed.to_radians() * dt;
            *joint += ((command - *joint) * share).clamp(-greatest, greatest);
        }
    }

    fn sag(&mut self, dt: f64, loads: &[Load]) {
        let chain = Chain::new(&self.joints);
        let mut torque = Vector6::zeros();
        let mut damping = Matrix6::from_diagonal(&Vector6::from(self.dampers));
        for load in weights(&chain, &self.actuators.hydraulics).iter().chain(loads) {
            torque += chain.torque(load);
            let Some(along) = load.force.try_normalize(0.0) else { continue };
            let lever = |along: &Vector| chain.lever(load.link, &load.at, along);
            if load.stiffness > 0.0 {
                damping += square(&lever(&along)) * (load.stiffness * dt);
            }
            if load.friction > 0.0 {
                let levers = [Vector::x(), Vector::y(), Vector::z()]
                    .map(|axis| lever(&(axis - along * along.dot(&axis))));
                let rates = Vector6::from(self.rates);
                let speed = levers.iter().map(|lever| lever.dot(&rates)).fold(0.0, libm::hypot);
                let drag = load.friction * load.force.norm() / speed.max(STICKING);
                damping += levers.iter().map(square).sum::<Matrix6<f64>>() * drag;
            }
        }
        self.rates = self.give_way(dt, damping, torque);
        self.sinking += dt;
        for (joint, rate) in self.joints.iter_mut().zip(self.rates) {
            *joint += rate * dt;
        }
        let error = self.actuators.hydraulics.following_error.to_radians();
        let mut command = self.command.present();
        for (command, joint) in command.iter_mut().zip(self.joints) {
            *command = command.clamp(joint - error, joint + error);
        }
        self.command = Ramp::at(command);
    }

    /// Rates of the joints, rad/s. A joint that would pass a stop ends at it; the others move as if it were fixed.
    fn give_way(&self, dt: f64, mut damping: Matrix6<f64>, mut torque: Vector6<f64>) -> [f64; 6] {
        let mut stopped = [None; 6];
        loop {
            let solved = damping.cholesky().map_or_else(Vector6::zeros, |cholesky| cholesky.solve(&torque));
            let mut rates: [f64; 6] = solved.into();
            let mut beyond = false;
            for (joint, rate) in rates.iter_mut().enumerate() {
                if let Some(stopped) = stopped[joint] {
                    *rate = stopped;
                    continue;
                }
                let (mut low, high) = T3.limits[joint];
                if joint == SHOULDER {
                    low = low.max(self.pin);
                }
                let next = self.joints[joint] + *rate * dt;
                let stop = next.clamp(low.min(self.joints[joint]), high.max(self.joints[joint]));
                if next != stop {
                    stopped[joint] = Some((stop - self.joints[joint]) / dt);
                    damping.fill_row(joint, 0.0);
                    damping.fill_column(joint, 0.0);
                    damping[(joint, joint)] = 1.0;
                    torque[joint] = 0.0;
                    beyond = true;
                }
            }
            if !beyond {
                return rates;
            }
        }
    }

    #[must_use]
    pub const fn joints(&self) -> &Joints {
        &self.joints
    }

    /// Radians.
    #[must_use]
    pub fn command(&self) -> Joints {
        self.command.present()
    }

    /// True if, under pressure, the command has reached its goal and every joint is within 0.005 degree of it.
    #[must_use]
    pub fn settled(&self) -> bool {
        let near = |(joint, at): (&f64, &f64)| (joint - at).abs() < SETTLED;
        self.pressure && self.command.is_over() && self.joints.iter().zip(&self.command.goal).all(near)
    }

    /// Set joints that have [`settled`](Self::settled) exactly to their command.
    pub fn settle(&mut self) {
        if self.settled() {
            self.joints = self.command.goal;
            self.command = Ramp::at(self.joints);
        }
    }

    /// True if, without pressure, the arm has finished sagging. False before the first step without pressure.
    #[must_use]
    pub fn has_sagged(&self) -> bool {
        !self.pressure && self.sinking > 0.0 && self.rates.iter().all(|rate| rate.abs() < AT_REST)
    }

    /// True if the shoulder rests on the shot pin.
    #[must_use]
    pub fn on_shot_pin(&self) -> bool {
        !self.pressure && self.joints[SHOULDER] <= self.pin
    }

    #[must_use]
    pub fn tool(&self) -> Frame {
        T3.forward(&self.joints)
    }
}

/// The damping matrix of a damper of unit strength that acts along one direction with these levers.
fn square(lever: &Vector6<f64>) -> Matrix6<f64> {
    lever * lever.transpose()
}

fn weights(chain: &Chain, hydraulics: &Hydraulics) -> [Load; 3] {
    let weight = |link, centre, pounds| Load::weight(link, chain.along(link, centre), pounds);
    [
        weight(UPPER_ARM, UPPER_ARM_CENTRE, hydraulics.upper_arm_weight),
        weight(FOREARM, FOREARM_CENTRE, hydraulics.forearm_weight),
        weight(WRIST, WRIST_CENTRE, hydraulics.wrist_weight),
    ]
}

/// With the load at HOME, a joint sinks at the droop rate. The base has the damping of the shoulder; yaw and roll have
/// that of the pitch.
fn dampers(hydraulics: &Hydraulics) -> [f64; 6] {
    let chain = Chain::new(&HOME_JOINTS);
    let tool = Load::weight(END_PLATE, chain.along(END_PLATE, TOOL_CENTRE), hydraulics.tool_weight);
    let weights = weights(&chain, hydraulics);
    let torque: Vector6<f64> = weights.iter().chain([&tool]).map(|load| chain.torque(load)).sum();
    let damper = |joint: usize| torque[joint].abs() / hydraulics.droop_rate.to_radians();
    [SHOULDER, SHOULDER, ELBOW, PITCH, PITCH, PITCH].map(damper)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arm() -> Arm {
        Arm::new(&Actuators::default(), HOME_JOINTS)
    }

    fn sag(arm: &mut Arm, seconds: f64) {
        for _ in 0..(seconds / 0.04).round() as u32 {
            arm.advance(0.04, false, &[arm.tool_weight()]);
        }
    }

    #[test]
    fn arm_lags_by_the_time_constant_and_reaches_its_command() {
        let (mut arm, mut target) = (arm(), HOME_JOINTS);
        // A ramp of 5 degrees/s: the lag is speed times time constant.
        for _ in 0..50 {
            target[0] += 0.2_f64.to_radians();
            arm.reach(target, 0.04);
            arm.advance(0.04, false, &[]);
        }
        let behind = (target[0] - arm.joints()[0]).to_degrees();
        assert!((behind - 5.0 * 0.080).abs() < 0.01, "{behind}");
        assert!(!arm.settled());
        arm.advance(2.4, false, &[]);
        assert!(arm.settled());
        assert!((arm.tool().position - T3.forward(&target).position).norm() < 1e-9);
    }

    #[test]
    fn joint_speed_is_limited_by_its_servo() {
        let (mut arm, mut target) = (arm(), HOME_JOINTS);
        target[0] += 1.0;
        arm.reach(target, 0.0);
        arm.advance(0.04, false, &[]);
        assert!(arm.joints()[0] - HOME_JOINTS[0] <= 30.0_f64.to_radians() * 0.04 + 1e-12);
    }

    #[test]
    fn held_command_stops_and_later_reaches_its_goal() {
        let mut arm = arm();
        let mut goal = HOME_JOINTS;
        goal[0] += 0.1;
        arm.reach(goal, 1.0);
        arm.advance(0.5, false, &[]);
        let halfway = arm.command();
        assert!((halfway[0] - HOME_JOINTS[0] - 0.05).abs() < 1e-9);
        arm.advance(5.0, true, &[]);
        assert_eq!(arm.command(), halfway);
        arm.advance(2.0, false, &[]);
        assert_eq!(arm.command(), goal);
        assert!(arm.settled());
    }

    #[test]
    fn joint_torques_at_home_equal_the_weights() {
        let arm = arm();
        let chain = Chain::new(&HOME_JOINTS);
        let loads = weights(&chain, &arm.actuators.hydraulics);
        let torque: Vector6<f64> =
            loads.iter().chain([&arm.tool_weight()]).map(|load| chain.torque(load)).sum();
        // Newton metres, calculated by hand from the masses: 2.7 and 0.85 kN·m.
        let metric = |joint: usize| torque[joint] * 0.112_985;
        assert!((metric(SHOULDER) + 2720.0).abs() < 40.0, "{}", metric(SHOULDER));
        assert!((metric(ELBOW) + 860.0).abs() < 20.0, "{}", metric(ELBOW));
        assert!(torque[0].abs() < 1e-9 && torque[4].abs() < 1e-9 && torque[5].abs() < 1e-9);
    }

    #[test]
    fn joints_without_pressure_sag_under_their_weight() {
        let mut arm = arm();
        arm.set_pressure(false);
        assert!(!arm.has_sagged());
        sag(&mut arm, 1.0);
        let sunk: Vec<f64> =
            arm.joints().iter().zip(HOME_JOINTS).map(|(now, home)| (home - now).to_degrees()).collect();
        for joint in [SHOULDER, ELBOW, PITCH] {
            assert!((sunk[joint] - 3.0).abs() < 0.3, "{sunk:?}");
        }
        assert!([0, 4, 5].iter().all(|joint: &usize| sunk[*joint].abs() < 1e-9), "{sunk:?}");
        assert!(!arm.has_sagged() && !arm.settled());
    }

    #[test]
    fn shot_pin_stops_only_the_shoulder() {
        let mut arm = arm();
        arm.set_pressure(false);
        sag(&mut arm, 60.0);
        assert!(arm.has_sagged() && arm.on_shot_pin());
        assert!((arm.joints()[SHOULDER].to_degrees() - 37.0).abs() < 1e-9);
        let forearm = (arm.joints()[SHOULDER] + arm.joints()[ELBOW]).to_degrees();
        assert!((forearm + 90.0).abs() < 5.0, "{forearm}");
        let hand = forearm + arm.joints()[PITCH].to_degrees();
        assert!((hand + 90.0).abs() < 5.0, "{hand}");
    }

    #[test]
    fn joints_stop_at_their_limits() {
        let mut joints = HOME_JOINTS;
        joints[SHOULDER] = 3.0_f64.to_radians();
        let mut arm = Arm::new(&Actuators::default(), joints);
        arm.set_pressure(false);
        sag(&mut arm, 60.0);
        assert_eq!(arm.joints()[SHOULDER], 0.0);
    }

    #[test]
    fn pressure_lifts_the_hand_by_ten_inches() {
        // After seconds, and after a night: III.6 says about ten inches, IV.3.3 several.
        for (seconds, inches) in [(2.0, 12.7), (5.0, 12.2), (20.0, 10.8), (300.0, 7.4)] {
            let mut arm = arm();
            arm.set_pressure(false);
            sag(&mut arm, seconds);
            let before = arm.tool();
            arm.set_pressure(true);
            arm.advance(2.0, false, &[]);
            assert!(arm.settled());
            let jump = arm.tool().position - before.position;
            assert!(jump.z > 0.0 && (jump.norm() - inches).abs() < 0.1, "{seconds} s: {}", jump.norm());
        }
    }

    #[test]
    fn arm_on_an_obstacle_comes_to_rest() {
        let mut arm = arm();
        arm.set_pressure(false);
        // A floor 2 in below the tool point, 2000 lb/in.
        let floor = arm.tool().position.z - 2.0;
        let mut seconds = 0.0;
        while !arm.has_sagged() {
            let at = arm.tool().position;
            let force = Vector::new(0.0, 0.0, 2000.0 * (floor - at.z).max(0.0));
            let stiffness = if force.z > 0.0 { 2000.0 } else { 0.0 };
            let contact =
                Load { link: END_PLATE, at, force, moment: Vector::zeros(), stiffness, friction: 0.3 };
            let tool = arm.tool_weight();
            arm.advance(STEP_S, false, &[tool, contact]);
            seconds += STEP_S;
            assert!(seconds < 60.0, "{:?}", arm.rates);
        }
        let depth = floor - arm.tool().position.z;
        assert!(depth > 0.0 && depth < 0.5, "{depth}");
    }
}
