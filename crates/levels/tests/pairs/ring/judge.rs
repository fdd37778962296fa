//! What must hold of E-move and Quick Change in each tick.

use super::Pair;
use crate::{emove::is_done, holster, search::Wrong};

impl Pair {
    /// `before` is the pair as it was when the processes read it.
    pub(super) fn judge(&self, before: &Self) -> Result<(), Wrong> {
        self.judge_motion(before)?;
        let number = self.command.number;
        if !is_done(&self.emove_out, number) {
            return Ok(());
        }
        if before.robot.is_moving(&before.emove_out.prim) || before.is_driven() || self.is_driven() {
            return Err("done, and the robot moves, or the ring turns");
        }
        if is_done(&before.emove_out, number) {
            return Ok(());
        }
        holster::judge_done(&self.command, &self.emove_out, &before.stands(), (before.mated, before.ring))
    }

    /// The ring does not turn while the robot moves, nor the robot with a gripper on an open ring, as far as its pins
    /// are read.
    fn judge_motion(&self, before: &Self) -> Result<(), Wrong> {
        let (order, old) = (&self.emove_out.prim, &before.emove_out.prim);
        if before.is_driven() && before.robot.goal.is_some() {
            return Err("the ring turns while the robot moves");
        }
        let read = before.quick_change_out.status.end_effector_id.is_some();
        if order.number == old.number || !before.mated || !read {
            return Ok(());
        }
        holster::judge_order(&self.command, order, before.ring)
    }
}
