use interfaces::{
    Reason,
    device::{VisionRequest, VisionResponse},
    emove::EmoveCommand,
    grip::GripCommand,
    subtask::SubtaskCommand,
};
use levels::{emove::gripper::EmoveGripper, execution::Outcome};
use rcs_core::tick::Tick;

use super::{Pair, is_over};
use crate::image::{forget, rebase, rebase_echoes, renumber_poses};

impl Pair {
    /// Clears what no row tests: reasons, commands of idle processes, the text of a taken order, and poses without an
    /// order.
    pub(super) fn forget(&mut self) {
        let (subtask, emove) = (&mut self.upper.state, &mut self.lower.state);
        subtask.execution.reason = Reason::None;
        (self.lower.out.status.reason, self.lower.out.status.reference_pose) = (Reason::None, None);
        subtask.last_pose = 0;
        let subtask_over = is_over(&subtask.execution, self.command.number);
        let emove_over = is_over(&emove.execution, self.upper.out.emove.number);
        if subtask.execution.outcome != Outcome::Executing || subtask.execution.waiting {
            (subtask.step, subtask.ordered, subtask.aims) = Default::default();
            subtask.execution.last_order = None;
        }
        if subtask_over {
            let SubtaskCommand { number, command, .. } = self.command;
            self.command = SubtaskCommand { number, command, ..SubtaskCommand::default() };
        }
        let vision = self.lower.out.vision.number;
        if emove_over {
            let EmoveCommand { number, command, .. } = self.upper.out.emove;
            self.upper.out.emove = EmoveCommand { number, command, ..EmoveCommand::default() };
        }
        if !forget(emove) {
            emove.vision.commander().sent = Tick::BEFORE_START;
            self.lower.out.vision = VisionRequest { number: vision, ..VisionRequest::default() };
            self.scene.vision = VisionResponse { echo: vision, ..VisionResponse::default() };
        }
        self.scene.robot.forget_order(&mut self.lower.out, emove_over);
        if !self.scene.grip.is_busy(&self.lower.out.grip) {
            let GripCommand { number, command, .. } = self.lower.out.grip;
            self.lower.out.grip = GripCommand { number, command, ..GripCommand::default() };
        }
    }

    pub(super) fn renumber(&mut self) {
        renumber_poses(&mut self.lower.state, &mut self.lower.out);
        let (subtask, out, emove, below) =
            (&mut self.upper.state, &mut self.upper.out, &mut self.lower.state, &mut self.lower.out);
        let echo = &mut subtask.execution.receiver.echo;
        rebase_echoes(&mut [&mut self.command.number, echo, &mut out.status.echo]);
        let echo = &mut emove.execution.receiver.echo;
        rebase(&mut subtask.emove, &mut [&mut out.emove.number, echo, &mut below.status.echo]);
        rebase(emove.motion.commander(), &mut [&mut below.prim.number, &mut self.scene.robot.echo]);
        rebase(
            emove.grippers.commander(EmoveGripper::Parts),
            &mut [&mut below.grip.number, &mut self.scene.grip.echo],
        );
        rebase(
            emove.exchange.commander(),
            &mut [&mut below.quick_change.number, &mut self.scene.quick_change],
        );
        // Vision answers the last request, so the number of missed ones does not matter.
        let vision = emove.vision.commander();
        if vision.number != 0 {
            self.scene.vision.echo = if self.scene.vision.echo == vision.number { 2 } else { 1 };
            (vision.number, below.vision.number) = (2, 2);
        }
    }
}
