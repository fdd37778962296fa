//! Which states of E-move and Quick Change are alike.

use interfaces::{Reason, grip::GripCommand, prim::PrimCommand};
use levels::{emove::gripper::Gripper, execution::Outcome};

use super::{Fault, Pair, STEADY};
use crate::image::{Image, forget, rebase, rebase_echoes, renumber_poses};

/// Ticks in which the ring must arrive.
const LIMIT: u64 = 25;

impl Pair {
    /// Every command is echoed, and its commander has read the echo.
    pub(super) fn is_settled(&self) -> bool {
        let (prim, grip) = (self.emove_out.prim.number, self.emove_out.grip.number);
        let ring = self.emove_out.quick_change.number;
        (prim == 0 || prim == self.robot.echo)
            && (grip == 0 || grip == self.grip.echo)
            && (ring == 0 || ring == self.quick_change_out.status.echo)
            && self.quick_change.execution.receiver.echo == self.quick_change_out.status.echo
    }

    /// Only time can change anything.
    pub(super) fn is_steady(&self) -> bool {
        self.is_settled() && self.quick_change.reading_ticks >= STEADY
    }

    pub(super) fn alike(&self) -> Vec<u8> {
        let counters = &[("reading_ticks", STEADY), ("illegal_ticks", 3), ("unfelt", 6)];
        let mut image = Image::new(self.tick, LIMIT, counters);
        let mut it = self.clone();
        it.forget();
        image.add(&it.command);
        image.add(&it.emove);
        image.add(&it.emove_out.status.echo);
        image.add(&it.emove_out.status.report);
        image.add(&it.emove_out.dormant);
        image.add(&it.emove_out.prim);
        image.add(&it.emove_out.grip);
        image.add(&it.emove_out.v_grip.command);
        image.add(&it.emove_out.quick_change);
        image.add(&it.emove_out.poses);
        image.add(&it.quick_change);
        image.add(&it.quick_change_out.status);
        image.add(&it.quick_change_out.valves);
        it.robot.add_to(&mut image);
        it.grip.add_to(&mut image);
        let fault = match it.fault {
            Fault::None => 255,
            Fault::Both => 254,
            Fault::Pins(id) => id,
        };
        image.bytes.extend([it.ring.code(), fault, u8::from(it.mated), it.left.0, it.left.1]);
        image.bytes
    }

    /// What no row asks for any more: reasons; what a process that executes nothing has of its command; the text of an
    /// order that was taken; poses to which no order leads; the time of a ring that has arrived.
    fn forget(&mut self) {
        let executes = forget(&mut self.emove);
        let ring = &mut self.quick_change;
        (ring.execution.reason, self.quick_change_out.status.reason) = (Reason::None, Reason::None);
        if ring.execution.outcome != Outcome::Executing {
            ring.since = self.tick;
        }
        let PrimCommand { number, command, .. } = self.emove_out.prim;
        if self.robot.echo == number || number == 0 {
            self.emove_out.prim = PrimCommand { number, command, ..PrimCommand::default() };
            if !executes {
                self.emove_out.poses = Default::default();
            }
        }
        if !self.grips() {
            let GripCommand { number, command, .. } = self.emove_out.grip;
            self.emove_out.grip = GripCommand { number, command, ..GripCommand::default() };
        }
    }

    /// What does not count any more begins again.
    pub(super) fn renumber(&mut self) {
        renumber_poses(&mut self.emove, &mut self.emove_out);
        let (emove, out) = (&mut self.emove, &mut self.emove_out);
        let (ring, below) = (&mut self.quick_change, &mut self.quick_change_out.status);
        let echo = &mut emove.execution.receiver.echo;
        rebase_echoes(&mut [&mut self.command.number, echo, &mut out.status.echo]);
        rebase(emove.motion.commander(), &mut [&mut out.prim.number, &mut self.robot.echo]);
        rebase(emove.grippers.commander(Gripper::Parts), &mut [&mut out.grip.number, &mut self.grip.echo]);
        // V-Grip, whose id the pins may read, does not answer.
        rebase(emove.grippers.commander(Gripper::V), &mut [&mut out.v_grip.number]);
        let echo = &mut ring.execution.receiver.echo;
        rebase(emove.exchange.commander(), &mut [&mut out.quick_change.number, echo, &mut below.echo]);
    }
}
