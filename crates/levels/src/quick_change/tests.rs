//! Scenarios of Quick Change.

use std::collections::BTreeSet;

use proptest::prelude::*;
use rcs_core::{
    interface::{
        CommonMemory, ExternalInputs, QuickChangeOutputs, Reason,
        device::{QuickChangeSensors, QuickChangeValves},
        quick_change::{QuickChangeCommand, QuickChangeReport, QuickChangeVerb},
    },
    process::{Inputs, Process},
    record::to_bytes,
    tick::Tick,
};

use super::{
    QuickChange, TABLES,
    preprocess::{MALFUNCTION_TICKS, STUCK_TICKS},
    tables::QC_PAUSE,
};

/// A process with its inputs.
#[derive(Default)]
struct Bench {
    process: QuickChange,
    memory: CommonMemory,
    external: ExternalInputs,
    tick: Tick,
    rows: BTreeSet<u8>,
}

impl Bench {
    fn command(&mut self, number: u32, command: QuickChangeVerb) {
        self.memory.emove.quick_change = QuickChangeCommand { number, command };
    }

    fn step(&mut self, locked: bool, unlocked: bool, end_effector_id: u8) -> QuickChangeOutputs {
        self.tick = self.tick.next();
        self.external.devices.quick_change = QuickChangeSensors { locked, unlocked, end_effector_id };
        let mut outputs = self.memory.quick_change;
        let inputs = Inputs { tick: self.tick, memory: &self.memory, external: &self.external, data: &() };
        self.process.step(&inputs, &mut outputs);
        assert_eq!(outputs.header.stamp, self.tick);
        assert_eq!(TABLES[usize::from(outputs.header.table) - 1].name, QC_PAUSE.name);
        self.rows.insert(outputs.header.row);
        self.memory.quick_change = outputs;
        outputs
    }

    fn report(&mut self, locked: bool, unlocked: bool, id: u8) -> QuickChangeReport {
        self.step(locked, unlocked, id).status.report
    }
}

#[test]
fn no_row_is_dead_and_every_row_fires() {
    QC_PAUSE.dead_rows(|row| panic!("row {row} can never fire"));
    let mut bench = Bench::default();
    for (locked, unlocked, id) in [
        (false, false, 0),
        (true, false, 1),
        (false, true, 0),
        (false, false, 0),
        (true, true, 0),
        (true, false, 9),
    ] {
        for _ in 0..=STUCK_TICKS {
            bench.step(locked, unlocked, id);
        }
    }
    assert_eq!(bench.rows, QC_PAUSE.rows.iter().map(|row| row.number).collect());
}

#[test]
fn the_ring_is_reported_before_any_command_and_echoed_after_it() {
    let mut bench = Bench::default();
    let before = bench.step(true, false, 1).status;
    assert_eq!((before.echo, before.report, before.end_effector_id), (0, QuickChangeReport::Locked, 1));
    bench.command(1, QuickChangeVerb::Pause);
    let after = bench.step(false, true, 0).status;
    assert_eq!((after.echo, after.report, after.end_effector_id), (1, QuickChangeReport::Unlocked, 0));
    assert_eq!(after.reason, Reason::None);
}

#[test]
fn a_ring_seen_by_neither_sensor_is_stuck_only_after_a_while() {
    let mut bench = Bench::default();
    assert_eq!(bench.report(true, false, 1), QuickChangeReport::Locked);
    for _ in 1..STUCK_TICKS {
        assert_eq!(bench.report(false, false, 1), QuickChangeReport::Locked);
    }
    assert_eq!(bench.report(false, false, 1), QuickChangeReport::Stuck);
    assert_eq!(bench.report(false, true, 1), QuickChangeReport::Unlocked);
}

#[test]
fn a_malfunction_is_reported_only_after_a_while() {
    let mut bench = Bench::default();
    for (locked, unlocked, id) in [(true, true, 1), (true, false, 4), (true, false, 255)] {
        assert_eq!(bench.report(true, false, 1), QuickChangeReport::Locked);
        for _ in 1..MALFUNCTION_TICKS {
            assert_eq!(bench.report(locked, unlocked, id), QuickChangeReport::Locked);
        }
        let outputs = bench.step(locked, unlocked, id);
        assert_eq!(outputs.status.report, QuickChangeReport::SensorMalfunction);
        assert_eq!(outputs.status.end_effector_id, 1, "an illegal id is not passed on");
    }
}

#[test]
fn a_restart_and_an_unknown_command_are_named_and_the_ring_still_reported() {
    let mut bench = Bench::default();
    bench.command(7, QuickChangeVerb::Pause);
    let adopted = bench.step(true, false, 1).status;
    assert_eq!(
        (adopted.echo, adopted.report, adopted.reason),
        (7, QuickChangeReport::Locked, Reason::Restarted)
    );
    bench.command(8, QuickChangeVerb::Pause);
    assert_eq!(bench.step(true, false, 1).status.reason, Reason::None);
    bench.command(9, QuickChangeVerb::None);
    assert_eq!(bench.step(true, false, 1).status.reason, Reason::UnknownCommand);
}

proptest! {
    /// Whatever the sensors say, the ring is left alone, ids are legal, and the same inputs give the same bits.
    #[test]
    fn the_ring_is_never_moved(readings in prop::collection::vec((any::<bool>(), any::<bool>(), any::<u8>()), 1..200)) {
        let (mut first, mut second) = (Bench::default(), Bench::default());
        for (locked, unlocked, id) in readings {
            let outputs = first.step(locked, unlocked, id);
            prop_assert_eq!(outputs.valves, QuickChangeValves::default());
            prop_assert!(outputs.status.end_effector_id <= 3);
            let image: [u8; 64] = to_bytes(&outputs);
            let again: [u8; 64] = to_bytes(&second.step(locked, unlocked, id));
            prop_assert_eq!(image, again);
        }
    }
}
