//! Nothing is allocated in a tick: counted, with everything that the executive does in one.
//!
//! This is also what keeps iceoryx2 in its place: another version, or another messaging pattern, that allocates
//! when a value is written or read fails here (publish-subscribe of 0.10 allocates once a message).
//!
//! This file holds one test only, because all of it runs on the counting allocator.

use executive::{
    alloc::{self, Counting, Section},
    memory::{Attached, Publisher, RunName},
    runner::{Levels, Runner},
};
use levels::ladder::PROCESS_COUNT;
use rcs_core::{
    interface::{CommonMemory, ExternalInputs, Header, Reason},
    tick::Tick,
};

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Fails every tenth tick and recovers, so that the watch for failures has work.
#[derive(Clone)]
struct Failing;

impl Levels<()> for Failing {
    fn step(
        &mut self,
        tick: Tick,
        before: &CommonMemory,
        _: &ExternalInputs,
        _: &(),
        after: &mut CommonMemory,
    ) {
        *after = *before;
        for header in headers(after) {
            header.stamp = tick;
        }
        after.grip.status.reason = if tick.0 % 10 < 5 { Reason::GraspMissed } else { Reason::None };
        after.emove.status.reason = before.grip.status.reason;
    }
}

fn headers(memory: &mut CommonMemory) -> [&mut Header; PROCESS_COUNT] {
    [
        &mut memory.task.header,
        &mut memory.subtask.header,
        &mut memory.emove.header,
        &mut memory.prim.header,
        &mut memory.t3i.header,
        &mut memory.quick_change.header,
        &mut memory.grip.header,
        &mut memory.v_grip.header,
        &mut memory.tool_grip.header,
        &mut memory.pedestal.header,
        &mut memory.hand.header,
        &mut memory.table.header,
    ]
}

/// Allocates in every hundredth tick.
struct Careless;

impl Levels<()> for Careless {
    fn step(
        &mut self,
        tick: Tick,
        before: &CommonMemory,
        _: &ExternalInputs,
        _: &(),
        after: &mut CommonMemory,
    ) {
        *after = *before;
        after.task.header.stamp = tick;
        if tick.0.is_multiple_of(100) {
            drop(std::hint::black_box(vec![1_u8]));
        }
    }
}

#[test]
fn a_tick_does_not_allocate_and_one_that_does_is_noticed() {
    assert!(alloc::is_installed());
    let before = alloc::allocations();
    drop(std::hint::black_box(Box::new(1)));
    assert_eq!(alloc::allocations(), before, "outside of a section nothing is counted");
    {
        let _section = Section::enter();
        drop(std::hint::black_box(Box::new(1)));
    }
    assert_eq!(alloc::allocations(), before + 1);

    let name = RunName::unique("allocation");
    let publisher = Publisher::create(&name).expect("this machine has shared memory");
    let mut runner = Runner::new(Failing, Some(publisher));
    let external = ExternalInputs::default();
    // The first rehearsal makes the copy that rehearses.
    runner.rehearse(&external, &());
    for _ in 0..10_000 {
        runner.rehearse(&external, &());
        runner.step(&external, &(), 0);
    }
    assert_eq!(runner.allocations(), Some(0));
    let reader = Attached::open(&name).expect("the run lives");
    for _ in 0..1_000 {
        let _section = Section::enter();
        let read = (reader.memory(), reader.external(), reader.pulse());
        assert!(read.0.is_ok() && read.1.is_ok() && read.2.is_ok());
    }
    assert_eq!(runner.allocations(), Some(0), "readers do not allocate either");
    let times = runner.times().summary();
    println!(
        "controller part with publishing: p50 {} us, p99 {} us, max {} us",
        times.p50, times.p99, times.max
    );

    let mut careless = Runner::new(Careless, None);
    for _ in 0..1_000 {
        careless.step(&external, &(), 0);
    }
    assert_eq!(careless.allocations(), Some(10));
}
