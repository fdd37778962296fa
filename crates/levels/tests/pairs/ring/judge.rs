//! What must hold of E-move and Quick Change in each tick.

use interfaces::emove::EmoveVerb;
use levels::emove::relative::Relative;

use super::{Pair, Ring};
use crate::{data::data, emove::is_done, robot, search::Wrong};

/// The robot is clear of the holster if it is as far above it, in the axes of the holster, in.
const CLEAR: f64 = -2.9;

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
        let id = self.emove_out.status.end_effector_id;
        let clear = before.at().0 < CLEAR;
        match self.command.command {
            EmoveVerb::QcAttach if !before.mated => Err("done, and the gripper is not on"),
            EmoveVerb::QcAttach if before.ring != Ring::Locked => Err("done, and the ring is not locked"),
            EmoveVerb::QcAttach if id != self.command.end_effector_id => {
                Err("done, and the id of the gripper is not read")
            }
            EmoveVerb::QcDetach if before.mated => Err("done, and the gripper is on"),
            EmoveVerb::QcDetach if before.ring != Ring::Unlocked => Err("done, and the ring is not open"),
            EmoveVerb::QcAttach | EmoveVerb::QcDetach if !clear => {
                Err("done, and the robot is not clear of the holster")
            }
            EmoveVerb::None => Err("an unknown command is done"),
            _ => Ok(()),
        }
    }

    /// The ring does not turn while the robot moves. With a gripper, as far as its pins are read, on a ring that is not
    /// locked the robot moves only to the seat, or from there out of a gripper that is left.
    fn judge_motion(&self, before: &Self) -> Result<(), Wrong> {
        let (order, old) = (&self.emove_out.prim, &before.emove_out.prim);
        if before.is_driven() && before.robot.goal.is_some() {
            return Err("the ring turns while the robot moves");
        }
        let read = before.quick_change_out.status.end_effector_id.is_some();
        if order.number == old.number || !robot::moves(order.command) || !before.mated || !read {
            return Ok(());
        }
        let is = |relative: Relative| {
            let record = relative.record(&self.command, &data());
            record.is_some_and(|record| order.movetable == record.movetable.to_option())
        };
        match before.ring {
            Ring::Locked => Ok(()),
            Ring::Unlocked if is(Relative::QcaSlow) || is(Relative::QcdSeat) || is(Relative::QcdUp) => Ok(()),
            Ring::Between if is(Relative::QcaSlow) => Ok(()),
            Ring::Unlocked | Ring::Between => Err("the robot is moved with a gripper that is not locked"),
        }
    }
}
