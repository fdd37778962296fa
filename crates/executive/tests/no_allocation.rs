//! A tick allocates nothing, with everything that the executive does in one, also in iceoryx2: a version that allocates
//! when a value is written or read fails here. The file has one test, because everything runs on the counting
//! allocator.

mod common;

use std::convert::Infallible;

use closed_loop::course::{Course, Levels};
use executive::{
    alloc::{self, Counting, Section},
    memory::{Attached, Publisher, RunName},
    runner::Runner,
};
use interfaces::{CommonMemory, ExternalInputs, Reason};
use levels::ladder::ProcessId;
use rcs_core::tick::Tick;

use crate::common::headers;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Fails every tenth tick and recovers, so that the watch for failures has work to do.
#[derive(Clone)]
struct Failing;

impl Levels<()> for Failing {
    type Error = Infallible;

    fn step(
        &mut self,
        tick: Tick,
        before: &CommonMemory,
        _: &ExternalInputs,
        _: &(),
        after: &mut CommonMemory,
        _: &mut dyn FnMut(Option<ProcessId>),
    ) -> Result<(), Infallible> {
        *after = *before;
        for header in headers(after) {
            header.stamp = tick;
        }
        after.grip.status.reason = if tick.0 % 10 < 5 { Reason::GraspMissed } else { Reason::None };
        after.emove.status.reason = before.grip.status.reason;
        Ok(())
    }

    fn shadow(&self) -> Option<Box<Self>> {
        Some(Box::new(self.clone()))
    }

    fn copy_to(&self, shadow: &mut Self) {
        shadow.clone_from(self);
    }
}

struct AllocatingProcess;

impl Levels<()> for AllocatingProcess {
    type Error = Infallible;

    fn step(
        &mut self,
        tick: Tick,
        before: &CommonMemory,
        _: &ExternalInputs,
        _: &(),
        after: &mut CommonMemory,
        _: &mut dyn FnMut(Option<ProcessId>),
    ) -> Result<(), Infallible> {
        *after = *before;
        after.task.header.stamp = tick;
        if tick.0.is_multiple_of(100) {
            drop(std::hint::black_box(vec![1_u8]));
        }
        Ok(())
    }
}

#[test]
fn allocation_in_a_tick_is_detected() {
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
    let (mut course, mut runner) = (Course::new(Failing), Runner::new(Some(publisher)));
    let external = ExternalInputs::default();
    runner.warm_up(&mut course, &external, &());
    for _ in 0..10_000 {
        runner.warm_up(&mut course, &external, &());
        let Ok(()) = runner.step(&mut course, &external, &(), 0);
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

    let (mut course, mut careless) = (Course::new(AllocatingProcess), Runner::new(None));
    for _ in 0..1_000 {
        let Ok(()) = careless.step(&mut course, &external, &(), 0);
    }
    assert_eq!(careless.allocations(), Some(10));
}
