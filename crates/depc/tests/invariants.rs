//! Ten thousand seeded plans of any faults. Always: no step exceeds the limits; the host reports a stopped controller;
//! once the line is repaired and the operator has answered, the goal is reached.
//!
//! Unless the line deceives one end: no command is executed twice or lost silently, every report is true, and the
//! limits give no warning. These cases deceive an end, and are counted: two changes of the same bit, which a checksum
//! by exclusive or does not detect; changes in ACK, NAK, cancel and restart, which have no checksum (A 2.3); and a long
//! stall, which delivers commands that the host has given up. `DEPC_SCHEDULES` sets the number of plans.

#![expect(clippy::print_stdout, reason = "the figures of a campaign are printed")]

mod session;

use depc::{
    fault::{Counts, Direction, FaultKind, Numbers, Plan, Rule},
    host::Host,
};
use session::{Session, Truth};

const SCHEDULES: u64 = 10_000; // in an ordinary run
const FAULTY_TICKS: u64 = 120; // with faults
const RECOVERY_TICKS: u32 = 300; // two answers of the operator, a stalled line, and the motion to the goal

fn rule(numbers: &mut Numbers) -> Rule {
    let kinds = u32::try_from(FaultKind::ALL.len()).unwrap();
    let kind = FaultKind::ALL[numbers.below(kinds) as usize];
    let mut rule = Rule::new(kind);
    match numbers.below(4) {
        0 => rule = rule.only(Direction::ToHost),
        1 => rule = rule.only(Direction::ToController),
        _ => {}
    }
    let from = u64::from(numbers.below(100));
    rule = match numbers.below(4) {
        0 => rule.at(from),
        1 => rule.window(from, from + 1 + u64::from(numbers.below(20))),
        2 => rule.window(from, FAULTY_TICKS).rate(1 + numbers.below(300_000)),
        _ => rule.window(0, FAULTY_TICKS).rate(1 + numbers.below(30_000)),
    };
    if numbers.below(2) == 0 {
        rule = rule.ticks(u16::try_from(1 + numbers.below(10)).unwrap());
    }
    if kind == FaultKind::Insert && numbers.below(2) == 0 {
        let bytes = [0x03, 0x05, 0x06, 0x15, 0x18, 0xFF, 0x41, 0x00];
        rule = rule.byte(bytes[numbers.below(8) as usize]);
    }
    rule
}

fn plan(seed: u64) -> (Plan, u64) {
    let mut numbers = Numbers::new(seed, 2);
    let (mut plan, mut refused) = (Plan::new(seed), 0);
    let rules = 1 + numbers.below(4);
    while plan.rules().len() < rules as usize {
        refused += u64::from(plan.add(rule(&mut numbers)).is_err());
    }
    (plan, refused)
}

#[derive(Default)]
struct Sum {
    schedules: u64,
    ticks: u64,
    refused: u64,
    deceived: u64,
    counts: Counts,
    truth: Truth,
    frames: u64,
    acknowledged: u64,
    naks: u64,
    restarts: u64,
    executed: u64,
}

impl Sum {
    fn add(&mut self, session: &Session, refused: u64) {
        self.schedules += 1;
        self.ticks += session.tick;
        self.refused += refused;
        self.deceived += u64::from(session.truth.deceptions() > 0);
        self.counts = self.counts.plus(&session.injector.total());
        self.truth.add(&session.truth);
        let counters = Host::counters(&session.host);
        self.frames += u64::from(counters.frames);
        self.acknowledged += u64::from(counters.acknowledged);
        self.naks += u64::from(counters.naks);
        self.restarts += u64::from(counters.restarts);
        self.executed += session.executed.len() as u64;
    }

    fn merge(mut self, other: &Self) -> Self {
        self.schedules += other.schedules;
        self.ticks += other.ticks;
        self.refused += other.refused;
        self.deceived += other.deceived;
        self.counts = self.counts.plus(&other.counts);
        self.truth.add(&other.truth);
        self.frames += other.frames;
        self.acknowledged += other.acknowledged;
        self.naks += other.naks;
        self.restarts += other.restarts;
        self.executed += other.executed;
        self
    }

    fn print(&self) {
        println!("fault plans        {:>10}   ({} rules refused on the way)", self.schedules, self.refused);
        println!("ticks              {:>10}", self.ticks);
        println!("bytes sent         {:>10}   arrived {}", self.counts.sent, self.counts.arrived);
        println!("data frames        {:>10}   acknowledged {}", self.frames, self.acknowledged);
        println!(
            "commands executed  {:>10}   NAKs {}   restarts {}",
            self.executed, self.naks, self.restarts
        );
        println!("faults injected    {:>10}", self.counts.faults());
        for kind in FaultKind::ALL {
            println!("  {:<16} {:>10}", kind.text(), self.counts.of(*kind));
        }
        println!("warnings           {:>10}", self.truth.warnings);
        println!("sessions deceived  {:>10}   {:?}", self.deceived, self.truth);
    }
}

fn run(seed: u64, sum: &mut Sum) {
    let (plan, refused) = plan(seed);
    let mut session = Session::new(seed, &plan);
    for tick in 0..FAULTY_TICKS {
        if tick % 40 == 0 {
            session.new_goal();
        }
        session.tick();
    }
    session.new_goal();
    session.until_reached(RECOVERY_TICKS);
    let truth = session.truth;
    assert!(truth.deceptions() > 0 || truth.velocity_warnings == 0, "{truth:?}");
    sum.add(&session, refused);
}

#[test]
fn ten_thousand_plans_of_faults() {
    let schedules = std::env::var("DEPC_SCHEDULES").ok().map_or(SCHEDULES, |text| {
        text.parse().unwrap_or_else(|_| panic!("DEPC_SCHEDULES: expected a number, found {text:?}"))
    });
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get() as u64);
    let part = |first: u64| {
        let mut sum = Sum::default();
        for seed in (first..schedules).step_by(threads as usize) {
            let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| run(seed, &mut sum)));
            assert!(outcome.is_ok(), "seed {seed}: {:?}", plan(seed).0.rules());
        }
        sum
    };
    let sum = std::thread::scope(|scope| {
        let parts: Vec<_> = (0..threads).map(|first| scope.spawn(move || part(first))).collect();
        parts.into_iter().map(|part| part.join().unwrap()).fold(Sum::default(), |sum, part| sum.merge(&part))
    });
    sum.print();
    assert_eq!(sum.schedules, schedules);
    for kind in FaultKind::ALL {
        assert!(sum.counts.of(*kind) > schedules / 10, "hardly any {}", kind.text());
    }
    assert!(sum.deceived * 20 < schedules, "{} sessions deceived", sum.deceived);
    assert!(sum.executed > 20 * schedules && sum.naks > 0 && sum.truth.warnings > 0);
}
