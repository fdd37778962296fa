//! Scenarios of Quick Change.

use interfaces::{
    CommonMemory, ExternalInputs, QuickChangeOutputs, Reason,
    device::{QuickChangeSensors, QuickChangeValves},
    process::{Inputs, Process},
    quick_change::{QuickChangeCommand, QuickChangeReport, QuickChangeVerb, RingPosition},
};
use proptest::prelude::*;
use rcs_core::{plain::to_bytes, tick::Tick};

use super::{
    QuickChange,
    preprocess::{MALFUNCTION_TICKS, STUCK_TICKS, TURN_TICKS},
    tables::{Step, TABLES},
};
use crate::coverage::Coverage;

/// A process with its inputs.
#[derive(Default)]
struct Bench {
    process: QuickChange,
    memory: CommonMemory,
    external: ExternalInputs,
    tick: Tick,
    rows: Coverage,
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
        self.rows.note(&outputs.header);
        self.memory.quick_change = outputs;
        outputs
    }

    fn report(&mut self, locked: bool, unlocked: bool, id: u8) -> QuickChangeReport {
        self.step(locked, unlocked, id).status.report
    }
}

/// A ring that turns with the valves, a tick at a time.
#[derive(Clone, Copy)]
struct RingModel {
    /// 0 unlocked, 1 locked.
    place: f64,
    /// Share of the way that it makes in a tick.
    speed: f64,
    /// Where it jams, if it does.
    jam: Option<f64>,
}

impl RingModel {
    fn turn(&mut self, valves: QuickChangeValves) {
        let way = match (valves.port, valves.lock, valves.unlock) {
            (true, true, false) => self.speed,
            (true, false, true) => -self.speed,
            _ => 0.0,
        };
        let next = (self.place + way).clamp(0.0, 1.0);
        let jammed = self.jam.is_some_and(|at| (at - self.place) * (at - next) < 0.0);
        self.place = if jammed { self.place } else { next };
    }
}

impl Bench {
    /// Command, and let the ring follow until the status is another than executing; returns it and the ticks.
    fn execute(&mut self, verb: QuickChangeVerb, ring: &mut RingModel, id: u8) -> (QuickChangeOutputs, u32) {
        self.command(self.memory.emove.quick_change.number + 1, verb);
        for ticks in 1..200 {
            let outputs = self.step(ring.place >= 1.0, ring.place <= 0.0, id);
            let QuickChangeValves { lock, unlock, port } = outputs.valves;
            assert!(!(lock && unlock) && port == (lock || unlock));
            assert_eq!(
                port,
                outputs.status.report == QuickChangeReport::Executing,
                "enabled only while the ring turns"
            );
            ring.turn(outputs.valves);
            if outputs.status.report != QuickChangeReport::Executing {
                return (outputs, ticks);
            }
        }
        panic!("no end: {:?}", self.process);
    }
}

const UNLOCKED: RingModel = RingModel { place: 0.0, speed: 0.125, jam: None };

#[test]
fn every_row_fires() {
    let mut bench = Bench::default();
    // QC-PAUSE 3 to 8.
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
    // QC-LOCK 4, 5, 6, QC-UNLOCK 3, 4, 5, QC-PAUSE 1.
    let mut ring = UNLOCKED;
    for verb in [QuickChangeVerb::Lock, QuickChangeVerb::Unlock] {
        bench.execute(verb, &mut ring, 1);
        ring.jam = Some(0.55);
        bench.execute(
            if verb == QuickChangeVerb::Lock { QuickChangeVerb::Unlock } else { QuickChangeVerb::Lock },
            &mut ring,
            1,
        );
        bench.step(false, false, 1);
        ring.jam = None;
    }
    // QC-LOCK 2, 3, QC-UNLOCK 2, QC-PAUSE 2.
    for verb in [QuickChangeVerb::Lock, QuickChangeVerb::Unlock] {
        for (locked, unlocked, id) in [(true, true, 1), (true, false, 9)] {
            for _ in 0..2 {
                bench.command(bench.memory.emove.quick_change.number + 1, verb);
                (0..=STUCK_TICKS).for_each(|_| {
                    bench.step(locked, unlocked, id);
                });
            }
        }
    }
    // QC-LOCK 1, QC-UNLOCK 1: commanded before any reading counts.
    for verb in [QuickChangeVerb::Lock, QuickChangeVerb::Unlock] {
        bench.process = QuickChange::default();
        bench.command(0, verb);
        bench.step(false, false, 0);
        bench.command(1, verb);
        bench.step(false, false, 0);
    }
    bench.command(2, QuickChangeVerb::None);
    bench.step(false, false, 0);
    // The ring is watched after a restart too, and the row that says what it does is named.
    assert_eq!(bench.rows.missing(TABLES), ["EXECUTE 2"]);
}

#[test]
fn the_ring_is_locked_and_unlocked_with_the_port_enabled_only_while_it_turns() {
    let (mut bench, mut ring) = (Bench::default(), UNLOCKED);
    bench.step(false, true, 1);
    let (locked, ticks) = bench.execute(QuickChangeVerb::Lock, &mut ring, 1);
    assert_eq!((locked.status.report, locked.status.reason), (QuickChangeReport::Locked, Reason::None));
    assert_eq!((locked.status.echo, locked.status.end_effector_id), (1, Some(1)));
    assert_eq!((locked.valves, ticks), (QuickChangeValves::default(), 9));
    let (again, ticks) = bench.execute(QuickChangeVerb::Lock, &mut ring, 1);
    assert_eq!((again.status.report, ticks), (QuickChangeReport::Locked, 1), "locked already");
    let (unlocked, _) = bench.execute(QuickChangeVerb::Unlock, &mut ring, 200);
    assert_eq!(unlocked.status.report, QuickChangeReport::Unlocked, "pins that part do not matter");
    assert_eq!((ring.place, unlocked.valves), (0.0, QuickChangeValves::default()));
}

#[test]
fn a_ring_that_does_not_arrive_is_stuck_until_the_next_command() {
    for (verb, place) in [(QuickChangeVerb::Lock, 0.0), (QuickChangeVerb::Unlock, 1.0)] {
        for jam in [0.55, 0.05, 0.95] {
            let (mut bench, mut ring) = (Bench::default(), RingModel { place, speed: 0.125, jam: Some(jam) });
            bench.step(place >= 1.0, place <= 0.0, 1);
            let (outputs, ticks) = bench.execute(verb, &mut ring, 1);
            assert_eq!(outputs.status.report, QuickChangeReport::Stuck);
            assert_eq!((outputs.status.reason, u64::from(ticks)), (Reason::QuickChangeStuck, TURN_TICKS + 2));
            for _ in 0..50 {
                let outputs = bench.step(place >= 1.0, place <= 0.0, 1);
                assert_eq!(
                    outputs.status.report,
                    QuickChangeReport::Stuck,
                    "though the ring is seen where it was"
                );
                assert_eq!(outputs.valves, QuickChangeValves::default());
            }
            ring.jam = None;
            let (outputs, _) = bench.execute(verb, &mut ring, 1);
            assert!(matches!(outputs.status.report, QuickChangeReport::Locked | QuickChangeReport::Unlocked));
            assert_eq!(outputs.status.reason, Reason::None);
        }
    }
}

#[test]
fn sensors_that_fail_on_the_way_stop_the_ring() {
    let mut bench = Bench::default();
    bench.step(false, true, 1);
    bench.command(1, QuickChangeVerb::Lock);
    for _ in 0..MALFUNCTION_TICKS {
        assert_eq!(bench.step(false, true, 1).status.report, QuickChangeReport::Executing);
    }
    let outputs = (0..MALFUNCTION_TICKS).map(|_| bench.step(true, true, 1)).last().unwrap();
    assert_eq!(outputs.status.report, QuickChangeReport::SensorMalfunction);
    assert_eq!(
        (outputs.status.reason, outputs.valves),
        (Reason::QuickChangeFault, QuickChangeValves::default())
    );
    assert_eq!(bench.step(true, false, 1).status.report, QuickChangeReport::SensorMalfunction);
    bench.command(2, QuickChangeVerb::Pause);
    assert_eq!(bench.step(true, false, 1).status.report, QuickChangeReport::Locked);
}

#[test]
fn a_ring_that_locks_under_an_illegal_id_is_a_fault_of_the_sensors() {
    let mut bench = Bench::default();
    bench.step(false, true, 4);
    bench.command(1, QuickChangeVerb::Lock);
    for _ in 0..MALFUNCTION_TICKS {
        assert_eq!(bench.report(false, true, 4), QuickChangeReport::Executing);
    }
    let end = (0..MALFUNCTION_TICKS).map(|_| bench.step(true, false, 4).status).last().unwrap();
    assert_eq!((end.report, end.reason), (QuickChangeReport::SensorMalfunction, Reason::QuickChangeFault));
}

#[test]
fn a_restart_while_the_ring_turns_leaves_it_where_it_is() {
    let (mut bench, mut ring) = (Bench::default(), UNLOCKED);
    bench.step(false, true, 1);
    bench.command(1, QuickChangeVerb::Lock);
    for _ in 0..4 {
        ring.turn(bench.step(ring.place >= 1.0, ring.place <= 0.0, 1).valves);
    }
    bench.process = QuickChange::default();
    let outputs = (0..=STUCK_TICKS).map(|_| bench.step(false, false, 1)).last().unwrap();
    assert_eq!((outputs.status.report, outputs.status.reason), (QuickChangeReport::Stuck, Reason::Restarted));
    assert_eq!(outputs.valves, QuickChangeValves::default());
    let (outputs, _) = bench.execute(QuickChangeVerb::Lock, &mut ring, 1);
    assert_eq!((outputs.status.report, ring.place), (QuickChangeReport::Locked, 1.0));
}

/// The air of the last tick may still turn it: where it was seen says nothing.
#[test]
fn a_ring_that_had_air_before_a_restart_is_read_in_the_next_tick() {
    let mut bench = Bench::default();
    bench.step(true, false, 1);
    bench.command(1, QuickChangeVerb::Unlock);
    assert!(bench.step(true, false, 1).valves.port);
    bench.process = QuickChange::default();
    let restarted = bench.step(true, false, 1);
    assert_eq!(
        (restarted.status.ring, restarted.valves),
        (RingPosition::Unread, QuickChangeValves::default())
    );
    assert_eq!(restarted.status.report, QuickChangeReport::Executing);
    let next = bench.step(false, true, 1).status;
    assert_eq!((next.ring, next.report), (RingPosition::Unlocked, QuickChangeReport::Unlocked));
}

#[test]
fn the_ring_is_reported_before_any_command_and_echoed_after_it() {
    let mut bench = Bench::default();
    let before = bench.step(true, false, 1).status;
    assert_eq!((before.echo, before.report, before.end_effector_id), (0, QuickChangeReport::Locked, Some(1)));
    bench.command(1, QuickChangeVerb::Pause);
    let after = bench.step(false, true, 0).status;
    assert_eq!((after.echo, after.report, after.end_effector_id), (1, QuickChangeReport::Unlocked, None));
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
fn where_the_ring_is_is_published_in_every_tick_whatever_is_reported() {
    let readings = [
        (true, false, RingPosition::Locked),
        (false, true, RingPosition::Unlocked),
        (false, false, RingPosition::Between),
        (true, true, RingPosition::Implausible),
    ];
    let mut bench = Bench::default();
    for verb in
        [None, Some(QuickChangeVerb::Pause), Some(QuickChangeVerb::Lock), Some(QuickChangeVerb::Unlock)]
    {
        for _ in 0..40 {
            for (locked, unlocked, ring) in readings {
                assert_eq!(bench.step(locked, unlocked, 1).status.ring, ring);
            }
        }
        if let Some(verb) = verb {
            bench.command(bench.memory.emove.quick_change.number + 1, verb);
        }
    }
    // Half unlocked, then PAUSE: the report lags, the position does not.
    let (mut bench, mut ring) = (Bench::default(), RingModel { place: 1.0, ..UNLOCKED });
    bench.step(true, false, 1);
    bench.command(1, QuickChangeVerb::Unlock);
    for _ in 0..3 {
        ring.turn(bench.step(ring.place >= 1.0, ring.place <= 0.0, 1).valves);
    }
    let (paused, _) = bench.execute(QuickChangeVerb::Pause, &mut ring, 1);
    assert_eq!(
        (paused.status.report, paused.status.ring),
        (QuickChangeReport::Locked, RingPosition::Between)
    );
    bench.process = QuickChange::default();
    let restarted = bench.step(false, false, 1).status;
    assert_eq!((restarted.reason, restarted.ring), (Reason::Restarted, RingPosition::Between));
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
        assert_eq!(outputs.status.end_effector_id, Some(1), "an illegal id is not passed on");
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

/// From every step and reading, with a ring that turns, one that is stuck and sensors that fail.
#[test]
fn every_command_ends_from_every_state_whether_the_ring_obeys_or_not() {
    let mut ends = std::collections::BTreeSet::new();
    for step in Step::ALL {
        for ring in RingPosition::ALL {
            for place in [0.0, 0.3, 1.0] {
                for (speed, id) in [(0.125, 1), (0.0, 1), (0.02, 1), (0.125, 9)] {
                    for verb in QuickChangeVerb::ALL {
                        let mut bench = Bench::default();
                        bench.step(true, false, 1);
                        (bench.process.state.step, bench.process.state.ring) = (*step, *ring);
                        (bench.process.state.reading, bench.process.state.reading_ticks) = (*ring, 1);
                        let mut model = RingModel { place, speed, jam: None };
                        bench.command(1, *verb);
                        let end = (0..TURN_TICKS + 2 + u64::from(STUCK_TICKS)).find_map(|_| {
                            let outputs = bench.step(model.place >= 1.0, model.place <= 0.0, id);
                            model.turn(outputs.valves);
                            let report = outputs.status.report;
                            (report != QuickChangeReport::Executing).then_some(report)
                        });
                        ends.insert(end.expect("it ends").code());
                    }
                }
            }
        }
    }
    assert_eq!(ends.len(), 4, "locked, unlocked, malfunction, stuck: {ends:?}");
}

proptest! {
    /// Whatever the sensors say and whatever is commanded: air and port only for a command that turns the
    /// ring, never for longer than its time, ids are legal, and the same inputs give the same bits.
    #[test]
    fn the_ring_is_moved_only_by_command(
        readings in prop::collection::vec((any::<bool>(), any::<bool>(), any::<u8>(), 0_u8..40), 1..300)
    ) {
        let (mut first, mut second) = (Bench::default(), Bench::default());
        let mut turning = 0;
        for (locked, unlocked, id, what) in readings {
            if let Some(verb) = QuickChangeVerb::from_code(what) {
                let number = first.memory.emove.quick_change.number + 1;
                first.command(number, verb);
                second.command(number, verb);
                turning = 0;
            }
            let outputs = first.step(locked, unlocked, id);
            let verb = first.memory.emove.quick_change.command;
            let QuickChangeValves { lock, unlock, port } = outputs.valves;
            prop_assert_eq!(port, lock || unlock);
            prop_assert!(!lock || verb == QuickChangeVerb::Lock);
            prop_assert!(!unlock || verb == QuickChangeVerb::Unlock);
            turning += u64::from(port);
            prop_assert!(turning <= TURN_TICKS + 1);
            prop_assert!(outputs.status.end_effector_id.is_none_or(|id| (1..=3).contains(&id)));
            let image: [u8; 64] = to_bytes(&outputs);
            let again: [u8; 64] = to_bytes(&second.step(locked, unlocked, id));
            prop_assert_eq!(image, again);
        }
    }
}
