//! What must hold of E-move and the process of a gripper in each tick.

use geometry::pose::Pose;
use interfaces::{
    StatusReport,
    emove::{EmoveVerb, Holding},
    prim::PrimReport,
};
use levels::emove::grippers::FingerVerb;

use super::{Around, Fingered, Pair, is_done};
use crate::{
    data::place,
    frame::{Event, Scene},
    robot::{self, is_at},
    search::{Mishap, World as _, Wrong},
};

impl<G: Fingered> Pair<G> {
    /// Something that counts as held has been let go, or half of it.
    const fn lets_go(&self) -> bool {
        self.upper.state.held.is_letting_go(true)
    }

    /// What is reported done is done.
    ///
    /// `before` is the pair as it was when the processes read it.
    pub(super) fn judge(
        &self,
        before: &Self,
        event: &Event<<Around<G> as Scene>::Does>,
    ) -> Result<(), Wrong> {
        let open = G::are_open(before.scene.fingers);
        if event.mishap == Mishap::RestartUpper && before.lets_go() && !self.lets_go() && !open {
            return Err("a restarted E-move does not know that it lets go");
        }
        let status = &self.upper.out.status;
        let robot_moves = before.scene.robot.report == PrimReport::Executing;
        let fingers_move = before.lower.reports_executing();
        let refused = self.upper.state.execution.receiver.adopted && status.report == StatusReport::Error;
        if refused && (fingers_move || robot_moves) {
            return Err("restarted is reported before what was ordered is at rest");
        }
        self.judge_motion(before)?;
        let number = self.command.number;
        if !is_done(&self.upper.out, number) || is_done(&before.upper.out, number) {
            return Ok(());
        }
        match self.command.command {
            EmoveVerb::GraspObj if before.scene.apart > G::LATE => {
                Err("done, and nothing is between the fingers")
            }
            EmoveVerb::GraspObj if status.held.object() != self.command.object => {
                Err("done, and the object is not held")
            }
            EmoveVerb::GraspObj if !before.lower.presses() => Err("done, and nothing presses the object"),
            EmoveVerb::Release if !open => Err("done, and the fingers are not open"),
            EmoveVerb::Release if status.held != Holding::Nothing => Err("done, and something is held"),
            EmoveVerb::Pause if fingers_move => Err("done, and the fingers move"),
            EmoveVerb::Pause if robot_moves => Err("done, and the robot moves"),
            verb if robot::goes(verb) => self.judge_arrival(before),
            EmoveVerb::None => Err("an unknown command is done"),
            _ => Ok(()),
        }
    }

    /// The robot does not leave the object before the fingers have let go, if they were told to, and MOV-TO-OBJ comes
    /// to it with open fingers. It stands still while they close or let go. What they hold is not brought to an
    /// opening.
    fn judge_motion(&self, before: &Self) -> Result<(), Wrong> {
        let (now, then) = (&self.upper.out, &before.upper.out);
        let sends = now.prim.number != then.prim.number && robot::moves(now.prim.command);
        let orders = *G::number(&mut { *now }) != *G::number(&mut { *then });
        let order = before.upper.state.grippers.order();
        let opens = G::are_open(before.scene.fingers);
        let grasps = matches!(order, FingerVerb::Grasp | FingerVerb::Release);
        if sends && grasps && before.lower.reports_executing() {
            return Err("the robot is moved while the fingers close or let go");
        }
        if orders && self.upper.state.grippers.order() == FingerVerb::Stand && G::hold(before.scene.fingers) {
            return Err("what is held is brought to an opening");
        }
        match (before.is_at_object(), self.is_at_object()) {
            (true, false) if before.lets_go() && G::touch(before.scene.fingers) => {
                Err("the robot leaves while the fingers have not let go")
            }
            (false, true) if self.command.command == EmoveVerb::MovToObj && !opens => {
                Err("the robot comes to the object with fingers that are not open")
            }
            _ => Ok(()),
        }
    }

    /// A motion is done: the robot is there, and E-move knows that.
    fn judge_arrival(&self, before: &Self) -> Result<(), Wrong> {
        let named = place(self.command.site.location.as_str());
        let at_object = matches!(self.command.command, EmoveVerb::MovToObj | EmoveVerb::MovObjTo);
        let goal = if at_object { self.scene.object_at } else { Pose::from_frame(&named.frame) };
        let status = &self.upper.out.status;
        // An object that is held is not gone to.
        if self.command.command == EmoveVerb::MovToObj && status.held.object() == self.command.object {
            return Ok(());
        }
        if !is_at(&goal, &before.scene.robot.at) {
            return Err("done, and the robot is not there");
        }
        if status.at.is_none_or(|at| at.site.location != self.command.site.location) {
            return Err("done, and E-move does not know that the robot is there");
        }
        match self.command.command {
            EmoveVerb::MovToObj if !G::are_open(before.scene.fingers) && before.scene.apart > G::LATE => {
                Err("done, and the fingers are not open")
            }
            EmoveVerb::MovObjTo if before.scene.apart > G::LATE && !before.lets_go() => {
                Err("done, and nothing is between the fingers")
            }
            _ => Ok(()),
        }
    }

    /// What E-move says of what is held is true, when nothing changes any more.
    ///
    /// `before` is the pair a tick before, in which nothing was commanded.
    pub(super) fn judge_held(&self, before: &Self) -> Result<(), Wrong> {
        let holds = G::hold(self.scene.fingers);
        let presses = holds && self.lower.presses();
        let wrong = match self.upper.out.status.held {
            Holding::Nothing if holds => "at rest, and what is held counts as nothing",
            Holding::Object(_) if !presses && !self.lets_go() => {
                "at rest, and something counts as held that is not, nor is being let go"
            }
            _ => return Ok(()),
        };
        if self.rests() && self.image() == before.image() { Err(wrong) } else { Ok(()) }
    }
}
