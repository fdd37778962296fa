//! What must hold of E-move and the process of a gripper in each tick.

use interfaces::{
    StatusReport,
    emove::{EmoveVerb, Holding},
    prim::PrimReport,
};

use super::{Event, Fingered, Pair, Restarted, is_done};
use crate::search::{World as _, Wrong};

impl<G: Fingered> Pair<G> {
    /// What is reported done is done.
    ///
    /// `before` is the pair as it was when the processes read it.
    pub(super) fn judge(&self, before: &Self, event: &Event<G::Fingers>) -> Result<(), Wrong> {
        let lets_go = |it: &Self| it.emove.releasing && it.emove.beliefs.held.is_some();
        let open = G::are_open(before.fingers);
        if event.restarted == Restarted::Emove && lets_go(before) && !lets_go(self) && !open {
            return Err("a restarted E-move does not know that it lets go");
        }
        let status = &self.emove_out.status;
        let robot_moves = before.robot.report == PrimReport::Executing;
        let fingers_move = before.gripper.reports_executing();
        let refused = self.emove.execution.receiver.adopted && status.report == StatusReport::Error;
        if refused && (fingers_move || robot_moves) {
            return Err("restarted is reported before what was ordered is at rest");
        }
        let number = self.command.number;
        if !is_done(&self.emove_out, number) || is_done(&before.emove_out, number) {
            return Ok(());
        }
        match self.command.command {
            EmoveVerb::GraspObj if before.apart > G::LATE => Err("done, and nothing is between the fingers"),
            EmoveVerb::GraspObj if status.held.object() != self.command.object => {
                Err("done, and the object is not held")
            }
            EmoveVerb::GraspObj if !before.gripper.presses() => Err("done, and nothing presses the object"),
            EmoveVerb::Release if !open => Err("done, and the fingers are not open"),
            EmoveVerb::Release if status.held != Holding::Nothing => Err("done, and something is held"),
            EmoveVerb::Pause if fingers_move => Err("done, and the fingers move"),
            EmoveVerb::Pause if robot_moves => Err("done, and the robot moves"),
            EmoveVerb::None => Err("an unknown command is done"),
            _ => Ok(()),
        }
    }

    /// What E-move says of what is held is true, when nothing changes any more.
    ///
    /// `before` is the pair a tick before, in which nothing was commanded.
    pub(super) fn judge_held(&self, before: &Self) -> Result<(), Wrong> {
        let holds = G::hold(self.fingers);
        let presses = holds && self.gripper.presses();
        let wrong = match self.emove_out.status.held {
            Holding::Nothing if holds => "at rest, and what is held counts as nothing",
            Holding::Object(_) if !presses && !self.emove.releasing => {
                "at rest, and something counts as held that is not, nor is being let go"
            }
            _ => return Ok(()),
        };
        if self.rests() && self.image() == before.image() { Err(wrong) } else { Ok(()) }
    }
}
