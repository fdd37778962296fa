use interfaces::Reason;

use super::{Fingered, Pair};
use crate::image::{Image, forget, rebase, rebase_echoes, renumber_poses};

impl<G: Fingered> Pair<G> {
    /// Omits what no row tests: reasons, and commands of idle processes.
    pub(super) fn alike(&self) -> Vec<u8> {
        let mut image = Image::new(self.tick, G::LIMIT, G::COUNTERS);
        let mut it = self.clone();
        forget(&mut it.upper.state);
        it.lower.execution().reason = Reason::None;
        // Rows that give an order lead to later steps: none of them fires twice in a command.
        it.upper.state.execution.last_order = None;
        it.upper.state.ordered_at = Default::default();
        it.upper.state.held.forget_places();
        if it.is_settled() {
            G::forget_order(&mut it.upper.out);
        }
        it.scene.robot.forget_order(&mut it.upper.out, it.upper.state.motion.goal().is_none());
        it.lower.forget(it.tick);
        image.add(&it.command);
        image.add(&it.upper.state);
        image.add(&it.upper.out.prim);
        image.add(&it.upper.out.poses);
        image.add(&it.upper.out.quick_change);
        image.add(&it.upper.out.status.echo);
        image.add(&it.upper.out.status.report);
        it.lower.add_to(&it.upper.out, &mut image);
        image.add(&it.lower.sensors(it.scene.fingers));
        it.scene.robot.add_to(&mut image);
        image.add(&it.scene.quick_change);
        image.bytes.extend([it.scene.apart, it.early.unwrap_or(u8::MAX), it.mishaps]);
        image.bytes
    }

    pub(super) fn renumber(&mut self) {
        let (emove, out) = (&mut self.upper.state, &mut self.upper.out);
        renumber_poses(emove, out);
        let echo = &mut emove.execution.receiver.echo;
        rebase_echoes(&mut [&mut self.command.number, echo, &mut out.status.echo]);
        self.lower.renumber(G::commander(emove), G::number(out));
        rebase(emove.motion.commander(), &mut [&mut out.prim.number, &mut self.scene.robot.echo]);
        rebase(emove.exchange.commander(), &mut [&mut out.quick_change.number, &mut self.scene.quick_change]);
    }
}
