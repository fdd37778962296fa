//! Removes, from a copy of their state, the past on which the control processes no longer act.
//!
//! Two states that differ only in these values continue alike: numbers of commands and pose records, which are only
//! compared with each other (renumbered from the newest); rows in headers and counters of the line; expired times;
//! readings of a completed calibration.

use std::collections::BTreeSet;

use depc::link::LinkCounters;
use interfaces::{CommonMemory, ProcessId, pose_range};
use levels::{
    emove::gripper::EmoveGripper,
    execution::{Execution, Outcome},
    grip::calibration::{Readings, Steady},
    ladder::LadderState,
    pedestal::table::tables::TablePhase,
    prim::state::RESTART_TICKS,
    rows::Rows,
};
use rcs_core::{Plain as _, handshake::Commander, header::Header, tick::Tick};

pub fn forget(memory: &mut CommonMemory, ladder: &mut LadderState, now: Tick) {
    count_poses(memory, ladder);
    count_commands(memory, ladder, now);
    forget_rows(memory, ladder);
    memory.t3i.status.counters = LinkCounters::default();
    ladder.t3i.host.forget_past();
    for time in &mut ladder.prim.restarts.ticks {
        time.take_if(|time| now.since(*time) > RESTART_TICKS);
    }
    let data_system = &mut ladder.task.data_system;
    if data_system.commander.number == 0 {
        data_system.commander.sent = Tick(0);
    }
    let table = &mut ladder.table;
    table.motor.sent = Tick(0);
    if table.phase == TablePhase::Valid && table.execution.outcome != Outcome::Executing {
        table.since = Tick(0);
    }
    for gripper in [&mut ladder.grip, &mut ladder.hand] {
        if !gripper.is_calibrating() {
            (gripper.closed, gripper.open) = (Readings::default(), Readings::default());
            gripper.steady = Steady::default();
        }
    }
}

/// Number the commands of each process backwards; the newest becomes [`NEWEST`].
fn count_commands(memory: &mut CommonMemory, ladder: &mut LadderState, now: Tick) {
    // Arguments: a commander, the number in its buffer, and the echoes in the state and the status of the subordinate.
    macro_rules! count {
        ($(
            $above:ident: $commander:expr, $command:ident => $below:ident $(. $execution:ident)?;
        )*) => {$(
            settle(
                $commander,
                [
                    &mut memory.$above.$command.number,
                    &mut ladder.$below $(. $execution)? .receiver.echo,
                    &mut memory.$below.status.echo,
                ],
                now,
            );
        )*};
    }
    count! {
        task: &mut ladder.task.subtask, subtask => subtask.execution;
        subtask: &mut ladder.subtask.emove, emove => emove.execution;
        subtask: &mut ladder.subtask.pedestal, pedestal => pedestal.execution;
        emove: ladder.emove.motion.commander(), prim => prim.execution;
        emove: ladder.emove.exchange.commander(), quick_change => quick_change.execution;
        emove: ladder.emove.grippers.commander(EmoveGripper::Parts), grip => grip.execution;
        emove: ladder.emove.grippers.commander(EmoveGripper::V), v_grip => v_grip.execution;
        emove: ladder.emove.grippers.commander(EmoveGripper::Tool), tool_grip => tool_grip.execution;
        prim: &mut ladder.prim.t3i, t3i => t3i;
        pedestal: &mut ladder.pedestal.hand, hand => hand.execution;
        pedestal: &mut ladder.pedestal.table, table => table.execution;
    }
}

const NEWEST: u32 = 1000; // the number that the newest command gets; 0 means none

/// Number a commander's commands. The send time of the last command matters until every echo has arrived.
fn settle(commander: &mut Commander, numbers: [&mut u32; 3], now: Tick) {
    let newest = commander.number;
    if numbers.iter().all(|number| **number == newest) && commander.sent != now {
        commander.sent = Tick(0);
    }
    for number in [&mut commander.number].into_iter().chain(numbers) {
        if newest != 0 && *number != 0 {
            *number = number.wrapping_sub(newest).wrapping_add(NEWEST);
        }
    }
}

/// Number the pose records that are in use, for each process from its newest one, which becomes 0.
fn count_poses(memory: &mut CommonMemory, ladder: &mut LadderState) {
    let newest = [
        (pose_range::TASK, ladder.task.last_pose),
        (pose_range::SUBTASK, ladder.subtask.last_pose),
        (pose_range::EMOVE, *ladder.emove.motion.pose_numbers().1),
        (pose_range::PRIM, ladder.prim.newest_pose),
    ];
    let mut numbers = pose_numbers(memory, ladder);
    for (writer, newest) in newest {
        let age = |number: u32| newest.wrapping_sub(number) & !pose_range::WRITER;
        let of_writer = |number: u32| number & pose_range::WRITER == writer;
        let used: BTreeSet<u32> =
            numbers.iter().map(|number| **number).filter(|number| of_writer(*number)).map(age).collect();
        for number in numbers.iter_mut().filter(|number| of_writer(***number)) {
            let place = used.range(..age(**number)).count();
            **number = writer | u32::try_from(place).unwrap_or(u32::MAX);
        }
    }
}

fn pose_numbers<'a>(memory: &'a mut CommonMemory, ladder: &'a mut LadderState) -> Vec<&'a mut u32> {
    let (task, subtask, emove, prim) =
        (&mut memory.task, &mut memory.subtask, &mut memory.emove, &mut memory.prim);
    let plan = &mut ladder.task.plan;
    let sites = [&mut plan.source, &mut plan.destination, &mut plan.end_at];
    let records =
        task.poses.iter_mut().chain(&mut subtask.poses).chain(&mut emove.poses).chain(&mut prim.poses);
    let records = records.chain(sites.into_iter().filter_map(|site| Some(&mut site.location.as_mut()?.pose)));
    let aims = &mut ladder.subtask.aims;
    let status = &mut prim.status;
    let optional = [
        &mut task.subtask.pose,
        &mut subtask.emove.pose,
        &mut subtask.status.reference_pose,
        &mut emove.status.reference_pose,
        &mut status.present_pose,
        &mut status.sensor_pose,
        &mut status.detected_pose,
        &mut status.recorded_pose,
        &mut aims.first.pose,
        &mut aims.second.pose,
        &mut aims.third.pose,
    ];
    let (route, last_of_emove) = ladder.emove.motion.pose_numbers();
    let route = route.into_iter().flat_map(|route| [&mut route.departure, &mut route.goal]);
    let last = [
        &mut emove.prim.pose,
        &mut ladder.task.last_pose,
        &mut ladder.subtask.last_pose,
        last_of_emove,
        &mut ladder.prim.newest_pose,
    ];
    let optional = records.map(|record| &mut record.number).chain(optional);
    optional.flatten().chain(route).chain(last).collect()
}

/// Remove the rows from all headers, and from the states that they are written from.
fn forget_rows(memory: &mut CommonMemory, ladder: &mut LadderState) {
    for process in ProcessId::ALL {
        let header = memory.header_mut(*process);
        *header = Header { stamp: header.stamp, republished: header.republished, ..Header::default() };
    }
    let executions: [&mut Execution; 11] = [
        &mut ladder.task.execution,
        &mut ladder.subtask.execution,
        &mut ladder.emove.execution,
        &mut ladder.prim.execution,
        &mut ladder.quick_change.execution,
        &mut ladder.grip.execution,
        &mut ladder.v_grip.execution,
        &mut ladder.tool_grip.execution,
        &mut ladder.pedestal.execution,
        &mut ladder.hand.execution,
        &mut ladder.table.execution,
    ];
    for rows in executions.into_iter().map(|execution| &mut execution.rows).chain([&mut ladder.t3i.rows]) {
        *rows = Rows::ZERO;
    }
}

#[cfg(test)]
mod tests {
    use levels::prim::state::RestartTimes;

    use super::{
        super::{branch::Branch, parent::emulator, tests::facility},
        *,
    };

    /// Common memory and state while a gripper is fetched: all four processes with pose records use them.
    fn fetching() -> (CommonMemory, LadderState, Tick) {
        let facility = facility("turned-part");
        let mut branch = Branch::start(&facility).expect("the cell is sound");
        let mut hwsc = emulator(&facility);
        while branch.at() < Tick(1401) {
            branch.step(&mut hwsc);
        }
        (*branch.memory(), branch.ladder(), branch.at())
    }

    fn forgotten(
        (mut memory, mut ladder, now): (CommonMemory, LadderState, Tick),
    ) -> (CommonMemory, LadderState) {
        forget(&mut memory, &mut ladder, now);
        (memory, ladder)
    }

    #[test]
    fn every_pose_number_field_is_renumbered() {
        let (mut memory, mut ladder, now) = fetching();
        let numbers: BTreeSet<u32> =
            pose_numbers(&mut memory, &mut ladder).into_iter().map(|one| *one).collect();
        let numbers: Vec<u32> = numbers.into_iter().filter(|one| *one > pose_range::CHANGING).collect();
        for writer in [pose_range::TASK, pose_range::SUBTASK, pose_range::EMOVE, pose_range::PRIM] {
            assert!(numbers.iter().any(|one| one & pose_range::WRITER == writer), "none of {writer:x}");
        }
        // No record in use has any of these numbers.
        for number in pose_numbers(&mut memory, &mut ladder).into_iter().filter(|one| numbers.contains(one)) {
            *number += 1_000_000;
        }
        let text = format!("{:?}", forgotten((memory, ladder, now)));
        let left = numbers.iter().map(|one| one + 1_000_000).find(|one| text.contains(&one.to_string()));
        assert_eq!(left, None);
        let left =
            numbers.iter().filter(|one| *one & 0xFF_FFFF > 100).find(|one| text.contains(&one.to_string()));
        assert_eq!(left, None);
    }

    #[test]
    fn states_differing_only_in_the_past_are_equal() {
        let (mut memory, mut ladder, now) = fetching();
        let expected = forgotten((memory, ladder, now));
        for number in pose_numbers(&mut memory, &mut ladder) {
            *number += u32::from(*number > pose_range::CHANGING) * 12;
        }
        let echoes = [&mut memory.prim.status.echo, &mut ladder.prim.execution.receiver.echo];
        for number in [&mut memory.emove.prim.number, &mut ladder.emove.motion.commander().number]
            .into_iter()
            .chain(echoes)
        {
            *number += 3;
        }
        ladder.prim.restarts = RestartTimes { ticks: [Some(Tick(700)); _] };
        memory.grip.header.decided = None;
        memory.t3i.status.counters.naks += 1;
        assert_eq!(forgotten((memory, ladder, now)), expected);
        ladder.prim.restarts = RestartTimes { ticks: [Some(now); _] };
        assert_ne!(forgotten((memory, ladder, now)), expected, "recent restarts count");
    }

    #[test]
    fn command_without_echo_keeps_its_time() {
        let (mut memory, mut ladder, now) = fetching();
        let expected = forgotten((memory, ladder, now));
        (memory.emove.prim.number, ladder.emove.motion.commander().number) =
            (memory.emove.prim.number + 1, ladder.emove.motion.commander().number + 1);
        let sent = forgotten((memory, ladder, now));
        assert_ne!(sent, expected);
        ladder.emove.motion.commander().sent = now;
        assert_ne!(forgotten((memory, ladder, now)), sent, "it is lost later");
    }
}
