use interfaces::{Reason, grip::GripCommand, prim::PrimCommand};
use levels::{emove::gripper::EmoveGripper, execution::Outcome};

use super::{Fault, Pair, STEADY};
use crate::image::{Image, forget, rebase, rebase_echoes, renumber_poses};

/// Time limit of the ring, ticks.
const LIMIT: u64 = 25;

impl Pair {
    pub(super) fn is_settled(&self) -> bool {
        let (prim, grip) = (self.upper.out.prim.number, self.upper.out.grip.number);
        let ring = self.upper.out.quick_change.number;
        (prim == 0 || prim == self.scene.robot.echo)
            && (grip == 0 || grip == self.scene.grip.echo)
            && (ring == 0 || ring == self.lower.out.status.echo)
            && self.lower.state.execution.receiver.echo == self.lower.out.status.echo
    }

    pub(super) fn is_steady(&self) -> bool {
        self.is_settled() && self.lower.state.reading_ticks >= STEADY
    }

    pub(super) fn alike(&self) -> Vec<u8> {
        let counters = &[("reading_ticks", STEADY), ("illegal_ticks", 3), ("unfelt", 6)];
        let mut image = Image::new(self.tick, LIMIT, counters);
        let mut it = self.clone();
        it.forget();
        image.add(&it.command);
        image.add(&it.upper.state);
        image.add(&it.upper.out.status.echo);
        image.add(&it.upper.out.status.report);
        image.add(&it.upper.out.dormant);
        image.add(&it.upper.out.prim);
        image.add(&it.upper.out.grip);
        image.add(&it.upper.out.v_grip.command);
        image.add(&it.upper.out.quick_change);
        image.add(&it.upper.out.poses);
        image.add(&it.lower.state);
        image.add(&it.lower.out.status);
        image.add(&it.lower.out.valves);
        it.scene.robot.add_to(&mut image);
        it.scene.grip.add_to(&mut image);
        let fault = match it.scene.fault {
            Fault::None => 255,
            Fault::Both => 254,
            Fault::Pins(id) => id,
        };
        image.bytes.extend([
            it.scene.ring.code(),
            fault,
            u8::from(it.scene.mated),
            it.early.unwrap_or_default(),
            it.mishaps,
        ]);
        image.bytes
    }

    /// Clears what no row tests: reasons, commands of idle processes, the text of an order that was taken, poses
    /// without an order, and the time of a ring that has arrived.
    fn forget(&mut self) {
        let executes = forget(&mut self.upper.state);
        let ring = &mut self.lower.state;
        (ring.execution.reason, self.lower.out.status.reason) = (Reason::None, Reason::None);
        if ring.execution.outcome != Outcome::Executing {
            ring.since = self.tick;
        }
        let PrimCommand { number, command, .. } = self.upper.out.prim;
        if self.scene.robot.echo == number || number == 0 {
            self.upper.out.prim = PrimCommand { number, command, ..PrimCommand::default() };
            if !executes {
                self.upper.out.poses = Default::default();
            }
        }
        if !self.grips() {
            let GripCommand { number, command, .. } = self.upper.out.grip;
            self.upper.out.grip = GripCommand { number, command, ..GripCommand::default() };
        }
    }

    pub(super) fn renumber(&mut self) {
        renumber_poses(&mut self.upper.state, &mut self.upper.out);
        let (emove, out) = (&mut self.upper.state, &mut self.upper.out);
        let (ring, below) = (&mut self.lower.state, &mut self.lower.out.status);
        let echo = &mut emove.execution.receiver.echo;
        rebase_echoes(&mut [&mut self.command.number, echo, &mut out.status.echo]);
        rebase(emove.motion.commander(), &mut [&mut out.prim.number, &mut self.scene.robot.echo]);
        rebase(
            emove.grippers.commander(EmoveGripper::Parts),
            &mut [&mut out.grip.number, &mut self.scene.grip.echo],
        );
        // V-Grip, whose id the pins may read, does not answer.
        rebase(emove.grippers.commander(EmoveGripper::V), &mut [&mut out.v_grip.number]);
        let echo = &mut ring.execution.receiver.echo;
        rebase(emove.exchange.commander(), &mut [&mut out.quick_change.number, echo, &mut below.echo]);
    }
}
