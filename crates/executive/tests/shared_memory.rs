//! Common memory in shared memory: readers that attach and leave read the published values, and nothing remains.

mod common;

use std::{
    path::PathBuf,
    sync::{
        Barrier,
        atomic::{AtomicBool, Ordering},
    },
};

use executive::memory::{
    self, Announced, Attached, Publisher, RunName, SharedMemoryError, layout::Pulse, list,
};
use interfaces::{CommonMemory, Decided, ExternalInputs, Header, emove::EmoveVerb, hws::HwsReport};
use rcs_core::{
    Plain,
    name::Name16,
    plain::{Schema, from_bytes},
    tick::Tick,
};

use crate::common::headers;

fn name(test: &str) -> RunName {
    RunName::unique(test)
}

fn with_stamp(tick: u64) -> (ExternalInputs, CommonMemory, Pulse) {
    let tick = Tick(tick);
    let header = Header { stamp: tick, decided: Some(Decided { table: 2, row: 7 }), ..Header::ZERO };
    let mut memory = CommonMemory::default();
    headers(&mut memory).into_iter().for_each(|place| *place = header);
    memory.task.status.report = HwsReport::Executing;
    memory.subtask.emove.command = EmoveVerb::MovToObj;
    memory.prim.status.distance = i32::try_from(tick.0).unwrap();
    memory.grip.status.position = -i32::try_from(tick.0).unwrap();
    let mut external = ExternalInputs::default();
    external.hws.number = u32::try_from(tick.0).unwrap();
    external.hws.object = Some(Name16::new("LINKBAR1_BH").unwrap());
    external.devices.joystick.velocity = 1000;
    (
        external,
        memory,
        Pulse { tick, generation: 0, skipped: 3, allocations: 0, controller_ns: 4711, over: false },
    )
}

#[test]
fn reader_gets_the_last_published_values() {
    let name = name("sees");
    let mut publisher = Publisher::create(&name).expect("this machine has shared memory");
    let reader = Attached::open(&name).expect("the run lives");
    assert_eq!(reader.memory(), Ok(CommonMemory::default()));
    for tick in 1..100 {
        let (external, memory, pulse) = with_stamp(tick);
        publisher.publish(&external, &memory, pulse);
        assert_eq!(reader.memory(), Ok(memory));
        assert_eq!(reader.external(), Ok(external));
        assert_eq!(reader.pulse(), Ok(pulse));
    }
}

#[test]
fn reader_never_gets_a_torn_tick() {
    let name = name("torn");
    let mut publisher = Publisher::create(&name).expect("this machine has shared memory");
    let (stop, attached) = (AtomicBool::new(false), Barrier::new(2));
    std::thread::scope(|scope| {
        let reader = scope.spawn(|| {
            let reader = Attached::open(&name).expect("the run lives");
            attached.wait();
            let mut last = 0;
            loop {
                // After the end of writing the next attempt succeeds.
                let written = stop.load(Ordering::Acquire);
                let memory = match reader.memory() {
                    Ok(memory) => memory,
                    Err(error) => {
                        assert!(!written, "{error}");
                        continue;
                    }
                };
                let tick = memory.task.header.stamp.0;
                assert!(tick >= last, "{tick} after {last}");
                if tick > 0 {
                    assert_eq!(memory, with_stamp(tick).1);
                }
                last = tick;
                if written {
                    return last;
                }
            }
        });
        attached.wait();
        for tick in 1..20_000 {
            let (external, memory, pulse) = with_stamp(tick);
            publisher.publish(&external, &memory, pulse);
            if tick % 100 == 0 {
                std::thread::yield_now();
            }
        }
        stop.store(true, Ordering::Release);
        assert_eq!(reader.join().expect("no tick was torn"), 19_999);
    });
}

#[test]
fn silent_process_does_not_block_readers() {
    let name = name("absent");
    let mut publisher = Publisher::create(&name).expect("shared memory");
    let reader = Attached::open(&name).expect("the run lives");
    let (mut external, mut memory, pulse) = with_stamp(9);
    external.pedestal.elsewhere = true;
    for header in [&mut memory.pedestal.header, &mut memory.hand.header, &mut memory.table.header] {
        header.stamp = Tick(4);
    }
    publisher.publish(&external, &memory, pulse);
    assert_eq!((reader.memory(), reader.external()), (Ok(memory), Ok(external)));
    // Nor does a lost process of this system.
    memory.grip.header.stamp = Tick(4);
    publisher.publish(&external, &memory, pulse);
    assert_eq!(reader.memory(), Ok(memory));
}

#[test]
fn last_process_to_leave_removes_the_files() {
    let name = name("last");
    let mut publisher = Publisher::create(&name).expect("this machine has shared memory");
    drop(Attached::open(&name).expect("the run lives"));
    let reader = Attached::open(&name).expect("the run still lives");
    let (external, memory, pulse) = with_stamp(41);
    publisher.publish(&external, &memory, pulse);
    assert!(list().unwrap().iter().any(|run| run.name == name && run.alive));
    drop(publisher);
    assert_eq!(reader.pulse(), Ok(Pulse { over: true, ..pulse }));
    assert_eq!(reader.memory(), Ok(memory));
    assert!(!memory::traces(&name).is_empty());
    drop(reader);
    assert_eq!(memory::traces(&name), Vec::<PathBuf>::new());
    assert!(matches!(Attached::open(&name), Err(SharedMemoryError::NoSuchRun { .. })));
}

#[test]
fn second_run_of_a_name_is_refused() {
    let (one, other) = (name("one"), name("other"));
    let mut first = Publisher::create(&one).unwrap();
    let mut second = Publisher::create(&other).unwrap();
    assert!(matches!(Publisher::create(&one), Err(SharedMemoryError::Service { service: "task", .. })));
    let (external, memory, pulse) = with_stamp(1);
    first.publish(&external, &memory, pulse);
    let (external, memory, pulse) = with_stamp(2);
    second.publish(&external, &memory, pulse);
    assert_eq!(Attached::open(&one).unwrap().memory().unwrap().prim.status.distance, 1);
    assert_eq!(Attached::open(&other).unwrap().memory().unwrap().prim.status.distance, 2);
}

/// A stream of numbers that is the same in every run.
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        usize::try_from(self.0 >> 33).unwrap() % limit
    }
}

fn some_value(schema: &Schema, numbers: &mut Numbers, image: &mut Vec<u8>) {
    match schema {
        Schema::Bool => image.push(u8::try_from(numbers.below(2)).unwrap()),
        Schema::Enum(of) => image.push(of.variants[numbers.below(of.variants.len())].code),
        Schema::Option(of) => match numbers.below(2) {
            0 => image.extend(std::iter::repeat_n(0, 1 + of.size())),
            _ => {
                image.push(1);
                some_value(of, numbers, image);
            }
        },
        Schema::Union(of) => {
            let (variant, end) =
                (&of.variants[numbers.below(of.variants.len())], image.len() + schema.size());
            image.push(variant.code);
            variant.payload.iter().for_each(|payload| some_value(payload, numbers, image));
            image.resize(end, 0);
        }
        Schema::F64 => image.extend((numbers.below(100_000) as f64 / 7.0).to_le_bytes()),
        Schema::Text(length) => {
            let used = numbers.below(length + 1);
            image.extend(
                (0..*length)
                    .map(|at| if at < used { b'!' + u8::try_from(numbers.below(94)).unwrap() } else { 0 }),
            );
        }
        Schema::Array(of, length) => (0..*length).for_each(|_| some_value(of, numbers, image)),
        Schema::Struct(of) => of.fields.iter().for_each(|field| some_value(&field.schema, numbers, image)),
        number => image.extend((0..number.size()).map(|_| u8::try_from(numbers.below(256)).unwrap())),
    }
}

#[test]
fn common_memory_round_trips_through_shared_memory() {
    let name = name("any");
    let mut publisher = Publisher::create(&name).unwrap();
    let reader = Attached::open(&name).unwrap();
    let mut numbers = Numbers(1987);
    for tick in 1..500 {
        let mut image = Vec::new();
        some_value(&CommonMemory::SCHEMA, &mut numbers, &mut image);
        let mut memory: CommonMemory = from_bytes(&image).expect("legal by construction");
        let (external, stamped, pulse) = with_stamp(tick);
        headers(&mut memory).into_iter().for_each(|place| *place = stamped.task.header);
        publisher.publish(&external, &memory, pulse);
        assert_eq!(reader.memory(), Ok(memory));
    }
}

#[test]
fn announced_run_is_found_before_its_first_tick() {
    let name: RunName = format!("announced-{}", std::process::id()).parse().unwrap();
    let announced = Announced::named(name.clone()).unwrap();
    assert_eq!(memory::starting(&name).as_deref(), Some("starts"));
    announced.say("waits for its boards");
    assert!(matches!(
        Attached::open(&name),
        Err(SharedMemoryError::Starting { phase, .. }) if phase == "waits for its boards"
    ));
    assert!(matches!(Announced::named(name.clone()), Err(SharedMemoryError::NameInUse { .. })));
    let publisher = Publisher::create(&name).unwrap();
    assert_eq!(memory::starting(&name), None);
    drop(Attached::open(&name).unwrap());
    drop(publisher);
    drop(announced);
    assert_eq!(memory::traces(&name), Vec::<PathBuf>::new());
    drop(Announced::named(name).unwrap());
}

#[test]
fn runs_of_a_job_in_one_process_have_different_names() {
    let first = Announced::of_job("twice").unwrap();
    let second = Announced::of_job("twice").unwrap();
    assert_eq!(second.name().as_str(), format!("{}.1", first.name()));
}

/// A directory for temporary files is cleaned while a run lives, and a service has one of its own.
#[test]
fn the_directory_of_runs_is_in_shared_memory() {
    assert!(memory::root().starts_with("/dev/shm"), "{}", memory::root().display());
}
