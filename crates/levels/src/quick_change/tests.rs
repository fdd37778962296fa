use interfaces::{
    CommonMemory, ExternalInputs, QuickChangeOutputs, Reason,
    device::{GroupHealth, QuickChangeSensors, QuickChangeValves},
    quick_change::{QuickChangeCommand, QuickChangeReport, QuickChangeStatus, QuickChangeVerb, RingPosition},
};
use proptest::prelude::*;
use rcs_core::tick::Tick;

use super::{
    QuickChange,
    preprocess::{MALFUNCTION_TICKS, STUCK_TICKS, TURN_TICKS},
    tables::Step,
};
use crate::{
    bench::{self, Tested, World},
    coverage::silent,
    environment::ring::Ring,
};

type Bench = bench::Bench<QuickChange, Ring>;

impl Tested<()> for QuickChange {
    type Order = QuickChangeVerb;
    type End = (QuickChangeReport, Reason);
    const LONGEST: u64 = TURN_TICKS + STUCK_TICKS as u64 + 2;

    fn order(memory: &mut CommonMemory, command: QuickChangeVerb, number: u32) {
        memory.emove.quick_change = QuickChangeCommand { number, command };
    }

    fn end(outputs: &QuickChangeOutputs) -> Option<(QuickChangeReport, Reason)> {
        let status = outputs.status;
        (status.report != QuickChangeReport::Executing).then_some((status.report, status.reason))
    }

    fn check(outputs: &QuickChangeOutputs, _: &CommonMemory, _: &ExternalInputs) {
        let QuickChangeValves { lock, unlock, port } = outputs.valves;
        assert!(!(lock && unlock) && port == (lock || unlock));
        assert!(!port || outputs.status.report == QuickChangeReport::Executing);
    }
}

impl World<QuickChange> for Ring {
    fn sense(&mut self, _: Tick, _: &mut CommonMemory, external: &mut ExternalInputs) {
        external.devices.quick_change = self.sensors();
    }

    fn act(&mut self, _: Tick, _: &CommonMemory, after: &mut CommonMemory, _: &mut ExternalInputs) {
        self.turn(after.quick_change.valves);
    }
}

impl Bench {
    /// A process without a reading yet, and a ring.
    fn at(place: f64) -> Self {
        Self::before(Ring::at(place))
    }

    fn read(&mut self, locked: bool, unlocked: bool, end_effector_id: u8) -> QuickChangeOutputs {
        self.world.claim = Some(QuickChangeSensors { locked, unlocked, end_effector_id });
        self.step()
    }

    fn report(&mut self, locked: bool, unlocked: bool, id: u8) -> QuickChangeReport {
        self.read(locked, unlocked, id).status.report
    }

    fn watch(&mut self, ticks: u8, locked: bool, unlocked: bool, id: u8) -> QuickChangeStatus {
        (0..ticks).map(|_| self.read(locked, unlocked, id).status).last().unwrap()
    }

    fn valves(&self) -> QuickChangeValves {
        self.memory.quick_change.valves
    }
}

const SHUT: QuickChangeValves = QuickChangeValves { lock: false, unlock: false, port: false };
const LOCKED: (QuickChangeReport, Reason) = (QuickChangeReport::Locked, Reason::None);
const UNLOCKED: (QuickChangeReport, Reason) = (QuickChangeReport::Unlocked, Reason::None);

#[test]
fn every_row_fires() {
    let silent = silent::<QuickChange, ()>(&[
        late_ring_is_stuck_until_the_next_command,
        failing_sensors_stop_the_ring,
        unread_ring_is_not_turned,
        ring_locking_under_an_illegal_id_is_a_sensor_fault,
        undetected_ring_is_stuck_after_a_while,
        malfunction_is_reported_after_a_while,
        restart_and_unknown_command_are_reported_with_the_ring,
        ring_turns_only_while_its_device_answers,
    ]);
    assert_eq!(silent, [""; 0]);
}

#[test]
fn port_is_enabled_only_while_the_ring_turns() {
    let mut bench = Bench::at(0.0);
    bench.step();
    let began = bench.tick;
    assert_eq!((bench.execute(QuickChangeVerb::Lock), bench.tick.since(began)), (LOCKED, 9));
    assert_eq!((bench.memory.quick_change.status.end_effector_id, bench.valves()), (Some(1), SHUT));
    let began = bench.tick;
    assert_eq!(
        (bench.execute(QuickChangeVerb::Lock), bench.tick.since(began)),
        (LOCKED, 1),
        "locked already"
    );
    bench.world.id = 200;
    assert_eq!(bench.execute(QuickChangeVerb::Unlock), UNLOCKED, "separating pins do not matter");
    assert_eq!((bench.world.place, bench.valves()), (0.0, SHUT));
}

#[test]
fn ring_turns_only_while_its_device_answers() {
    for (verb, place, done) in
        [(QuickChangeVerb::Lock, 0.0, LOCKED), (QuickChangeVerb::Unlock, 1.0, UNLOCKED)]
    {
        let mut bench = Bench::at(place);
        bench.step();
        bench.send(verb);
        bench.wait(4);
        let half = bench.world.place;
        // The readings do not change.
        bench.world.claim = Some(bench.world.sensors());
        bench.external.devices.field.quick_change = GroupHealth::Stale;
        let status = bench.wait(40).status;
        assert_eq!((status.report, bench.valves()), (QuickChangeReport::Executing, SHUT));
        assert!((bench.world.place - half).abs() < 0.2, "the ring stays half turned");
        bench.external.devices.field.quick_change = GroupHealth::Fresh;
        bench.world.claim = None;
        assert_eq!(bench.finish(), done, "the time of the ring has not advanced");
        for (connection, reason) in
            [(GroupHealth::Lost, Reason::DeviceSilent), (GroupHealth::Tripped, Reason::DeviceTripped)]
        {
            let mut bench = Bench::at(place);
            bench.step();
            bench.external.devices.field.quick_change = connection;
            assert_eq!(bench.execute(verb), (QuickChangeReport::SensorMalfunction, reason));
            assert_eq!(bench.valves(), SHUT);
        }
    }
}

#[test]
fn late_ring_is_stuck_until_the_next_command() {
    for (verb, place, done) in
        [(QuickChangeVerb::Lock, 0.0, LOCKED), (QuickChangeVerb::Unlock, 1.0, UNLOCKED)]
    {
        for jam in [0.55, 0.05, 0.95] {
            let mut bench = Bench::at(place);
            bench.step();
            bench.world.jam = Some(jam);
            let began = bench.tick;
            assert_eq!(bench.execute(verb), (QuickChangeReport::Stuck, Reason::QuickChangeStuck));
            assert_eq!(bench.tick.since(began), TURN_TICKS + 2);
            for _ in 0..50 {
                let report = bench.report(place >= 1.0, place <= 0.0, 1);
                assert_eq!(
                    report,
                    QuickChangeReport::Stuck,
                    "although the ring is detected at its old place"
                );
                assert_eq!(bench.valves(), SHUT);
            }
            (bench.world.jam, bench.world.claim) = (None, None);
            assert_eq!(bench.execute(verb), done);
        }
    }
}

#[test]
fn failing_sensors_stop_the_ring() {
    for (verb, locked) in [(QuickChangeVerb::Lock, false), (QuickChangeVerb::Unlock, true)] {
        let mut bench = Bench::at(f64::from(u8::from(locked)));
        bench.step();
        bench.send(verb);
        for _ in 0..MALFUNCTION_TICKS {
            assert_eq!(bench.report(locked, !locked, 1), QuickChangeReport::Executing);
        }
        let end = bench.watch(MALFUNCTION_TICKS, true, true, 1);
        assert_eq!(
            (end.report, end.reason),
            (QuickChangeReport::SensorMalfunction, Reason::QuickChangeFault)
        );
        assert_eq!(bench.valves(), SHUT);
        assert_eq!(bench.report(true, false, 1), QuickChangeReport::SensorMalfunction);
        assert_eq!(bench.execute(QuickChangeVerb::Pause), LOCKED);
    }
}

#[test]
fn unread_ring_is_not_turned() {
    for (verb, locked) in [(QuickChangeVerb::Lock, false), (QuickChangeVerb::Unlock, true)] {
        let mut bench = Bench::at(0.5);
        bench.step();
        bench.send(verb);
        assert_eq!((bench.step().status.report, bench.valves()), (QuickChangeReport::Executing, SHUT));
        assert!(bench.read(locked, !locked, 1).valves.port);
    }
}

#[test]
fn ring_locking_under_an_illegal_id_is_a_sensor_fault() {
    let mut bench = Bench::at(0.0);
    bench.read(false, true, 4);
    bench.send(QuickChangeVerb::Lock);
    assert_eq!(bench.watch(MALFUNCTION_TICKS, false, true, 4).report, QuickChangeReport::Executing);
    let end = bench.watch(MALFUNCTION_TICKS, true, false, 4);
    assert_eq!((end.report, end.reason), (QuickChangeReport::SensorMalfunction, Reason::QuickChangeFault));
}

#[test]
fn restart_while_the_ring_turns_stops_it() {
    let mut bench = Bench::at(0.0);
    bench.step();
    bench.send(QuickChangeVerb::Lock);
    bench.wait(4);
    bench.restart();
    let status = bench.wait(u32::from(STUCK_TICKS) + 1).status;
    assert_eq!((status.report, status.reason), (QuickChangeReport::Stuck, Reason::Restarted));
    assert_eq!(bench.valves(), SHUT);
    assert_eq!((bench.execute(QuickChangeVerb::Lock), bench.world.place), (LOCKED, 1.0));
}

/// The air of the previous tick may still turn the ring, so the old reading is not valid.
#[test]
fn restarted_process_reads_a_ring_with_air_in_the_next_tick() {
    let mut bench = Bench::at(1.0);
    bench.step();
    bench.send(QuickChangeVerb::Unlock);
    assert!(bench.read(true, false, 1).valves.port);
    bench.restart();
    let restarted = bench.read(true, false, 1);
    assert_eq!((restarted.status.ring, restarted.valves), (RingPosition::Unread, SHUT));
    assert_eq!(restarted.status.report, QuickChangeReport::Executing);
    let next = bench.read(false, true, 1).status;
    assert_eq!((next.ring, next.report), (RingPosition::Unlocked, QuickChangeReport::Unlocked));
}

#[test]
fn ring_is_reported_before_any_command() {
    let mut bench = Bench::at(1.0);
    let before = bench.step().status;
    assert_eq!((before.echo, before.report, before.end_effector_id), (0, QuickChangeReport::Locked, Some(1)));
    bench.send(QuickChangeVerb::Pause);
    let after = bench.read(false, true, 0).status;
    assert_eq!((after.echo, after.report, after.end_effector_id), (1, QuickChangeReport::Unlocked, None));
    assert_eq!(after.reason, Reason::None);
}

#[test]
fn undetected_ring_is_stuck_after_a_while() {
    let mut bench = Bench::at(1.0);
    assert_eq!(bench.report(true, false, 1), QuickChangeReport::Locked);
    for _ in 1..STUCK_TICKS {
        assert_eq!(bench.report(false, false, 1), QuickChangeReport::Locked);
    }
    assert_eq!(bench.report(false, false, 1), QuickChangeReport::Stuck);
    assert_eq!(bench.report(false, true, 1), QuickChangeReport::Unlocked);
}

#[test]
fn ring_position_is_published_in_every_tick() {
    let readings = [
        (true, false, RingPosition::Locked),
        (false, true, RingPosition::Unlocked),
        (false, false, RingPosition::Between),
        (true, true, RingPosition::Implausible),
    ];
    let mut bench = Bench::at(1.0);
    for verb in
        [None, Some(QuickChangeVerb::Pause), Some(QuickChangeVerb::Lock), Some(QuickChangeVerb::Unlock)]
    {
        for (locked, unlocked, ring) in readings.into_iter().cycle().take(160) {
            assert_eq!(bench.read(locked, unlocked, 1).status.ring, ring);
        }
        verb.into_iter().for_each(|verb| bench.send(verb));
    }
    // PAUSE stops the ring between its ends. The status still reports the old state; `ring` has the present one.
    let mut bench = Bench::at(1.0);
    bench.step();
    bench.send(QuickChangeVerb::Unlock);
    bench.wait(3);
    assert_eq!(bench.execute(QuickChangeVerb::Pause), LOCKED);
    assert_eq!(bench.memory.quick_change.status.ring, RingPosition::Between);
    bench.restart();
    let restarted = bench.step().status;
    assert_eq!((restarted.reason, restarted.ring), (Reason::Restarted, RingPosition::Between));
}

#[test]
fn malfunction_is_reported_after_a_while() {
    let mut bench = Bench::at(1.0);
    for (locked, unlocked, id) in [(true, true, 1), (true, false, 4), (true, false, 255)] {
        assert_eq!(bench.report(true, false, 1), QuickChangeReport::Locked);
        for _ in 1..MALFUNCTION_TICKS {
            assert_eq!(bench.report(locked, unlocked, id), QuickChangeReport::Locked);
        }
        let status = bench.read(locked, unlocked, id).status;
        assert_eq!(status.report, QuickChangeReport::SensorMalfunction);
        assert_eq!(status.end_effector_id, Some(1), "an illegal id is not published");
    }
}

#[test]
fn restart_and_unknown_command_are_reported_with_the_ring() {
    let mut bench = Bench::at(1.0);
    QuickChange::order(&mut bench.memory, QuickChangeVerb::Pause, 7);
    assert_eq!(
        bench.finish(),
        (QuickChangeReport::Locked, Reason::Restarted),
        "the restarted process adopts the command"
    );
    assert_eq!(bench.execute(QuickChangeVerb::Pause), LOCKED);
    assert_eq!(bench.execute(QuickChangeVerb::None).1, Reason::UnknownCommand);
}

/// The search starts from every step and reading, with a ring that turns or is stuck, and with failing sensors.
#[test]
fn every_command_ends_from_every_state() {
    let mut ends = std::collections::BTreeSet::new();
    let worlds = [0.0, 0.3, 1.0].into_iter().flat_map(|place| {
        [(0.125, 1), (0.0, 1), (0.02, 1), (0.125, 9)].map(|(speed, id)| Ring { speed, id, ..Ring::at(place) })
    });
    for ring in worlds {
        for (step, reading) in Step::ALL.iter().flat_map(|s| RingPosition::ALL.iter().map(move |r| (s, r))) {
            for verb in QuickChangeVerb::ALL {
                let mut bench = Bench::at(1.0);
                bench.step();
                let state = &mut bench.process.state;
                (state.step, state.ring, state.reading, state.reading_ticks) = (*step, *reading, *reading, 1);
                bench.world = ring;
                ends.insert(bench.execute(*verb).0.code());
            }
        }
    }
    assert_eq!(ends.len(), 4, "locked, unlocked, malfunction, stuck: {ends:?}");
}

proptest! {
    /// With random commands and sensors, air and port are on only for a command that turns the ring, within its time
    /// limit, and ids are legal. The same inputs give the same bytes.
    #[test]
    fn the_ring_is_moved_only_by_command(
        readings in prop::collection::vec((any::<bool>(), any::<bool>(), any::<u8>(), 0_u8..40), 1..300)
    ) {
        let (mut first, mut second) = (Bench::at(0.0), Bench::at(0.0));
        let mut turning = 0;
        for (locked, unlocked, id, what) in readings {
            for bench in [&mut first, &mut second] {
                QuickChangeVerb::from_code(what).into_iter().for_each(|verb| bench.send(verb));
                bench.read(locked, unlocked, id);
            }
            turning = if QuickChangeVerb::from_code(what).is_some() { 0 } else { turning };
            let QuickChangeOutputs { valves, status, .. } = first.memory.quick_change;
            let verb = first.memory.emove.quick_change.command;
            prop_assert!(!valves.lock || verb == QuickChangeVerb::Lock);
            prop_assert!(!valves.unlock || verb == QuickChangeVerb::Unlock);
            turning += u64::from(valves.port);
            prop_assert!(turning <= TURN_TICKS + 1);
            prop_assert!(status.end_effector_id.is_none_or(|id| (1..=3).contains(&id)));
            prop_assert_eq!(first.image(), second.image());
        }
    }
}
