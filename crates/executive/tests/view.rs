//! A reader also gets the headers of the last ten seconds, and the simulated cell.

mod common;

use std::sync::atomic::{AtomicBool, Ordering};

use executive::memory::{
    Attached, Publisher, RunName, Text,
    cell::CellView,
    history::{HISTORY_TICKS, Headers},
    layout::Pulse,
};
use interfaces::{Basis, CommonMemory, Decided, ExternalInputs, Header, ProcessId};
use rcs_core::{table::Values, tick::Tick};

use crate::common::headers;

fn memory(tick: u64) -> CommonMemory {
    let values = Values { step: 1, variables: tick };
    let header = Header {
        stamp: Tick(tick),
        decided: Some(Decided { table: 3, row: 9 }),
        basis: Some(Basis { tick: Tick(tick), values }),
        ..Header::default()
    };
    let mut memory = CommonMemory::default();
    headers(&mut memory).into_iter().for_each(|place| *place = header);
    memory
}

fn publish(publisher: &mut Publisher, tick: u64) {
    let pulse = Pulse { tick: Tick(tick), ..Pulse::default() };
    publisher.publish(&ExternalInputs::default(), &memory(tick), pulse);
}

fn ticks(history: &[Headers]) -> Vec<u64> {
    history.iter().map(|headers| headers.tick.0).collect()
}

#[test]
fn late_reader_gets_the_last_ten_seconds() {
    let name = RunName::unique("history");
    let mut publisher = Publisher::create(&name).expect("this machine has shared memory");
    let reader = Attached::open(&name).expect("the run lives");
    assert_eq!(reader.history(Tick::BEFORE_START), Ok(Vec::new()));
    for tick in 1..=7 {
        publish(&mut publisher, tick);
    }
    assert_eq!(ticks(&reader.history(Tick::BEFORE_START).unwrap()), [1, 2, 3, 4, 5, 6, 7]);
    for tick in 8..=1000 {
        publish(&mut publisher, tick);
    }
    let late = Attached::open(&name).expect("the run still lives");
    let history = late.history(Tick::BEFORE_START).unwrap();
    assert_eq!(ticks(&history), (1001 - u64::from(HISTORY_TICKS)..=1000).collect::<Vec<_>>());
    for headers in &history {
        let expected = memory(headers.tick.0);
        for process in ProcessId::ALL {
            assert_eq!(headers.of_process(*process), expected.header(*process));
        }
    }
    assert_eq!(ticks(&late.history(Tick(997)).unwrap()), [998, 999, 1000]);
    assert_eq!(late.history(Tick(1000)), Ok(Vec::new()));
}

#[test]
fn a_warm_up_that_repeats_a_tick_leaves_the_state_unchanged() {
    let name = RunName::unique("again");
    let mut publisher = Publisher::create(&name).expect("this machine has shared memory");
    let reader = Attached::open(&name).expect("the run lives");
    for tick in [1, 2, 2, 3] {
        publish(&mut publisher, tick);
    }
    assert_eq!(ticks(&reader.history(Tick::BEFORE_START).unwrap()), [1, 2, 3]);
}

#[test]
fn the_headers_of_a_tick_are_consistent_during_a_run() {
    let name = RunName::unique("whole");
    let mut publisher = Publisher::create(&name).expect("this machine has shared memory");
    let reader = Attached::open(&name).expect("the run lives");
    let stop = &AtomicBool::new(false);
    std::thread::scope(|scope| {
        let looks = scope.spawn(move || {
            let mut found = 0;
            while !stop.load(Ordering::Acquire) {
                let history = reader.history(Tick::BEFORE_START).expect("every entry is legal");
                let ticks = ticks(&history);
                assert!(ticks.is_sorted_by(|one, next| one < next), "{ticks:?}");
                for headers in history {
                    assert!(headers.headers.iter().all(|header| header.stamp == headers.tick));
                    found += 1;
                }
            }
            found
        });
        for tick in 1..20_000 {
            publish(&mut publisher, tick);
            if tick % 100 == 0 {
                std::thread::yield_now();
            }
        }
        stop.store(true, Ordering::Release);
        assert!(looks.join().expect("no header was torn") > 0);
    });
}

#[test]
fn a_run_without_a_simulated_cell_shows_none() {
    let name = RunName::unique("cell");
    let mut publisher = Publisher::create(&name).expect("this machine has shared memory");
    let reader = Attached::open(&name).expect("the run lives");
    publish(&mut publisher, 1);
    assert_eq!(reader.cell(), Ok(None));
    let mut view = CellView { tick: Tick(1), ..CellView::default() };
    view.controller.stage = Text::clipped("hydraulics enabled");
    view.controller.estops[3] = true;
    view.joints[5] = -1.25;
    publisher.show_cell(&view);
    assert_eq!(reader.cell(), Ok(Some(view)));
}
