//! Which states of E-move and the process of a gripper are alike.

use interfaces::Reason;

use super::{Fingered, Pair};
use crate::image::{Image, forget, rebase, rebase_echoes, renumber_poses};

impl<G: Fingered> Pair<G> {
    /// Without what no row asks for any more: reasons; what a process that executes nothing has of its command.
    pub(super) fn alike(&self) -> Vec<u8> {
        let mut image = Image::new(self.tick, G::LIMIT, G::COUNTERS);
        let mut it = self.clone();
        forget(&mut it.emove);
        it.gripper.execution().reason = Reason::None;
        // Rows that order something lead to later steps: none of them fires twice in a command.
        it.emove.execution.last_order = None;
        it.emove.ordered_at = Default::default();
        it.emove.held.forget_places();
        if it.is_settled() {
            G::forget_order(&mut it.emove_out);
        }
        it.robot.forget_order(&mut it.emove_out, it.emove.motion.goal().is_none());
        it.gripper.forget(it.tick);
        image.add(&it.command);
        image.add(&it.emove);
        image.add(&it.emove_out.prim);
        image.add(&it.emove_out.poses);
        image.add(&it.emove_out.quick_change);
        image.add(&it.emove_out.status.echo);
        image.add(&it.emove_out.status.report);
        it.gripper.add_to(&it.emove_out, &mut image);
        image.add(&it.gripper.sensors(it.fingers));
        it.robot.add_to(&mut image);
        image.add(&it.quick_change);
        image.bytes.extend([it.apart, it.left.0.unwrap_or(u8::MAX), it.left.1]);
        image.bytes
    }

    /// What does not count any more begins again.
    pub(super) fn renumber(&mut self) {
        let (emove, out) = (&mut self.emove, &mut self.emove_out);
        renumber_poses(emove, out);
        let echo = &mut emove.execution.receiver.echo;
        rebase_echoes(&mut [&mut self.command.number, echo, &mut out.status.echo]);
        self.gripper.renumber(G::commander(emove), G::number(out));
        rebase(emove.motion.commander(), &mut [&mut out.prim.number, &mut self.robot.echo]);
        rebase(emove.exchange.commander(), &mut [&mut out.quick_change.number, &mut self.quick_change]);
    }
}
