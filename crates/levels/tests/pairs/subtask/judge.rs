use geometry::pose::Pose;
use interfaces::{
    emove::EmoveVerb,
    grip::GripVerb,
    subtask::{SubtaskCommand, SubtaskVerb},
};
use levels::execution::Outcome;

use super::{Does, LATE, Pair};
use crate::{
    data::data,
    frame::Event,
    parts_gripper, robot,
    search::{DeliveryFault, Wrong},
};

impl Pair {
    fn is_goal(&self, command: &SubtaskCommand, at: &Pose) -> bool {
        let Some((_, pose)) = self.lines.iter().find(|(_, pose)| pose.number == command.pose) else {
            return false;
        };
        let base = pose.pose.to_frame().expect("commands have frames");
        let place = command.site.place();
        let grip =
            command.object.and_then(|object| data().grip_movetable(&object, command.source_grip, &place));
        let goal = grip.map_or(base, |grip| data().moved(&base, grip));
        robot::is_at(&Pose::from_frame(&goal), at)
    }

    pub(super) fn is_destination(&self, at: &Pose) -> bool {
        let mut places = self.lines.iter().filter(|(command, _)| command.command == SubtaskVerb::PlaceObj);
        places.any(|(command, _)| self.is_goal(command, at))
    }

    fn orders_motion(&self, before: &Self) -> bool {
        let (now, then) = (&self.lower.out, &before.lower.out);
        (now.prim.number != then.prim.number && robot::moves(now.prim.command))
            || (now.grip.number != then.grip.number && parts_gripper::moves(now.grip.command))
    }

    fn is_done(&self, number: u32) -> bool {
        let execution = &self.upper.state.execution;
        execution.outcome == Outcome::Done && execution.receiver.echo == number
    }

    /// `before` is the pair as the processes read it.
    pub(super) fn judge(&self, before: &Self, event: &Event<Does>) -> Result<(), Wrong> {
        self.judge_orders(before, event)?;
        let number = self.command.number;
        if !self.is_done(number) {
            return Ok(());
        }
        // An object that is already placed may be detected while a robot whose motion has failed comes to rest.
        let at_once = matches!(self.command.command, SubtaskVerb::PlaceObj | SubtaskVerb::GetEndeff);
        let out = &before.lower.out;
        let fingers = self.command.command == SubtaskVerb::Pause && before.scene.grip.is_moving(&out.grip);
        let robot = !at_once && before.scene.robot.is_moving(&out.prim);
        if self.orders_motion(before) || fingers || robot {
            return Err("done, and something moves");
        }
        if before.is_done(number) { Ok(()) } else { self.judge_end(before) }
    }

    /// A replaced command gives no order. The robot rests while the fingers close or release, and is at the object
    /// when they close.
    fn judge_orders(&self, before: &Self, event: &Event<Does>) -> Result<(), Wrong> {
        let (now, then) = (&self.lower.out, &before.lower.out);
        let fresh = event.told.is_some() || event.mishap != DeliveryFault::None;
        if self.orders_motion(before) && !before.scene.own && !fresh {
            return Err("an order of a command that was replaced");
        }
        let holds = matches!(then.grip.command, GripVerb::OpenGrip | GripVerb::CloseGrip);
        let sends = now.prim.number != then.prim.number && robot::moves(now.prim.command);
        if sends && holds && before.scene.grip.is_busy(&then.grip) {
            return Err("the robot is moved while the fingers close or release");
        }
        let (order, last) = (self.upper.out.emove.command, before.upper.out.emove.command);
        // The robot does not move to a held object.
        let arrived = before.scene.own && order == EmoveVerb::GraspObj && last == EmoveVerb::MovToObj;
        let empty = !then.status.held.is_held();
        if arrived && empty && !self.is_goal(&self.command, &before.scene.robot.at) {
            return Err("the fingers close, and the robot is not at the object");
        }
        Ok(())
    }

    fn judge_end(&self, before: &Self) -> Result<(), Wrong> {
        let (status, held) = (&before.lower.out.status, before.lower.out.status.held.object());
        let there = self.is_goal(&self.command, &before.scene.robot.at);
        match self.command.command {
            SubtaskVerb::GetObject if before.scene.apart > LATE => Err("done, and the fingers are empty"),
            SubtaskVerb::GetObject | SubtaskVerb::MoveObjToDest if held != self.command.object => {
                Err("done, and the object is not held")
            }
            SubtaskVerb::PlaceObj if !before.scene.let_go => Err("done, and the object is not placed"),
            SubtaskVerb::PlaceObj | SubtaskVerb::Release if before.scene.grip.full => {
                Err("done, and something is between the fingers")
            }
            SubtaskVerb::GotoDest | SubtaskVerb::MoveObjToDest if !there => {
                Err("done, and the robot is not there")
            }
            SubtaskVerb::GotoDest
                if status.at.is_none_or(|at| at.site.location != self.command.site.location) =>
            {
                Err("done, and E-move does not know that the robot is there")
            }
            SubtaskVerb::None => Err("an unknown command is done"),
            _ => Ok(()),
        }
    }
}
