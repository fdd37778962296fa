use geometry::pose::WireFrame;
use interfaces::{Reason, emove::EmoveVerb, pose_range};
use levels::{emove::gripper::EmoveGripper, execution::Outcome};

use super::Pair;
use crate::image::{Image, rebase, rebase_echoes, renumber_poses};

const LIMIT: u64 = 250; // ticks: longer than any relevant time except that of an echo

impl Pair {
    /// Omits what no row tests: reasons, the nearest places, the time at rest above its limit, and the times of link
    /// restarts, of which too few can occur.
    pub(super) fn alike(&self) -> Vec<u8> {
        let mut image = Image::new(self.tick, LIMIT, &[]);
        let mut it = self.clone();
        (it.emove.execution.reason, it.prim.execution.reason) = (Reason::None, Reason::None);
        if it.emove.execution.outcome != Outcome::Executing {
            it.emove.execution.last_order = None;
            it.emove.ordered_at = Default::default();
            if it.command.command != EmoveVerb::Pause {
                (it.emove.step, it.emove.ordered, it.emove.uses_prim) = Default::default();
                it.emove.motion.forget_flight();
            }
        }
        it.emove.localization.forget_surroundings();
        it.emove.held.forget_places();
        it.prim.restarts = Default::default();
        if it.prim.execution.outcome != Outcome::Executing {
            it.prim.standstill = Default::default();
        }
        let ended = &mut it.prim.standstill;
        ended.finished = ended.finished.min(50);
        ended.settled = ended.settled.min(3);
        ended.still = ended.still.min(3);
        image.add(&it.command);
        image.add(&it.emove);
        image.add(&it.emove_out.prim);
        image.add(&it.emove_out.poses);
        image.add(&it.emove_out.quick_change);
        image.add(&it.emove_out.status.echo);
        image.add(&it.emove_out.status.report);
        image.add(&it.prim);
        image.add(&it.prim_out.poses);
        image.add(&it.prim_out.t3i);
        let status = &it.prim_out.status;
        image.add(&status.echo);
        image.add(&status.report);
        image.add(&status.restarting);
        image.add(&status.link_running);
        image.bytes.push(u8::from(it.prim_out.bias.is_some()));
        image.add(&it.quick_change);
        image.add(&it.t3i);
        image.bytes.extend([u8::from(it.silent), it.aside, u8::from(it.halved), it.left.0, it.left.1]);
        image.add(&WireFrame::from_frame(&it.robot));
        if let Some(tool) = &it.tool {
            tool.add_to(&mut image);
            image.add(&it.emove_out.tool_grip);
        }
        if let Some(change) = &it.change {
            change.add_to(&mut image);
            image.add(&it.emove_out.grip);
            image.add(&it.emove_out.dormant);
        }
        if it.is_guarded() {
            image.bytes.extend([u8::from(it.contact), u8::from(it.stops), it.unusual]);
            image.bytes.push(it.biased_at_safe.map_or(2, u8::from));
            image.add(&it.brakes);
        }
        image.bytes
    }

    pub(super) fn renumber(&mut self) {
        renumber_poses(&mut self.emove, &mut self.emove_out);
        let (emove, out) = (&mut self.emove, &mut self.emove_out);
        let (prim, below) = (&mut self.prim, &mut self.prim_out);
        for (at, record) in (1..).zip(&mut below.poses) {
            record.number = record.number.map(|_| pose_range::PRIM | at);
        }
        let [present, sensor, ..] = below.poses;
        (below.status.present_pose, below.status.sensor_pose) = (present.number, sensor.number);
        (out.status.reference_pose, prim.newest_pose) = (None, pose_range::PRIM | 9);
        let echo = &mut emove.execution.receiver.echo;
        rebase_echoes(&mut [&mut self.command.number, echo, &mut out.status.echo]);
        let echo = &mut prim.execution.receiver.echo;
        rebase(emove.motion.commander(), &mut [&mut out.prim.number, echo, &mut below.status.echo]);
        if let Some(tool) = &mut self.tool {
            rebase(
                emove.grippers.commander(EmoveGripper::Tool),
                &mut [&mut out.tool_grip.number, tool.echo()],
            );
        }
        let echo = match &mut self.change {
            Some(change) => {
                rebase(
                    emove.grippers.commander(EmoveGripper::Parts),
                    &mut [&mut out.grip.number, change.grip_echo()],
                );
                change.echo()
            }
            None => &mut self.quick_change,
        };
        rebase(emove.exchange.commander(), &mut [&mut out.quick_change.number, echo]);
        rebase(&mut prim.t3i, &mut [&mut below.t3i.number, &mut self.t3i.echo]);
    }
}
