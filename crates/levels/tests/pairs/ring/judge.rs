use super::Pair;
use crate::{emove::is_done, holster, search::Wrong};

impl Pair {
    /// `before` is the pair as the processes read it.
    pub(super) fn judge(&self, before: &Self) -> Result<(), Wrong> {
        self.judge_motion(before)?;
        let number = self.command.number;
        if !is_done(&self.upper.out, number) {
            return Ok(());
        }
        if before.scene.robot.is_moving(&before.upper.out.prim) || before.is_driven() || self.is_driven() {
            return Err("done, and the robot moves, or the ring turns");
        }
        if is_done(&before.upper.out, number) {
            return Ok(());
        }
        holster::judge_done(
            &self.command,
            &self.upper.out,
            &before.stands(),
            (before.scene.mated, before.scene.ring),
        )
    }

    /// The ring does not turn while the robot moves, nor does the robot move with a gripper on an open ring, as far
    /// as its pins are read.
    fn judge_motion(&self, before: &Self) -> Result<(), Wrong> {
        let (order, old) = (&self.upper.out.prim, &before.upper.out.prim);
        if before.is_driven() && before.scene.robot.goal.is_some() {
            return Err("the ring turns while the robot moves");
        }
        let read = before.lower.out.status.end_effector_id.is_some();
        if order.number == old.number || !before.scene.mated || !read {
            return Ok(());
        }
        holster::judge_order(&self.command, order, before.scene.ring)
    }
}
