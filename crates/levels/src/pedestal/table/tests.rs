//! Scenarios of the table process with a simulated rotary table.

use interfaces::{
    CommonMemory, ExternalInputs, Reason, TableOutputs,
    device::{MotorCommand, MotorOrder, PedestalSensors, TABLE_STEPS_PER_TENTH},
    pedestal::{PedestalReport, TableCommand, TableVerb},
    process::{Inputs, Process},
};
use proptest::prelude::*;
use rcs_core::{Plain, plain::to_bytes, tick::Tick};

use super::{
    LIMIT_MINUS, LIMIT_PLUS, State, Table,
    preprocess::{AT_LIMIT, LIMIT_TICKS},
    tables::{Phase, TABLES},
};
use crate::coverage::Coverage;

/// Motor, controller, switches and potentiometer.
#[derive(Clone, Debug)]
pub struct Rotary {
    /// Steps; 0 where the calibrated counter is 0.
    pub position: i32,
    goal: i32,
    offset: i32,
    echo: u32,
    /// Steps a tick.
    pub speed: i32,
    /// Ticks that an order needs on the line.
    pub delay: u8,
    waiting: (MotorCommand, u8),
    /// Steps lost in each tick of a turn.
    pub slip: i32,
    /// The table is blocked.
    pub blocked: bool,
    /// The controller takes no orders.
    pub off: bool,
    /// The motor does not stop, whatever it is told.
    pub runs_on: bool,
    /// Counts that the potentiometer is wrong by.
    pub wrong: f64,
}

impl Rotary {
    /// A table that was left at an angle, 0.1 degree.
    pub fn new(angle: i32) -> Self {
        let position = angle * TABLE_STEPS_PER_TENTH;
        Self {
            position,
            goal: position,
            offset: -position,
            echo: 57,
            speed: 120,
            delay: 0,
            waiting: (MotorCommand::default(), 0),
            slip: 0,
            blocked: false,
            off: false,
            runs_on: false,
            wrong: 0.0,
        }
    }

    /// One tick.
    pub fn advance(&mut self, command: &MotorCommand) {
        if command.number != self.waiting.0.number {
            self.waiting = (*command, self.delay);
        } else {
            self.waiting.1 = self.waiting.1.saturating_sub(1);
        }
        let (order, wait) = self.waiting;
        if wait == 0 && order.number != 0 && order.number != self.echo && !self.off {
            self.echo = order.number;
            match order.order {
                MotorOrder::None => {}
                MotorOrder::Turn => self.goal = self.position + order.steps,
                MotorOrder::SetCounter => self.offset = order.steps - self.position,
                MotorOrder::Stop => self.goal = self.position,
            }
        }
        if self.blocked {
            return;
        }
        let way = (self.goal - self.position).clamp(-self.speed, self.speed);
        self.position += way;
        if way != 0 {
            self.position -= self.slip;
            self.offset += self.slip;
            self.goal -= self.slip;
        }
        // A switch stops the motor a few steps late, and lets it run away from it.
        if way > 0 && self.at_plus() {
            self.position = AT_LIMIT * TABLE_STEPS_PER_TENTH + 2;
            self.goal = self.position;
        }
        if way < 0 && self.at_minus() {
            self.goal = self.position;
        }
    }

    fn at_plus(&self) -> bool {
        self.position >= AT_LIMIT * TABLE_STEPS_PER_TENTH
    }

    fn at_minus(&self) -> bool {
        self.position <= (LIMIT_MINUS - 50) * TABLE_STEPS_PER_TENTH
    }

    /// Degrees on the calibrated counter.
    pub fn angle(&self) -> f64 {
        f64::from(self.position) / f64::from(10 * TABLE_STEPS_PER_TENTH)
    }

    /// Words of table and motor; those of the hand stay.
    pub fn sense(&self, sensors: &mut PedestalSensors) {
        let counts = 3950.0 + self.angle() * 10.0 * 180.0 / 183.5 + self.wrong;
        sensors.table_potentiometer = counts.round().clamp(0.0, 4095.0) as u16;
        (sensors.limit_plus, sensors.limit_minus) = (self.at_plus(), self.at_minus());
        (sensors.motor_echo, sensors.motor_moving) = (self.echo, self.runs_on || self.goal != self.position);
        sensors.motor_counter = self.position + self.offset;
    }
}

/// Process, buffers and plant.
struct Bench {
    process: Table,
    memory: CommonMemory,
    external: ExternalInputs,
    table: Rotary,
    tick: Tick,
    rows: Coverage,
}

impl Bench {
    fn new(table: Rotary) -> Self {
        let mut bench = Self {
            process: Table::default(),
            memory: CommonMemory::default(),
            external: ExternalInputs::default(),
            table,
            tick: Tick::BEFORE_START,
            rows: Coverage::default(),
        };
        bench.step();
        bench
    }

    /// A bench with a calibrated table.
    fn calibrated() -> Self {
        let mut bench = Self::new(Rotary::new(-1200));
        assert_eq!(bench.execute(TableVerb::Calibrate, 0), DONE);
        bench
    }

    fn send(&mut self, command: TableVerb, angle: i32) {
        let number = self.memory.pedestal.table.number + 1;
        self.memory.pedestal.table = TableCommand { number, command, angle };
    }

    fn step(&mut self) -> TableOutputs {
        self.tick = self.tick.next();
        self.table.sense(&mut self.external.devices.pedestal);
        let mut outputs = self.memory.table;
        let inputs = Inputs { tick: self.tick, memory: &self.memory, external: &self.external, data: &() };
        self.process.step(&inputs, &mut outputs);
        self.rows.note(&outputs.header);
        self.table.advance(&outputs.motor);
        self.memory.table = outputs;
        outputs
    }

    fn wait(&mut self, ticks: u32) -> TableOutputs {
        (0..ticks).for_each(|_| {
            self.step();
        });
        self.memory.table
    }

    fn execute(&mut self, command: TableVerb, angle: i32) -> (PedestalReport, Reason) {
        self.send(command, angle);
        self.finish()
    }

    fn finish(&mut self) -> (PedestalReport, Reason) {
        for _ in 0..3 * LIMIT_TICKS {
            let status = self.step().status;
            assert_eq!(status.echo, self.memory.pedestal.table.number);
            if status.report != PedestalReport::Executing {
                return (status.report, status.reason);
            }
        }
        panic!("no end at tick {}: {:?}", self.tick, self.process.state);
    }
}

const DONE: (PedestalReport, Reason) = (PedestalReport::Done, Reason::None);
const STUCK: (PedestalReport, Reason) = (PedestalReport::Error, Reason::TableStuck);

#[test]
fn a_table_that_is_booted_calibrates_itself() {
    for start in [-3400, -1200, -210, LIMIT_PLUS, -5, AT_LIMIT] {
        let mut bench = Bench::new(Rotary::new(start));
        let status = bench.wait(600).status;
        assert_eq!(
            (status.calibrated, status.report, status.reason),
            (true, PedestalReport::Idle, Reason::None)
        );
        assert_eq!((status.position, status.echo), (Some(LIMIT_PLUS), 0));
        assert!((bench.table.angle() + 20.0).abs() < 0.05, "{}", bench.table.angle());
        let order = bench.memory.table.motor;
        assert_eq!(bench.wait(100).motor, order, "once is enough");
    }
}

#[test]
fn angles_are_reached_and_reported() {
    let mut bench = Bench::calibrated();
    for angle in [-2135, -300, -235, LIMIT_MINUS, LIMIT_PLUS, -1000, -1000, -1001] {
        assert_eq!(bench.execute(TableVerb::Turn, angle), DONE, "{angle}");
        assert!(
            (bench.table.angle() - f64::from(angle) / 10.0).abs() < 0.06,
            "{angle}: {}",
            bench.table.angle()
        );
        assert_eq!(bench.memory.table.status.position, Some(angle));
    }
}

#[test]
fn angles_beyond_the_limits_cannot_be_done() {
    let mut bench = Bench::calibrated();
    for angle in [LIMIT_PLUS + 1, LIMIT_MINUS - 1, 1600, i32::MAX, i32::MIN] {
        let before = bench.table.position;
        assert_eq!(bench.execute(TableVerb::Turn, angle), (PedestalReport::CannotDo, Reason::TableLimit));
        assert_eq!((bench.table.position, bench.memory.table.status.calibrated), (before, true));
    }
    assert_eq!(bench.execute(TableVerb::None, 0), (PedestalReport::CannotDo, Reason::UnknownCommand));
}

#[test]
fn a_turn_before_the_calibration_is_made_after_it() {
    let mut bench = Bench::new(Rotary::new(-1200));
    bench.wait(4);
    assert_eq!(bench.execute(TableVerb::Turn, -2135), DONE);
    assert!((bench.table.angle() + 213.5).abs() < 0.06);
    let mut bench = Bench::new(Rotary::new(-1200));
    assert_eq!(bench.execute(TableVerb::Pause, 0), DONE, "PAUSE waits as well");
    assert!(bench.memory.table.status.calibrated);
}

#[test]
fn pause_stops_a_turning_table_and_a_new_turn_starts_from_rest() {
    let mut bench = Bench::calibrated();
    bench.send(TableVerb::Turn, -3000);
    bench.wait(40);
    assert_eq!(bench.execute(TableVerb::Pause, 0), DONE);
    let stopped = bench.table.position;
    bench.wait(50);
    assert_eq!(bench.table.position, stopped);
    assert!(stopped > -30_000 && stopped < LIMIT_PLUS * TABLE_STEPS_PER_TENTH);
    bench.send(TableVerb::Turn, -3000);
    bench.wait(20);
    assert_eq!(bench.execute(TableVerb::Turn, -300), DONE, "back, out of the middle of a turn");
    assert!((bench.table.angle() + 30.0).abs() < 0.06);
}

#[test]
fn a_slow_line_is_waited_for() {
    let mut table = Rotary::new(-1200);
    table.delay = 8;
    let mut bench = Bench::new(table);
    for angle in [-2135, -300] {
        assert_eq!(bench.execute(TableVerb::Turn, angle), DONE);
        assert!((bench.table.angle() - f64::from(angle) / 10.0).abs() < 0.06);
    }
}

#[test]
fn what_keeps_the_table_from_its_angle_is_an_error_and_the_next_turn_calibrates_again() {
    for (fault, breakage) in [
        ("lost steps", (|t: &mut Rotary| t.slip = 4) as fn(&mut Rotary)),
        ("potentiometer", |t| t.wrong = 200.0),
        ("blocked", |t| t.blocked = true),
        ("no answer", |t| t.off = true),
        ("a counter that has lost its setting", |t| t.offset += 5_000),
    ] {
        let mut bench = Bench::calibrated();
        bench.execute(TableVerb::Turn, -1000);
        breakage(&mut bench.table);
        assert_eq!(bench.execute(TableVerb::Turn, -2135), STUCK, "{fault}");
        assert!(!bench.memory.table.status.calibrated, "{fault}");
        bench.wait(LIMIT_TICKS as u32);
        let (good, broken) = (Rotary::new(0), &mut bench.table);
        *broken = Rotary {
            position: broken.position,
            goal: broken.position,
            offset: broken.offset,
            echo: broken.echo,
            ..good
        };
        assert_eq!(bench.execute(TableVerb::Turn, -2135), DONE, "{fault}");
        assert!((bench.table.angle() + 213.5).abs() < 0.06, "{fault}: {}", bench.table.angle());
    }
}

#[test]
fn a_calibration_that_fails_fails_the_command_that_needs_it_and_no_other() {
    for breakage in [(|t: &mut Rotary| t.blocked = true) as fn(&mut Rotary), |t| t.off = true] {
        for (verb, end) in [(TableVerb::Turn, STUCK), (TableVerb::Calibrate, STUCK), (TableVerb::Pause, DONE)]
        {
            let mut table = Rotary::new(-1200);
            breakage(&mut table);
            let mut bench = Bench::new(table);
            assert_eq!(bench.execute(verb, -1000), end, "{verb}");
            assert_eq!(bench.process.state.phase, Phase::Failed);
        }
    }
}

#[test]
fn a_calibration_that_fails_does_not_count_for_a_refused_command_nor_for_none() {
    for refused in [false, true] {
        let mut bench = Bench::new(Rotary { blocked: true, ..Rotary::new(-1200) });
        if refused {
            assert_eq!(bench.execute(TableVerb::Turn, 0), (PedestalReport::CannotDo, Reason::TableLimit));
        }
        let before = bench.wait(1).status;
        let mut outputs = bench.wait(1);
        while bench.process.state.phase != Phase::Failed {
            outputs = bench.wait(1);
            assert_eq!((outputs.status.report, outputs.status.reason), (before.report, before.reason));
        }
        assert_eq!(outputs.motor.order, MotorOrder::Stop);
    }
}

/// Whatever the tick in which the calibration is given up.
#[test]
fn a_command_that_is_refused_while_a_calibration_fails_keeps_its_reason() {
    let astray = || Bench::new(Rotary { wrong: 500.0, ..Rotary::new(-1200) });
    let mut bench = astray();
    let failed = (1_u32..).find(|_| {
        bench.wait(1);
        bench.process.state.phase == Phase::Failed
    });
    for ticks in (0..4).filter_map(|before| failed?.checked_sub(before)) {
        let mut bench = astray();
        bench.wait(ticks);
        assert_eq!(bench.execute(TableVerb::Turn, 0), (PedestalReport::CannotDo, Reason::TableLimit));
    }
}

#[test]
fn a_restarted_process_stops_the_table_and_adopts_its_calibration() {
    let mut bench = Bench::calibrated();
    bench.execute(TableVerb::Turn, -1000);
    bench.process = Table::default();
    let (before, order) = (bench.table.position, bench.memory.table.motor);
    let status = bench.wait(20).status;
    assert_eq!((status.report, status.reason), (PedestalReport::Error, Reason::Restarted));
    assert_eq!((bench.table.position, status.calibrated, status.position), (before, true, Some(-1000)));
    assert_eq!(bench.memory.table.motor, order, "a table that stands is not stopped");
    assert_eq!(bench.execute(TableVerb::Turn, -2135), DONE);
    // In the middle of a turn: it stops, and the same command goes on.
    for later in [1, 2, 3, 20, 60] {
        bench.execute(TableVerb::Turn, -3000);
        bench.send(TableVerb::Turn, -300);
        bench.wait(later);
        bench.process = Table::default();
        let status = bench.wait(30).status;
        assert_eq!((status.reason, status.calibrated), (Reason::Restarted, true), "{later}");
        let stopped = bench.table.position;
        assert_eq!((bench.wait(50).status.reason, bench.table.position), (Reason::Restarted, stopped));
        assert_eq!(bench.execute(TableVerb::Turn, -300), DONE);
        assert!((bench.table.angle() + 30.0).abs() < 0.06, "{later}");
    }
}

#[test]
fn a_restarted_process_adopts_no_calibration_that_the_sensors_deny() {
    for breakage in [
        (|b: &mut Bench| b.table.wrong = 200.0) as fn(&mut Bench),
        |b| b.table.offset += 5_000,
        |b| b.memory.table.at_limit = None,
        |b| b.table.off = true,
    ] {
        let mut bench = Bench::calibrated();
        bench.execute(TableVerb::Turn, -1000);
        breakage(&mut bench);
        bench.process = Table::default();
        bench.table.runs_on = bench.table.off;
        let status = bench.wait(LIMIT_TICKS as u32 + 10).status;
        assert_eq!((status.calibrated, status.position), (false, None));
        assert_eq!(bench.memory.table.at_limit, None);
        assert_eq!(bench.process.state.phase, Phase::Deferred);
        assert_eq!(bench.execute(TableVerb::Pause, 0), DONE);
        (bench.table.off, bench.table.runs_on, bench.table.wrong) = (false, false, 0.0);
        assert_eq!(bench.execute(TableVerb::Turn, -2135), DONE);
        assert!((bench.table.angle() + 213.5).abs() < 0.06);
    }
}

#[test]
fn an_angle_that_the_potentiometer_denies_is_not_published_until_it_agrees() {
    let mut bench = Bench::calibrated();
    bench.execute(TableVerb::Turn, -1000);
    bench.table.wrong = 100.0;
    let status = bench.wait(5).status;
    assert_eq!((status.position, status.calibrated), (None, true));
    bench.table.wrong = 0.0;
    assert_eq!(bench.step().status.position, Some(-1000));
}

#[test]
fn every_row_fires() {
    let mut bench = Bench::calibrated();
    // REST 3 to 5, TURN 2 to 4, PAUSE 1, CALIBRATE 2, 9: a calibration for a turn.
    bench.table.delay = 3;
    bench.execute(TableVerb::Turn, -1000);
    bench.send(TableVerb::Turn, -3000);
    bench.wait(20);
    bench.execute(TableVerb::Turn, -1000);
    bench.send(TableVerb::Turn, -3000);
    bench.wait(20);
    bench.execute(TableVerb::Pause, 0);
    bench.table.slip = 4;
    bench.execute(TableVerb::Turn, -300);
    bench.table.slip = 0;
    bench.execute(TableVerb::Turn, -300);
    // REST 2: the motor turns for ever.
    for verb in [TableVerb::Turn, TableVerb::Pause] {
        bench.execute(TableVerb::Turn, -300);
        bench.table.runs_on = true;
        bench.execute(verb, -1000);
        bench.table.runs_on = false;
    }
    // A table that does not answer: TURN 1, CALIBRATE 10.
    bench.execute(TableVerb::Turn, -1000);
    bench.table.off = true;
    bench.execute(TableVerb::Turn, -300);
    bench.execute(TableVerb::Turn, -300);
    bench.table.off = false;
    // CALIBRATE 10, 11: it stops before the limit; it never stops, while no command needs it.
    bench.send(TableVerb::Calibrate, 0);
    bench.wait(10);
    bench.table.goal = bench.table.position;
    bench.finish();
    bench.table.speed = 0;
    bench.send(TableVerb::Calibrate, 0);
    bench.wait(10);
    bench.execute(TableVerb::Pause, 0);
    // ACCEPT 2, 3, EXECUTE 2, CALIBRATE 1.
    bench.execute(TableVerb::Turn, 0);
    bench.execute(TableVerb::None, 0);
    // CALIBRATE 6 to 9: restarted in the middle of a turn, and with a counter that was never set.
    bench.table.speed = 120;
    bench.execute(TableVerb::Calibrate, 0);
    bench.send(TableVerb::Turn, -3000);
    bench.wait(20);
    bench.process = Table::default();
    bench.wait(20);
    bench.table.offset += 5_000;
    bench.process = Table::default();
    bench.wait(20);
    assert_eq!(bench.rows.missing(TABLES), [""; 0]);
}

#[test]
fn a_calibration_goes_on_beside_a_command_that_is_refused() {
    let mut bench = Bench::new(Rotary::new(-1200));
    assert_eq!(bench.execute(TableVerb::Turn, 0), (PedestalReport::CannotDo, Reason::TableLimit));
    let status = bench.wait(600).status;
    assert_eq!((status.calibrated, status.position), (true, Some(LIMIT_PLUS)));
    assert_eq!((status.report, status.reason), (PedestalReport::CannotDo, Reason::TableLimit));
}

/// From every state, with a table that turns, one that is blocked, one that takes no orders and one that
/// never stops, at the limits, between them, and with a counter and a potentiometer that deny each other.
#[test]
fn every_command_ends_from_every_state_whether_the_table_obeys_or_not() {
    let worlds: [fn(&mut Rotary); 5] =
        [|_| {}, |t| t.blocked = true, |t| t.off = true, |t| t.runs_on = true, |t| t.slip = 4];
    let mut ends = [0; 2];
    for phase in Phase::ALL {
        for step in super::tables::Step::ALL {
            for world in worlds {
                for (angle, at_limit) in
                    [(-3400, Some(3950)), (-1000, Some(3950)), (-200, Some(100)), (0, None)]
                {
                    for verb in TableVerb::ALL {
                        let mut bench = Bench::new(Rotary { offset: 0, ..Rotary::new(angle) });
                        world(&mut bench.table);
                        bench.process.state =
                            State { phase: *phase, step: *step, at_limit, ..bench.process.state };
                        let (report, reason) = bench.execute(*verb, -2135);
                        let done = report == PedestalReport::Done;
                        assert_eq!(done, reason == Reason::None, "{verb} in {phase} {step}");
                        ends[usize::from(done)] += 1;
                    }
                }
            }
        }
    }
    assert!(ends.iter().all(|count| *count > 100), "{ends:?}");
}

proptest! {
    /// From any angle to any other, over lines of any delay: reached to 0.06 degree, and the same bits twice.
    /// At 25 steps a tick the whole way takes 1360 of the 1500 ticks that a turn has.
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
                prop_assert_eq!(bench.execute(TableVerb::Turn, *angle), DONE);
                prop_assert!((bench.table.angle() - f64::from(*angle) / 10.0).abs() < 0.06);
                images.push(to_bytes::<80, _>(&bench.memory.table));
            }
            Ok(images)
        };
        prop_assert_eq!(run()?, run()?);
    }

    /// Whatever is commanded and whatever the sensors read: no panic, and every order has a number of its
    /// own.
    #[test]
    fn nonsense(ticks in prop::collection::vec((0_u8..30, any::<i32>(), any::<u32>()), 1..200)) {
        let mut bench = Bench::new(Rotary::new(-1200));
        let mut last = MotorCommand::default();
        for (what, a, b) in ticks {
            if let Some(verb) = TableVerb::from_code(what) {
                bench.send(verb, a);
            }
            match what {
                10 => bench.process = Table::default(),
                11 => bench.table.off = !bench.table.off,
                12 => bench.table.blocked = !bench.table.blocked,
                13 => bench.table.offset = a / 4,
                14 => bench.table.echo = b,
                _ => {}
            }
            let motor = bench.step().motor;
            prop_assert!(motor.number == 0 || motor == last || motor.number != last.number);
            last = motor;
        }
        prop_assert!(State::SIZE < 192 && TableOutputs::SIZE <= 144);
    }
}
