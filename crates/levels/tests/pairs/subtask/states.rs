//! Which states of Subtask and E-move are alike.

use interfaces::{
    Reason,
    device::{VisionRequest, VisionResponse},
    emove::EmoveCommand,
    grip::GripCommand,
    subtask::SubtaskCommand,
};
use levels::{emove::gripper::Gripper, execution::Outcome};
use rcs_core::tick::Tick;

use super::{Pair, is_over};
use crate::image::{forget, rebase, rebase_echoes, renumber_poses};

impl Pair {
    /// What no row asks for any more: reasons; what a process that executes nothing has of its command; the text of an
    /// order that was taken; poses to which no order leads.
    pub(super) fn forget(&mut self) {
        let (subtask, emove) = (&mut self.subtask, &mut self.emove);
        subtask.execution.reason = Reason::None;
        (self.emove_out.status.reason, self.emove_out.status.reference_pose) = (Reason::None, None);
        subtask.last_pose = 0;
        let subtask_over = is_over(&subtask.execution, self.command.number);
        let emove_over = is_over(&emove.execution, self.subtask_out.emove.number);
        if subtask.execution.outcome != Outcome::Executing || subtask.execution.waiting {
            (subtask.step, subtask.ordered, subtask.aims) = Default::default();
            subtask.execution.last_order = None;
        }
        if subtask_over {
            let SubtaskCommand { number, command, .. } = self.command;
            self.command = SubtaskCommand { number, command, ..SubtaskCommand::default() };
        }
        let vision = self.emove_out.vision.number;
        if emove_over {
            let EmoveCommand { number, command, .. } = self.subtask_out.emove;
            self.subtask_out.emove = EmoveCommand { number, command, ..EmoveCommand::default() };
        }
        if !forget(emove) {
            emove.vision.commander().sent = Tick::BEFORE_START;
            self.emove_out.vision = VisionRequest { number: vision, ..VisionRequest::default() };
            self.vision = VisionResponse { echo: vision, ..VisionResponse::default() };
        }
        self.robot.forget_order(&mut self.emove_out, emove_over);
        if !self.grip.is_busy(&self.emove_out.grip) {
            let GripCommand { number, command, .. } = self.emove_out.grip;
            self.emove_out.grip = GripCommand { number, command, ..GripCommand::default() };
        }
    }

    /// What does not count any more begins again.
    pub(super) fn renumber(&mut self) {
        renumber_poses(&mut self.emove, &mut self.emove_out);
        let (subtask, out, emove, below) =
            (&mut self.subtask, &mut self.subtask_out, &mut self.emove, &mut self.emove_out);
        let echo = &mut subtask.execution.receiver.echo;
        rebase_echoes(&mut [&mut self.command.number, echo, &mut out.status.echo]);
        let echo = &mut emove.execution.receiver.echo;
        rebase(&mut subtask.emove, &mut [&mut out.emove.number, echo, &mut below.status.echo]);
        rebase(emove.motion.commander(), &mut [&mut below.prim.number, &mut self.robot.echo]);
        rebase(emove.grippers.commander(Gripper::Parts), &mut [&mut below.grip.number, &mut self.grip.echo]);
        rebase(emove.exchange.commander(), &mut [&mut below.quick_change.number, &mut self.quick_change]);
        // Vision answers the last request: by how many it is behind does not matter.
        let vision = emove.vision.commander();
        if vision.number != 0 {
            self.vision.echo = if self.vision.echo == vision.number { 2 } else { 1 };
            (vision.number, below.vision.number) = (2, 2);
        }
    }
}
