use interfaces::{
    CommonMemory, ExternalInputs, Reason, TableOutputs,
    device::{MotorCommand, MotorOrder, TABLE_STEPS_PER_TENTH},
    pedestal::{PedestalReport, TableCommand, TableVerb},
};
use proptest::prelude::*;
use rcs_core::tick::Tick;

use super::{
    LIMIT_MINUS, LIMIT_PLUS, Table,
    preprocess::{AT_LIMIT, LIMIT_TICKS},
    tables::TablePhase,
};
use crate::{
    bench::{self, Tested, World},
    coverage::silent,
    environment::rotary::Rotary,
};

type Bench = bench::Bench<Table, Rotary>;

impl Tested<()> for Table {
    /// A command and its angle, 0.1 degree.
    type Order = (TableVerb, i32);
    type End = (PedestalReport, Reason);
    const LONGEST: u64 = 3 * LIMIT_TICKS;

    fn order(memory: &mut CommonMemory, (command, angle): (TableVerb, i32), number: u32) {
        memory.pedestal.table = TableCommand { number, command, angle };
    }

    fn end(outputs: &TableOutputs) -> Option<(PedestalReport, Reason)> {
        let status = outputs.status;
        (status.report != PedestalReport::Executing).then_some((status.report, status.reason))
    }
}

impl World<Table> for Rotary {
    fn sense(&mut self, _: Tick, _: &mut CommonMemory, external: &mut ExternalInputs) {
        Self::sense(self, &mut external.devices.pedestal);
    }

    fn act(&mut self, _: Tick, _: &CommonMemory, after: &mut CommonMemory, _: &mut ExternalInputs) {
        self.advance(&after.table.motor);
    }
}

impl Bench {
    fn new(table: Rotary) -> Self {
        let mut bench = Self::before(table);
        bench.step();
        bench
    }

    fn calibrated() -> Self {
        let mut bench = Self::new(Rotary::new(-1200));
        assert_eq!(bench.execute((TableVerb::Calibrate, 0)), DONE);
        bench
    }
}

const DONE: (PedestalReport, Reason) = (PedestalReport::Done, Reason::None);
const STUCK: (PedestalReport, Reason) = (PedestalReport::Error, Reason::TableStuck);

#[test]
fn starting_table_calibrates_itself() {
    for start in [-3400, -1200, -210, LIMIT_PLUS, -5, AT_LIMIT] {
        let mut bench = Bench::new(Rotary::new(start));
        let status = bench.wait(600).status;
        assert_eq!(
            (status.calibrated, status.report, status.reason),
            (true, PedestalReport::Idle, Reason::None)
        );
        assert_eq!((status.position, status.echo), (Some(LIMIT_PLUS), 0));
        assert!((bench.world.angle() + 20.0).abs() < 0.05, "{}", bench.world.angle());
        let order = bench.memory.table.motor;
        assert_eq!(bench.wait(100).motor, order, "once is enough");
    }
}

#[test]
fn calibrate_command_calibrates_again() {
    let mut bench = Bench::calibrated();
    bench.execute((TableVerb::Turn, -1000));
    assert_eq!(bench.execute((TableVerb::Calibrate, 0)), DONE);
    assert_eq!(bench.memory.table.status.position, Some(LIMIT_PLUS), "at its parking place");
}

#[test]
fn angles_are_reached_and_reported() {
    let mut bench = Bench::calibrated();
    for angle in [-2135, -300, -235, LIMIT_MINUS, LIMIT_PLUS, -1000, -1000, -1001] {
        assert_eq!(bench.execute((TableVerb::Turn, angle)), DONE, "{angle}");
        assert!(
            (bench.world.angle() - f64::from(angle) / 10.0).abs() < 0.06,
            "{angle}: {}",
            bench.world.angle()
        );
        assert_eq!(bench.memory.table.status.position, Some(angle));
    }
}

#[test]
fn angle_beyond_the_limits_is_refused() {
    let mut bench = Bench::calibrated();
    for angle in [LIMIT_PLUS + 1, LIMIT_MINUS - 1, 1600, i32::MAX, i32::MIN] {
        let before = bench.world.position;
        assert_eq!(bench.execute((TableVerb::Turn, angle)), (PedestalReport::CannotDo, Reason::TableLimit));
        assert_eq!((bench.world.position, bench.memory.table.status.calibrated), (before, true));
    }
    assert_eq!(bench.execute((TableVerb::None, 0)), (PedestalReport::CannotDo, Reason::UnknownCommand));
}

#[test]
fn turn_waits_for_the_calibration() {
    let mut bench = Bench::new(Rotary::new(-1200));
    bench.wait(4);
    assert_eq!(bench.execute((TableVerb::Turn, -2135)), DONE);
    assert!((bench.world.angle() + 213.5).abs() < 0.06);
    let mut bench = Bench::new(Rotary::new(-1200));
    assert_eq!(bench.execute((TableVerb::Pause, 0)), DONE, "PAUSE waits as well");
    assert!(bench.memory.table.status.calibrated);
}

#[test]
fn pause_stops_a_turning_table() {
    let mut bench = Bench::calibrated();
    bench.send((TableVerb::Turn, -3000));
    bench.wait(40);
    assert_eq!(bench.execute((TableVerb::Pause, 0)), DONE);
    let stopped = bench.world.position;
    bench.wait(50);
    assert_eq!(bench.world.position, stopped);
    assert!(stopped > -30_000 && stopped < LIMIT_PLUS * TABLE_STEPS_PER_TENTH);
    bench.send((TableVerb::Turn, -3000));
    bench.wait(20);
    assert_eq!(bench.execute((TableVerb::Turn, -300)), DONE, "back, during a turn");
    assert!((bench.world.angle() + 30.0).abs() < 0.06);
}

#[test]
fn turn_waits_for_a_slow_line() {
    let mut table = Rotary::new(-1200);
    table.delay = 8;
    let mut bench = Bench::new(table);
    for angle in [-2135, -300] {
        assert_eq!(bench.execute((TableVerb::Turn, angle)), DONE);
        assert!((bench.world.angle() - f64::from(angle) / 10.0).abs() < 0.06);
    }
}

#[test]
fn failed_turn_is_an_error_and_the_next_one_calibrates_again() {
    for (fault, breakage) in [
        ("lost steps", (|t: &mut Rotary| t.slip = 4) as fn(&mut Rotary)),
        ("potentiometer", |t| t.wrong = 200.0),
        ("blocked", |t| t.blocked = true),
        ("no answer", |t| t.off = true),
        ("a counter that has lost its setting", |t| t.offset += 5_000),
    ] {
        let mut bench = Bench::calibrated();
        bench.execute((TableVerb::Turn, -1000));
        breakage(&mut bench.world);
        assert_eq!(bench.execute((TableVerb::Turn, -2135)), STUCK, "{fault}");
        assert!(!bench.memory.table.status.calibrated, "{fault}");
        bench.wait(LIMIT_TICKS as u32);
        let (good, broken) = (Rotary::new(0), &mut bench.world);
        *broken = Rotary {
            position: broken.position,
            goal: broken.position,
            offset: broken.offset,
            echo: broken.echo,
            ..good
        };
        assert_eq!(bench.execute((TableVerb::Turn, -2135)), DONE, "{fault}");
        assert!((bench.world.angle() + 213.5).abs() < 0.06, "{fault}: {}", bench.world.angle());
    }
}

#[test]
fn failed_calibration_fails_only_commands_that_need_it() {
    for breakage in [(|t: &mut Rotary| t.blocked = true) as fn(&mut Rotary), |t| t.off = true] {
        for (verb, end) in [(TableVerb::Turn, STUCK), (TableVerb::Calibrate, STUCK), (TableVerb::Pause, DONE)]
        {
            let mut table = Rotary::new(-1200);
            breakage(&mut table);
            let mut bench = Bench::new(table);
            assert_eq!(bench.execute((verb, -1000)), end, "{verb}");
            assert_eq!(bench.process.state.phase, TablePhase::Failed);
        }
    }
}

#[test]
fn failed_calibration_does_not_end_a_refused_or_missing_command() {
    for refused in [false, true] {
        let mut bench = Bench::new(Rotary { blocked: true, ..Rotary::new(-1200) });
        if refused {
            assert_eq!(bench.execute((TableVerb::Turn, 0)), (PedestalReport::CannotDo, Reason::TableLimit));
        }
        let before = bench.wait(1).status;
        let mut outputs = bench.wait(1);
        while bench.process.state.phase != TablePhase::Failed {
            outputs = bench.wait(1);
            assert_eq!((outputs.status.report, outputs.status.reason), (before.report, before.reason));
        }
        assert_eq!(outputs.motor.order, MotorOrder::Stop);
    }
}

/// A command arrives in every tick in which the calibration can fail.
#[test]
fn command_refused_during_a_failing_calibration_keeps_its_reason() {
    let misplaced = || Bench::new(Rotary { wrong: 500.0, ..Rotary::new(-1200) });
    let mut bench = misplaced();
    let failed = (1_u32..).find(|_| {
        bench.wait(1);
        bench.process.state.phase == TablePhase::Failed
    });
    for ticks in (0..4).filter_map(|before| failed?.checked_sub(before)) {
        let mut bench = misplaced();
        bench.wait(ticks);
        assert_eq!(bench.execute((TableVerb::Turn, 0)), (PedestalReport::CannotDo, Reason::TableLimit));
    }
}

#[test]
fn restarted_process_stops_the_table_and_adopts_its_calibration() {
    let mut bench = Bench::calibrated();
    bench.execute((TableVerb::Turn, -1000));
    bench.restart();
    let (before, order) = (bench.world.position, bench.memory.table.motor);
    let status = bench.wait(20).status;
    assert_eq!((status.report, status.reason), (PedestalReport::Error, Reason::Restarted));
    assert_eq!((bench.world.position, status.calibrated, status.position), (before, true, Some(-1000)));
    assert_eq!(bench.memory.table.motor, order, "a table at rest is not stopped");
    assert_eq!(bench.execute((TableVerb::Turn, -2135)), DONE);
    // After a restart during a turn, the table stops, and the same command continues the turn.
    bench.execute((TableVerb::Turn, -1500));
    let restarts = |bench: &mut Bench| {
        bench.restart();
        let status = bench.wait(30).status;
        assert_eq!((status.reason, status.calibrated), (Reason::Restarted, true));
        let stopped = bench.world.position;
        assert_eq!((bench.wait(50).status.reason, bench.world.position), (Reason::Restarted, stopped));
    };
    bench.sent_again(
        |bench| bench.send((TableVerb::Turn, -300)),
        &[restarts],
        |bench| {
            assert_eq!(bench.finish(), DONE);
            assert!((bench.world.angle() + 30.0).abs() < 0.06, "{}", bench.world.angle());
        },
    );
}

#[test]
fn restarted_process_rejects_a_contradicted_calibration() {
    for breakage in [
        (|b: &mut Bench| b.world.wrong = 200.0) as fn(&mut Bench),
        |b| b.world.offset += 5_000,
        |b| b.memory.table.at_limit = None,
        |b| b.world.off = true,
    ] {
        let mut bench = Bench::calibrated();
        bench.execute((TableVerb::Turn, -1000));
        breakage(&mut bench);
        bench.restart();
        bench.world.runs_on = bench.world.off;
        let status = bench.wait(LIMIT_TICKS as u32 + 10).status;
        assert_eq!((status.calibrated, status.position), (false, None));
        assert_eq!(bench.memory.table.at_limit, None);
        assert_eq!(bench.process.state.phase, TablePhase::Deferred);
        assert_eq!(bench.execute((TableVerb::Pause, 0)), DONE);
        (bench.world.off, bench.world.runs_on, bench.world.wrong) = (false, false, 0.0);
        assert_eq!(bench.execute((TableVerb::Turn, -2135)), DONE);
        assert!((bench.world.angle() + 213.5).abs() < 0.06);
    }
}

#[test]
fn contradicted_angle_is_not_published() {
    let mut bench = Bench::calibrated();
    bench.execute((TableVerb::Turn, -1000));
    bench.world.wrong = 100.0;
    let status = bench.wait(5).status;
    assert_eq!((status.position, status.calibrated), (None, true));
    bench.world.wrong = 0.0;
    assert_eq!(bench.step().status.position, Some(-1000));
}

#[test]
fn every_row_fires() {
    let silent = silent::<Table, ()>(&[
        calibrate_command_calibrates_again,
        angle_beyond_the_limits_is_refused,
        pause_stops_a_turning_table,
        failed_turn_is_an_error_and_the_next_one_calibrates_again,
        failed_calibration_fails_only_commands_that_need_it,
        restarted_process_stops_the_table_and_adopts_its_calibration,
        restarted_process_rejects_a_contradicted_calibration,
    ]);
    assert_eq!(silent, [""; 0]);
}

#[test]
fn table_that_never_stops_is_stuck() {
    for (verb, end) in [(TableVerb::Turn, STUCK), (TableVerb::Pause, STUCK)] {
        let mut bench = Bench::calibrated();
        bench.execute((TableVerb::Turn, -300));
        bench.world.runs_on = true;
        assert_eq!(bench.execute((verb, -1000)), end, "{verb}");
    }
}

#[test]
fn calibration_continues_during_a_refusal() {
    let mut bench = Bench::new(Rotary::new(-1200));
    assert_eq!(bench.execute((TableVerb::Turn, 0)), (PedestalReport::CannotDo, Reason::TableLimit));
    let status = bench.wait(600).status;
    assert_eq!((status.calibrated, status.position), (true, Some(LIMIT_PLUS)));
    assert_eq!((status.report, status.reason), (PedestalReport::CannotDo, Reason::TableLimit));
}

proptest! {
    /// The table reaches any angle from any other to 0.06 degree, over lines of any delay, and two runs give the same
    /// bytes. At 25 steps per tick the whole travel takes 1360 of the 1500 ticks permitted for a turn.
    #[test]
    fn turns(
        start in LIMIT_MINUS..=AT_LIMIT,
        delay in 0_u8..12,
        speed in 25_i32..400,
        angles in prop::collection::vec(LIMIT_MINUS..=LIMIT_PLUS, 1..6),
    ) {
        let run = || {
            let mut table = Rotary::new(start);
            (table.delay, table.speed) = (delay, speed);
            let mut bench = Bench::new(table);
            let mut images = Vec::new();
            for angle in &angles {
                prop_assert_eq!(bench.execute((TableVerb::Turn, *angle)), DONE);
                prop_assert!((bench.world.angle() - f64::from(*angle) / 10.0).abs() < 0.06);
                images.push(bench.image());
            }
            Ok(images)
        };
        prop_assert_eq!(run()?, run()?);
    }

    /// Random commands and sensors cause no panic, and every order has its own number.
    #[test]
    fn nonsense(ticks in prop::collection::vec((0_u8..30, any::<i32>(), any::<u32>()), 1..200)) {
        let mut bench = Bench::new(Rotary::new(-1200));
        let mut last = MotorCommand::default();
        for (what, a, b) in ticks {
            if let Some(verb) = TableVerb::from_code(what) {
                bench.send((verb, a));
            }
            match what {
                10 => bench.restart(),
                11 => bench.world.off = !bench.world.off,
                12 => bench.world.blocked = !bench.world.blocked,
                13 => bench.world.offset = a / 4,
                14 => bench.world.echo = b,
                _ => {}
            }
            let motor = bench.step().motor;
            prop_assert!(motor.number == 0 || motor == last || motor.number != last.number);
            last = motor;
        }
    }
}
