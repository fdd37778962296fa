//! The hydraulic arm: servos under pressure, a slow fall without.
//!
//! Under pressure the joints follow a command that runs to its goal at an even rate, with a first-order lag and no faster
//! than their greatest speed. Without pressure the shoulder sinks under the arm's own weight until the shot pin stops it
//! (III.6); the servos keep their command, so that the arm jumps back to it when the pressure returns (IV.3.3 step 8).

use rcs_core::{
    frame::Frame,
    kinematics::{Joints, T3},
};

/// Longest step of the servo equation, seconds.
const STEP_S: f64 = 0.0025;
/// Lag of the joint servos, seconds (ASSUMED).
const LAG_S: f64 = 0.080;
/// Greatest joint speeds, degrees/s (ASSUMED).
const SPEEDS: [f64; 6] = [30.0, 30.0, 30.0, 90.0, 90.0, 90.0];
/// Speed of the shoulder that sinks, degrees/s (ASSUMED).
const DROOP: f64 = 3.0;
/// The shot pin stops the shoulder so far below its command, degrees: at HOME 10 in at the hand (III.6).
pub const SHOT_PIN: f64 = 8.0;

/// Index of the shoulder among the joints.
const SHOULDER: usize = 1;

/// Joints, servos and pressure. Angles in radians.
#[derive(Clone, Debug)]
pub struct Arm {
    joints: Joints,
    /// Where the servos' command is.
    command: Joints,
    goal: Joints,
    /// Seconds that the command still takes to its goal.
    remaining: f64,
    pressure: bool,
}

impl Arm {
    /// An arm that has sunk onto the shot pin, its servos commanded to `command`.
    #[must_use]
    pub fn sunk_below(command: Joints) -> Self {
        let mut arm = Self { joints: command, command, goal: command, remaining: 0.0, pressure: false };
        arm.joints[SHOULDER] = arm.pin();
        arm
    }

    fn pin(&self) -> f64 {
        let (lowest, _) = T3.limits[SHOULDER];
        (self.command[SHOULDER] - SHOT_PIN.to_radians()).max(lowest)
    }

    /// Turn the pressure on or off. Off ends the motion: the command stays where it has come to.
    pub fn set_pressure(&mut self, on: bool) {
        self.pressure = on;
        if !on {
            self.stop();
        }
    }

    /// Run the command evenly to `goal` within `seconds`.
    pub fn reach(&mut self, goal: Joints, seconds: f64) {
        self.goal = goal;
        self.remaining = seconds.max(0.0);
    }

    /// End the motion: the command stays where it has come to.
    pub fn stop(&mut self) {
        self.goal = self.command;
        self.remaining = 0.0;
    }

    /// Let `seconds` pass. While `held` the command stands still.
    pub fn advance(&mut self, seconds: f64, held: bool) {
        let mut left = seconds;
        while left > 0.0 {
            let dt = left.min(STEP_S);
            left -= dt;
            if self.pressure {
                if !held {
                    self.run_command(dt);
                }
                self.follow(dt);
            } else {
                let sunk = self.joints[SHOULDER] - DROOP.to_radians() * dt;
                self.joints[SHOULDER] = sunk.max(self.pin().min(self.joints[SHOULDER]));
            }
        }
    }

    fn run_command(&mut self, dt: f64) {
        if dt >= self.remaining {
            self.command = self.goal;
            self.remaining = 0.0;
            return;
        }
        let share = dt / self.remaining;
        for (command, goal) in self.command.iter_mut().zip(self.goal) {
            *command += (goal - *command) * share;
        }
        self.remaining -= dt;
    }

    fn follow(&mut self, dt: f64) {
        let share = 1.0 - libm::exp(-dt / LAG_S);
        for ((joint, command), speed) in self.joints.iter_mut().zip(self.command).zip(SPEEDS) {
            let greatest = speed.to_radians() * dt;
            *joint += ((command - *joint) * share).clamp(-greatest, greatest);
        }
    }

    /// Where the servos' command is.
    #[must_use]
    pub fn command(&self) -> &Joints {
        &self.command
    }

    /// The command has come to its goal and every joint is within 0.005 degree of it.
    #[must_use]
    pub fn settled(&self) -> bool {
        self.remaining == 0.0
            && self
                .joints
                .iter()
                .zip(self.command)
                .all(|(joint, at)| (joint - at).abs() < 0.005_f64.to_radians())
    }

    /// The true tool frame, inches.
    #[must_use]
    pub fn tool(&self) -> Frame {
        T3.forward(&self.joints)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rcs_core::kinematics::HOME_JOINTS;

    #[test]
    fn pressure_lifts_the_hand_by_the_ten_inches_of_the_manual() {
        let mut arm = Arm::sunk_below(HOME_JOINTS);
        let before = arm.tool();
        arm.set_pressure(true);
        arm.advance(2.0, false);
        assert!(arm.settled());
        let jump = arm.tool().position - before.position;
        assert!(jump.z > 0.0 && (jump.norm() - 10.0).abs() < 0.5, "{}", jump.norm());
    }

    #[test]
    fn without_pressure_it_sinks_slowly_and_stops_at_the_pin() {
        let mut arm = Arm::sunk_below(HOME_JOINTS);
        arm.set_pressure(true);
        arm.advance(2.0, false);
        arm.set_pressure(false);
        arm.advance(1.0, false);
        assert!((arm.joints[1].to_degrees() - 42.0).abs() < 0.1, "{}", arm.joints[1].to_degrees());
        arm.advance(60.0, false);
        assert!((arm.joints[1].to_degrees() - 37.0).abs() < 1e-9);
        assert!((arm.joints[2] - HOME_JOINTS[2]).abs() < 1e-3);
    }

    #[test]
    fn a_held_command_stands_and_goes_on_to_its_goal() {
        let mut arm = Arm::sunk_below(HOME_JOINTS);
        arm.set_pressure(true);
        arm.advance(2.0, false);
        let mut goal = HOME_JOINTS;
        goal[0] += 0.1;
        arm.reach(goal, 1.0);
        arm.advance(0.5, false);
        let halfway = *arm.command();
        assert!((halfway[0] - HOME_JOINTS[0] - 0.05).abs() < 1e-9);
        arm.advance(5.0, true);
        assert_eq!(arm.command(), &halfway);
        arm.advance(2.0, false);
        assert_eq!(arm.command(), &goal);
        assert!(arm.settled());
    }
}
