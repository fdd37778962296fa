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
    search::{DeliveryFault, World as _, Wrong},
};

impl<G: Fingered> Pair<G> {
    /// True if a held object is being released, or has been.
    const fn lets_go(&self) -> bool {
        self.upper.state.held.is_releasing(true)
    }

    /// `before` is the pair as the processes read it.
    pub(super) fn judge(
        &self,
        before: &Self,
        event: &Event<<Around<G> as Scene>::Does>,
    ) -> Result<(), Wrong> {
        let open = G::are_open(before.scene.fingers);
        if event.mishap == DeliveryFault::RestartUpper && before.lets_go() && !self.lets_go() && !open {
            return Err("a restarted E-move does not know that it releases");
        }
        let status = &self.upper.out.status;
        let robot_moves = before.scene.robot.report == PrimReport::Executing;
        let fingers_move = before.lower.reports_executing();
        let refused = self.upper.state.execution.receiver.adopted && status.report == StatusReport::Error;
        if refused && (fingers_move || robot_moves) {
            return Err("restarted is reported before the previous order is at rest");
        }
        self.judge_motion(before)?;
        let number = self.command.number;
        if !is_done(&self.upper.out, number) || is_done(&before.upper.out, number) {
            return Ok(());
        }
        match self.command.command {
            EmoveVerb::GraspObj if before.scene.apart > G::LATE => Err("done, and the fingers are empty"),
            EmoveVerb::GraspObj if status.held.object() != self.command.object => {
                Err("done, and the object is not held")
            }
            EmoveVerb::GraspObj if !before.lower.presses() => Err("done, and the object is not pressed"),
            EmoveVerb::Release if !open => Err("done, and the fingers are not open"),
            EmoveVerb::Release if status.held != Holding::Nothing => Err("done, and something is held"),
            EmoveVerb::Pause if fingers_move => Err("done, and the fingers move"),
            EmoveVerb::Pause if robot_moves => Err("done, and the robot moves"),
            verb if robot::goes(verb) => self.judge_arrival(before),
            EmoveVerb::None => Err("an unknown command is done"),
            _ => Ok(()),
        }
    }

    /// If the fingers are commanded to release, the robot does not leave the object before they have, and
    /// MOV-TO-OBJ arrives with open fingers. The robot rests while they close or release. A held object is not
    /// moved to an opening.
    fn judge_motion(&self, before: &Self) -> Result<(), Wrong> {
        let (now, then) = (&self.upper.out, &before.upper.out);
        let sends = now.prim.number != then.prim.number && robot::moves(now.prim.command);
        let orders = *G::number(&mut { *now }) != *G::number(&mut { *then });
        let order = before.upper.state.grippers.order();
        let opens = G::are_open(before.scene.fingers);
        let grasps = matches!(order, FingerVerb::Grasp | FingerVerb::Release);
        if sends && grasps && before.lower.reports_executing() {
            return Err("the robot is moved while the fingers close or release");
        }
        if orders && self.upper.state.grippers.order() == FingerVerb::Stand && G::hold(before.scene.fingers) {
            return Err("a held object is moved to an opening");
        }
        match (before.is_at_object(), self.is_at_object()) {
            (true, false) if before.lets_go() && G::touch(before.scene.fingers) => {
                Err("the robot leaves before the fingers have released")
            }
            (false, true) if self.command.command == EmoveVerb::MovToObj && !opens => {
                Err("the robot moves to the object with fingers that are not open")
            }
            _ => Ok(()),
        }
    }

    /// After a motion the robot is at its goal, and E-move knows it.
    fn judge_arrival(&self, before: &Self) -> Result<(), Wrong> {
        let named = place(self.command.site.location.as_str());
        let at_object = matches!(self.command.command, EmoveVerb::MovToObj | EmoveVerb::MovObjTo);
        let goal = if at_object { self.scene.object_at } else { Pose::from_frame(&named.frame) };
        let status = &self.upper.out.status;
        // The robot does not move to an object that it holds.
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
                Err("done, and the fingers are empty")
            }
            _ => Ok(()),
        }
    }

    /// E-move's report of the held object is true in every steady state. `before` is the pair in the previous tick,
    /// which had no command.
    pub(super) fn judge_held(&self, before: &Self) -> Result<(), Wrong> {
        let holds = G::hold(self.scene.fingers);
        let presses = holds && self.lower.presses();
        let wrong = match self.upper.out.status.held {
            Holding::Nothing if holds => "at rest, and a held object is not recorded",
            Holding::Object(_) if !presses && !self.lets_go() => {
                "at rest, and an object is recorded as held that is neither held nor being released"
            }
            _ => return Ok(()),
        };
        if self.rests() && self.image() == before.image() { Err(wrong) } else { Ok(()) }
    }
}
