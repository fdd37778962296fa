//! A robot for tests at the controller's end of the line: it is where it is told to be, at once.

use depc::{
    Plate,
    controller::{JointProblem, Robot, joints_for},
};
use rcs_core::kinematics::{Joints, T3};

pub struct Exact {
    pub joints: Joints,
    pub at: Plate,
}

impl Robot for Exact {
    fn present(&self) -> Plate {
        self.at
    }

    fn move_to(&mut self, goal: &Plate) -> Result<(), JointProblem> {
        self.joints = joints_for(&T3, goal, &self.joints)?;
        self.at = *goal;
        Ok(())
    }
}
