//! With one fault per tick and direction the checksums detect every fault: no jumps, no command executed twice or lost
//! silently, no warning, and the link recovers by itself.

mod session;

use depc::link::LinkFault;
use depc::{
    controller::{ControllerState, Warning},
    fault::{Direction, FaultKind, Plan, Rule},
};
use session::{Session, Truth};

/// Bytes lost, changed, duplicated and late, truncated frames, and noise that is not a command.
fn one_fault_a_tick(seed: u64) -> Plan {
    let mut plan = Plan::new(seed).most_per_tick(1);
    for rule in [
        Rule::new(FaultKind::Drop).rate(4_000),
        Rule::new(FaultKind::Flip).rate(4_000),
        Rule::new(FaultKind::Delay).rate(4_000),
        Rule::new(FaultKind::Duplicate).rate(1_000),
        Rule::new(FaultKind::Truncate).rate(10_000),
        // Noise causes a NAK. With a lost ACK the host would repeat an executed command: two faults.
        Rule::new(FaultKind::Insert).rate(10_000).byte(0x41).only(Direction::ToHost),
    ] {
        plan.add(rule).unwrap();
    }
    plan
}

#[test]
fn line_without_faults_carries_one_command_per_tick() {
    let mut session = Session::new(1, &Plan::new(1));
    session.tick();
    session.new_goal();
    for _ in 0..100 {
        session.tick();
    }
    let counters = session.host.counters();
    assert_eq!((counters.frames, counters.acknowledged, counters.restarts), (100, 99, 0));
    assert_eq!(session.executed, (1..=99).collect::<Vec<u16>>());
    assert_eq!(session.host.fault(), LinkFault::None);
}

#[test]
fn faults_cause_no_jump_and_no_repetition_and_the_link_recovers() {
    for seed in 0..20 {
        let mut session = Session::new(seed, &one_fault_a_tick(seed));
        for tick in 0..5000 {
            if tick % 30 == 0 {
                session.new_goal();
            }
            session.tick();
            assert_eq!(session.controller.warning(), Warning::None, "seed {seed} tick {tick}");
            assert_eq!(session.controller.state(), ControllerState::Running, "seed {seed} tick {tick}");
        }
        let started = session.truth.started;
        assert_eq!(session.truth, Truth { started, ..Truth::default() }, "seed {seed}");
        let (counters, counts) = (*session.host.counters(), session.injector.total());
        assert!(counts.faults() > 400 && counts.overflowed == 0, "seed {seed}: {counts:?}");
        assert!(
            counters.naks > 0 && counters.retries > 0 && counters.timeouts > 0,
            "seed {seed}: {counters:?}"
        );
        assert!(started > 20 && session.robot.moves > 1000, "seed {seed}: {} moves", session.robot.moves);
    }
}

#[test]
fn the_same_seed_gives_the_same_session() {
    let run = |seed| {
        let mut session = Session::new(seed, &one_fault_a_tick(seed));
        session.new_goal();
        for _ in 0..500 {
            session.tick();
        }
        (session.host, session.controller, session.injector, session.executed)
    };
    assert_eq!(run(3), run(3));
    assert_ne!(run(3).3, run(4).3);
}
