//! The powered arm: joint servos that follow a command.
//!
//! A tick brings a command for its end; the servos see it as a ramp over the tick and follow with a first-order lag, no
//! faster than their greatest speed. The lag is integrated exactly, so that an arm that is left alone comes to rest at its
//! command to the last bit that a resolver can tell. What the load does to the arm is not here but in the spring between
//! hand and fingers ([`crate::gripper`]).

use rcs_core::{
    frame::Frame,
    kinematics::{Joints, T3},
};
use serde::{Deserialize, Serialize};

use crate::description::Robot;

/// Joint angles and servos of the arm.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct Arm {
    joints: Joints,
    from: Joints,
    to: Joints,
    lag: f64,
    speeds: [f64; 6],
}

impl Arm {
    /// The arm at rest at the start of the description.
    #[must_use]
    pub fn new(robot: &Robot) -> Self {
        let start = robot.start_joints();
        Self {
            joints: start,
            from: start,
            to: start,
            lag: robot.servo_lag_s,
            speeds: robot.joint_speeds.map(f64::to_radians),
        }
    }

    /// Begin a tick whose command ends at `target`, radians; without one the last command stands.
    pub fn begin_tick(&mut self, target: Option<Joints>) {
        self.from = self.to;
        if let Some(target) = target {
            self.to = target;
        }
    }

    /// Follow the command for `dt` seconds up to the given fraction of the tick.
    pub fn advance(&mut self, fraction: f64, dt: f64) {
        let share = 1.0 - libm::exp(-dt / self.lag);
        for (joint, angle) in self.joints.iter_mut().enumerate() {
            let command = self.from[joint] + (self.to[joint] - self.from[joint]) * fraction;
            let greatest = self.speeds[joint] * dt;
            *angle += ((command - *angle) * share).clamp(-greatest, greatest);
        }
    }

    /// True joint angles, radians.
    #[must_use]
    pub fn joints(&self) -> &Joints {
        &self.joints
    }

    /// Joint angles of the command at the end of the tick, radians.
    #[must_use]
    pub fn command(&self) -> &Joints {
        &self.to
    }

    /// The true tool frame without load, inches.
    #[must_use]
    pub fn tool(&self) -> Frame {
        T3.forward(&self.joints)
    }

    /// The true end-plate frame without load, inches.
    #[must_use]
    pub fn plate(&self) -> Frame {
        T3.forward_plate(&self.joints)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::CellDescription;

    fn arm() -> Arm {
        let cell = CellDescription::from_toml(include_str!("../../../data/cell.toml")).unwrap();
        Arm::new(&cell.robot)
    }

    fn run(arm: &mut Arm, ticks: u32, target: Option<Joints>) {
        for _ in 0..ticks {
            arm.begin_tick(target);
            for step in 1..=16 {
                arm.advance(f64::from(step) / 16.0, 0.0025);
            }
        }
    }

    #[test]
    fn it_lags_by_the_time_constant_and_comes_to_rest_at_the_command() {
        let mut arm = arm();
        let mut target = *arm.joints();
        // A ramp of 5 degrees/s: the lag is speed times time constant.
        for _ in 0..50 {
            target[0] += 0.2_f64.to_radians();
            run(&mut arm, 1, Some(target));
        }
        let behind = (target[0] - arm.joints()[0]).to_degrees();
        assert!((behind - 5.0 * 0.080).abs() < 0.01, "{behind}");
        run(&mut arm, 60, None);
        assert!((arm.tool().position - T3.forward(&target).position).norm() < 1e-9);
    }

    #[test]
    fn no_joint_is_faster_than_its_servo() {
        let mut arm = arm();
        let mut target = *arm.joints();
        target[0] += 1.0;
        let before = arm.joints()[0];
        run(&mut arm, 1, Some(target));
        assert!(arm.joints()[0] - before <= 30.0_f64.to_radians() * 0.04 + 1e-12);
    }
}
