//! The warnings of the controller: the codes on its screen, and the joint problems that cause some of them (A 2.3).

use geometry::kinematics::{Arm, Joints, ReachError};
use rcs_core::Plain;

use crate::{Plate, limit::Exceeded};

/// Reasons why the joints cannot reach a position within the velocity limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize, serde::Serialize))]
pub enum JointProblem {
    /// The shoulder would go beyond its upper limit.
    ShoulderUp,
    /// The roll would leave its limits.
    Roll,
    /// Another joint would leave its limits, or the arm is too short.
    Joint,
    /// The gripper axis is along the pitch axis.
    WristSingularity,
}

/// Reasons why a robot refuses a position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The joints cannot reach it.
    Joints(JointProblem),
    /// It is too far from the previous position.
    TooFast(Exceeded),
}

impl From<JointProblem> for Refusal {
    fn from(problem: JointProblem) -> Self {
        Self::Joints(problem)
    }
}

/// Joint angles, radians, for an end-plate position within the limits of `arm`. Errors: [`JointProblem`].
pub fn joints_for(arm: &Arm, goal: &Plate, near: &Joints) -> Result<Joints, JointProblem> {
    let joints = arm.inverse(&goal.to_tool(arm), near).map_err(|error| match error {
        ReachError::WristSingularity => JointProblem::WristSingularity,
        ReachError::TooFar { .. } | ReachError::TooNear { .. } | ReachError::NotFinite => JointProblem::Joint,
    })?;
    for (joint, (angle, (low, high))) in joints.iter().zip(arm.limits).enumerate() {
        if (low..=high).contains(angle) {
            continue;
        }
        return Err(match joint {
            1 if *angle > high => JointProblem::ShoulderUp,
            5 => JointProblem::Roll,
            _ => JointProblem::Joint,
        });
    }
    Ok(joints)
}

/// Codes on the controller's screen (A 2.3, "T3 controller error messages").
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Warning {
    /// No warning.
    #[text = ""]
    None,
    /// The RS232 board is missing.
    #[text = "WD0"]
    BoardMissing,
    /// The host's DTR is off.
    #[text = "WD1"]
    CtsLow,
    /// The interrupt pushbutton.
    #[text = "WD2"]
    Interrupt,
    /// More than 14 in/s.
    #[text = "WD3"]
    Translation,
    /// More than 1.0 rad/s.
    #[text = "WD4"]
    Orientation,
    /// The transmitter has failed.
    #[text = "WD5"]
    Transmitter,
    /// Joint limit reached (joint 6).
    #[text = "WD6"]
    JointLimit,
    /// Joint 2 reached the upward DEPC limit.
    #[text = "P05"]
    ShoulderUp,
    /// Joint limit reached.
    #[text = "P0B"]
    OtherJoint,
    /// Wrist singularity problem.
    #[text = "P9P"]
    Wrist,
    /// DEPC link terminated (unrecoverable).
    #[text = "PIG"]
    Terminated,
    /// The robot has left its path and comes to rest (extension: no T3 shows it).
    #[text = "OFF-PATH"]
    OffPath,
}

impl Warning {
    /// True if a restart clears it: the appendix recommends this for D6, and other joint problems are similar.
    /// Warnings of operator, wiring or velocity need an ENTER (ASSUMED).
    #[must_use]
    pub const fn host_can_restart(self) -> bool {
        matches!(self, Self::JointLimit | Self::ShoulderUp | Self::OtherJoint | Self::Wrist | Self::OffPath)
    }
}

impl From<JointProblem> for Warning {
    fn from(problem: JointProblem) -> Self {
        match problem {
            JointProblem::ShoulderUp => Self::ShoulderUp,
            JointProblem::Roll => Self::JointLimit,
            JointProblem::Joint => Self::OtherJoint,
            JointProblem::WristSingularity => Self::Wrist,
        }
    }
}

impl From<Refusal> for Warning {
    fn from(refusal: Refusal) -> Self {
        match refusal {
            Refusal::Joints(problem) => problem.into(),
            Refusal::TooFast(exceeded) => exceeded.into(),
        }
    }
}

impl From<Exceeded> for Warning {
    fn from(exceeded: Exceeded) -> Self {
        match exceeded {
            Exceeded::Translation => Self::Translation,
            Exceeded::Orientation => Self::Orientation,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::kinematics::{HOME_JOINTS, T3};

    const HOME: Plate = Plate { words: [0, -6293, -636, -9000, 13500, 0] };

    #[test]
    fn joint_problems_are_distinguished() {
        let at = |degrees: [f64; 6]| {
            let frame = T3.forward_plate(&degrees.map(f64::to_radians));
            joints_for(&T3, &Plate::from_frame(&frame, &HOME).unwrap(), &HOME_JOINTS).map(drop)
        };
        assert_eq!(at([-90.0, 45.0, -90.0, 0.0, 0.0, 0.0]), Ok(()));
        assert_eq!(at([-90.0, 92.0, -90.0, 0.0, 0.0, 0.0]), Err(JointProblem::ShoulderUp));
        assert_eq!(at([-90.0, -5.0, -90.0, 0.0, 0.0, 0.0]), Err(JointProblem::Joint));
        assert_eq!(at([-90.0, 45.0, -90.0, 0.0, 0.0, 140.0]), Err(JointProblem::Roll));
        assert_eq!(at([-90.0, 45.0, -90.0, 0.0, 90.0, 0.0]), Err(JointProblem::WristSingularity));
        let far = Plate { words: [0, -15_000, 0, -9000, 9000, 0] };
        assert_eq!(joints_for(&T3, &far, &HOME_JOINTS), Err(JointProblem::Joint));
    }
}
