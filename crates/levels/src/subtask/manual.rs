//! Manual orders to the Active Pedestal (docs/design/recovery.md "Part in the pedestal"): the state variables of
//! BY-HAND. They depend only on common memory and task data, so a program decides like Subtask in the next tick.

use interfaces::{
    CommonMemory, StatusReport,
    emove::{EmoveStatus, Holding},
    operator::HandOrder,
    pedestal::{PedestalCommand, PedestalReport, PedestalVerb},
    subtask::SubtaskVerb,
};
use rcs_core::{
    name::{Name10, Name16},
    table::Verdict,
    tick::Tick,
};
use taskdata::files::{PedPara, TaskData};

use super::{
    pedestal_hand::pedestal_hand,
    tables::{
        PedestalData, SubtaskPedestal,
        by_hand::{HeldByHand, ManualOrder, Manually, Refused, Regripping, RobotAtPedestal, by_hand},
    },
};
use crate::{emove::robot_place::present_frame, places::named};

/// Empty fingers are clear of the part at this distance, in (ASSUMED: more than the overlap of fingers and part).
const CLEAR_INCHES: f64 = 4.0;
/// Opening of RELEASE for an unknown object without a PED-PARA record, 0.01 in.
const WIDE: i32 = 450;

/// The order is sent in `tick`; `memory` is common memory before it.
#[must_use]
pub fn manual(order: &HandOrder, tick: Tick, memory: &CommonMemory, data: &TaskData<'_>) -> ManualOrder {
    let (below, above) = (&memory.pedestal, &memory.task.subtask);
    let status = &memory.subtask.status;
    let is_new = above.number != status.echo;
    let executes = status.report == StatusReport::Executing;
    ManualOrder {
        order: order.command,
        regripping: if is_new || (executes && above.command == SubtaskVerb::FixGrip) {
            Regripping::Yes
        } else {
            Regripping::No
        },
        pedestal: if below.header.stamp != tick.previous() {
            SubtaskPedestal::Silent
        } else if below.status.report == PedestalReport::Executing
            || below.status.echo != memory.subtask.pedestal.number
        {
            SubtaskPedestal::Moving
        } else {
            SubtaskPedestal::Done
        },
        data: match para(order.object.as_ref(), data) {
            Some(_) => PedestalData::Found,
            None => PedestalData::Missing,
        },
        part: pedestal_hand(&below.status),
        robot: robot_there(memory, data),
        by_hand: if order.by_hand { HeldByHand::Yes } else { HeldByHand::No },
    }
}

/// Decide like Subtask in `tick`. The error is the reason for the refusal.
pub fn judge(
    order: &HandOrder,
    tick: Tick,
    memory: &CommonMemory,
    data: &TaskData<'_>,
) -> Result<(), Refused> {
    match by_hand((), &manual(order, tick, memory, data)) {
        Verdict::Decided(decision) => match decision.action {
            Manually::Send => Ok(()),
            Manually::Refuse(why) => Err(why),
        },
        Verdict::Passed(()) => Ok(()),
    }
}

/// The command has no cycle and number yet. `regrip` is the object in the hand, if it is known.
pub(super) fn command(order: &HandOrder, regrip: Option<&Name16>, data: &TaskData<'_>) -> PedestalCommand {
    let known = para(order.object.as_ref().or(regrip), data).copied();
    let widest = data.ped_paras.iter().map(|para| para.release_size).max();
    let para = known.unwrap_or_default();
    let (grasp_size, grasp_force, table_angle) = match order.command {
        PedestalVerb::PreGrip => (para.appr, 0, para.table_pos),
        PedestalVerb::Grip => (para.grasp_size, para.force, 0),
        PedestalVerb::Release => (known.map(|para| para.release_size).or(widest).unwrap_or(WIDE), 0, 0),
        PedestalVerb::Flip => (0, 0, order.table_angle),
        PedestalVerb::None | PedestalVerb::Pause => (0, 0, 0),
    };
    PedestalCommand {
        command: order.command,
        grasp_size,
        grasp_force,
        table_angle,
        ..PedestalCommand::default()
    }
}
fn para<'d>(object: Option<&Name16>, data: &TaskData<'d>) -> Option<&'d PedPara> {
    object.and_then(|object| data.ped_para(object)).map(|(_, para)| para)
}
pub(super) fn robot_there(memory: &CommonMemory, data: &TaskData<'_>) -> RobotAtPedestal {
    let emove = &memory.emove.status;
    if is_clear(emove, memory, data) {
        return RobotAtPedestal::Clear;
    }
    let regrip = memory.subtask.regrip.map(|regrip| regrip.object);
    let at_object =
        emove.at.is_some_and(|at| at.site.location.as_str() == named::PEDESTAL && at.grip.is_some());
    match emove.held {
        Holding::Object(held) if at_object && regrip.is_none_or(|part| part == held.object) => {
            RobotAtPedestal::Grips
        }
        Holding::Object(_) | Holding::Nothing | Holding::Something | Holding::NotKnown => {
            RobotAtPedestal::Near
        }
    }
}

/// A robot at another place is clear. One at no known place is clear if it is idle and its tool far from PEDESTAL.
fn is_clear(emove: &EmoveStatus, memory: &CommonMemory, data: &TaskData<'_>) -> bool {
    let pedestal = data.locpt_named(&Name10::clipped(named::PEDESTAL));
    match emove.at {
        Some(at) => Some(at.site.record) != pedestal,
        None if emove.report == StatusReport::Executing => false,
        None => pedestal
            .and_then(|id| data.locpt(id))
            .zip(present_frame(memory))
            .is_some_and(|(point, present)| point.frame.distance(&present).inches > CLEAR_INCHES),
    }
}
