//! Cost of common memory: a buffer against a bare blackboard of iceoryx2, and a tick without and with publishing and
//! readers. Lines are medians of rounds, so that a stall of the machine has no effect.

#![expect(clippy::print_stdout, reason = "figures are what it is for")]

use std::{
    hint::black_box,
    sync::atomic::{AtomicBool, Ordering},
    thread,
    time::{Duration, Instant},
};

use closed_loop::{Present, course::Course};
use executive::{
    memory::{
        Attached, Publisher, RunName,
        layout::{Pulse, SERVICES},
    },
    runner::Runner,
};
use iceoryx2::prelude::*;
use interfaces::{CommonMemory, ExternalInputs};
use levels::ladder::PROCESS_COUNT;
use rcs_core::tick::Tick;
use taskdata::files::TaskData;

const BARE: usize = 128; // size of a bare value, bytes: about that of a medium-sized buffer
const ROUNDS: usize = 101;
const CALLS: u32 = 200;

fn measure(what: &str, parts: usize, mut call: impl FnMut()) {
    let mut rounds: Vec<Duration> = (0..ROUNDS)
        .map(|_| {
            let started = Instant::now();
            (0..CALLS).for_each(|_| call());
            started.elapsed() / CALLS
        })
        .collect();
    rounds.sort();
    println!("{what:<48} {:>9.1} ns", rounds[ROUNDS / 2].as_secs_f64() * 1e9 / parts as f64);
}

fn buffers() {
    let name = RunName::unique("bench-buffers");
    let mut publisher = Publisher::create(&name).expect("this machine has shared memory");
    let reader = Attached::open(&name).expect("the run lives");
    let (external, memory) = (ExternalInputs::default(), CommonMemory::default());
    let mut pulse = Pulse::default();
    let count = SERVICES.len();
    measure(&format!("write the outputs of a process, one of {count}"), count, || {
        pulse.tick = Tick(pulse.tick.0 + 1);
        publisher.publish(&external, &memory, black_box(pulse));
    });
    measure(&format!("read and decode them, one of {PROCESS_COUNT}"), PROCESS_COUNT, || {
        let _ = black_box(reader.memory());
    });
}

fn bare() {
    set_log_level(LogLevel::Fatal);
    let node = NodeBuilder::new().create::<ipc::Service>().expect("a node");
    let name: ServiceName =
        format!("rcs-ii-bench-{}", std::process::id()).as_str().try_into().expect("a name");
    let service = node
        .service_builder(&name)
        .blackboard_creator::<u32>()
        .add::<[u8; BARE]>(0, [0; BARE])
        .create()
        .expect("a service");
    let writer = service.writer_builder().create().expect("a writer");
    let entry = writer.entry::<[u8; BARE]>(&0).expect("an entry");
    let reader = service.reader_builder().create().expect("a reader");
    let handle = reader.entry::<[u8; BARE]>(&0).expect("an entry");
    let mut value = [0_u8; BARE];
    measure(&format!("iceoryx2 alone: write {BARE} bytes"), 1, || {
        value[0] = value[0].wrapping_add(1);
        entry.update_with_copy(black_box(value));
    });
    measure(&format!("iceoryx2 alone: read {BARE} bytes"), 1, || {
        let read: [u8; BARE] = *handle.get();
        black_box(read);
    });
}

/// A tick of a ladder without a command: the controller's part and the bookkeeping.
fn ticks() {
    let (external, data) = (ExternalInputs::default(), TaskData::default());
    let (mut course, mut alone) = (Course::new(Present::default()), Runner::new(None));
    measure("tick, not published", 1, || {
        let Ok(()) = alone.step(&mut course, &external, &data, 0);
    });
    measure("warm-up of a tick, not published", 1, || alone.warm_up(&mut course, &external, &data));
    let name = RunName::unique("bench-tick");
    let publisher = Publisher::create(&name).expect("this machine has shared memory");
    let mut published = Runner::new(Some(publisher));
    let mut tick = || {
        let Ok(()) = published.step(&mut course, &external, &data, 0);
    };
    measure("tick, published", 1, &mut tick);
    let stop = AtomicBool::new(false);
    thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                let reader = Attached::open(&name).expect("the run lives");
                while !stop.load(Ordering::Relaxed) {
                    let _ = black_box(reader.memory());
                    thread::sleep(Duration::from_millis(1));
                }
            });
        }
        thread::sleep(Duration::from_millis(50));
        measure("tick, published, two readers a thousand times/s", 1, &mut tick);
        stop.store(true, Ordering::Relaxed);
    });
}

fn main() {
    buffers();
    bare();
    ticks();
}
