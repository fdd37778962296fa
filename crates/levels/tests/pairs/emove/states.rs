//! Which states of E-move and the process of a gripper are alike.

use interfaces::{Reason, emove::EmoveVerb};
use levels::execution::Outcome;

use super::{Fingered, Pair};
use crate::image::{Image, rebase, rebase_echoes};

impl<G: Fingered> Pair<G> {
    /// Without what no row asks for any more: reasons; what a process that executes nothing has of its command.
    pub(super) fn alike(&self) -> Vec<u8> {
        let mut image = Image::new(self.tick, G::LIMIT, G::COUNTERS);
        let mut it = self.clone();
        (it.emove.execution.reason, it.gripper.execution().reason) = (Reason::None, Reason::None);
        let executes = it.emove.execution.outcome == Outcome::Executing;
        if !executes && it.command.command != EmoveVerb::Pause {
            (it.emove.step, it.emove.ordered, it.emove.uses_prim) = Default::default();
        }
        // Rows that order something lead to later steps: none of them fires twice in a command.
        it.emove.execution.last_order = None;
        if !executes {
            it.emove.carrying = false;
        }
        let beliefs = &mut it.emove.beliefs;
        beliefs.placed = None;
        match &mut beliefs.grasping {
            grasping if beliefs.held.is_none() && beliefs.empty => *grasping = None,
            Some(grasping) => grasping.opening = 0,
            None => {}
        }
        if beliefs.held.is_none() {
            it.emove.unfelt = 0;
        }
        if it.is_settled() {
            G::forget_order(&mut it.emove_out);
        }
        it.gripper.forget(it.tick);
        image.add(&it.command);
        image.add(&it.emove);
        image.add(&it.emove_out.prim);
        image.add(&it.emove_out.quick_change);
        image.add(&it.emove_out.status.echo);
        image.add(&it.emove_out.status.report);
        it.gripper.add_to(&it.emove_out, &mut image);
        image.add(&it.gripper.sensors(it.fingers));
        it.robot.add_to(&mut image);
        image.add(&it.quick_change);
        let grasps = executes && it.command.command == EmoveVerb::GraspObj;
        let early = it.left.0.unwrap_or(u8::MAX);
        image.bytes.extend([if grasps { it.apart } else { 0 }, early, it.left.1]);
        image.bytes
    }

    /// What does not count any more begins again.
    pub(super) fn renumber(&mut self) {
        let (emove, out) = (&mut self.emove, &mut self.emove_out);
        let echo = &mut emove.execution.receiver.echo;
        rebase_echoes(&mut [&mut self.command.number, echo, &mut out.status.echo]);
        self.gripper.renumber(G::commander(emove), G::number(out));
        rebase(&mut emove.prim, &mut [&mut out.prim.number, &mut self.robot.echo]);
        rebase(&mut emove.quick_change, &mut [&mut out.quick_change.number, &mut self.quick_change]);
    }
}
