//! A robot for tests at the controller's end of the line: it reaches every commanded position at once.

use depc::{
    Plate,
    controller::{Refusal, Robot, joints_for},
};
use geometry::kinematics::{Joints, T3};

pub struct Exact {
    pub joints: Joints,
    pub at: Plate,
}

impl Robot for Exact {
    fn present(&mut self) -> Plate {
        self.at
    }

    fn accept(&mut self, goal: &Plate) -> Result<(), Refusal> {
        self.joints = joints_for(&T3, goal, &self.joints)?;
        self.at = *goal;
        Ok(())
    }
}
