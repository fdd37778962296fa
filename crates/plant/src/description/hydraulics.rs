//! Servos and hydraulics of the arm.

use serde::{Deserialize, Serialize};

use super::Robot;

/// Drives of the joints: the servos under pressure, the hydraulics for the arm without pressure.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Actuators {
    pub lag_s: f64,       // First-order lag of the joint servos, s
    pub speeds: [f64; 6], // greatest speed of each joint under pressure, degrees/s
    pub hydraulics: Hydraulics,
}

/// The hydraulics, and the weights that they carry. All values are ASSUMED, to agree with III.6 and IV.3.3.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct Hydraulics {
    /// Time from MANUAL ON until there is pressure, s: the short delay of IV.3.3 step 8.
    pub pump_delay_s: f64,
    /// Speed at which a joint without pressure sinks under its load at HOME, degrees/s.
    pub droop_rate: f64,
    pub shot_pin: f64, // angle by which the shoulder sinks until the shot pin stops it, degrees
    /// Greatest distance of a servo's command from its joint, degrees: the command follows a sagging joint.
    pub following_error: f64,
    pub upper_arm_weight: f64, // lb
    pub forearm_weight: f64,   // lb
    pub wrist_weight: f64,     // lb
    pub tool_weight: f64,      // weight of quick change and gripper for which the hydraulics are designed, lb
}

impl Default for Hydraulics {
    fn default() -> Self {
        Self {
            pump_delay_s: 0.5,
            droop_rate: 3.0,
            shot_pin: 8.0,
            following_error: 5.0,
            upper_arm_weight: 397.0,
            forearm_weight: 243.0,
            wrist_weight: 99.0,
            tool_weight: 44.0,
        }
    }
}

impl Default for Actuators {
    /// Values of the T3 (ASSUMED).
    fn default() -> Self {
        Self { lag_s: 0.080, speeds: [30.0, 30.0, 30.0, 90.0, 90.0, 90.0], hydraulics: Hydraulics::default() }
    }
}

impl From<&Robot> for Actuators {
    fn from(robot: &Robot) -> Self {
        Self { lag_s: robot.servo_lag_s, speeds: robot.joint_speeds, hydraulics: robot.hydraulics.clone() }
    }
}
