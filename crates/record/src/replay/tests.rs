//! A replay in stretches has the result of a replay in one piece.

use std::io::Cursor;

use proptest::prelude::*;
use rcs_core::name::Name16;
use taskdata::files::TaskData;

use super::*;
use crate::{
    input::{End, Lost, Setup},
    writer::{LogWriter, TickRecord},
};

const TICKS: u64 = 310; // ticks of the runs: more than twelve parts of a log

#[derive(Clone, Debug)]
struct Case {
    gap: (u64, u64),                      // missing ticks, from one of them on
    without_states: u64,                  // a second without recorded states
    changed: Option<u64>,                 // a tick whose outputs were changed
    damaged: Option<prop::sample::Index>, // a byte of the file that was changed
    from: Option<u64>,
    until: Option<u64>,
}

/// The log of a run whose commands change every hundred ticks.
fn log(case: &Case) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let mut log = LogWriter::create(&mut file, Setup::default()).unwrap();
    let (mut ladder, mut memory, mut gap) = (Ladder::default(), CommonMemory::default(), 0);
    for tick in (1..=TICKS).map(Tick) {
        let mut external = ExternalInputs::default();
        external.hws.number = u32::try_from(tick.0 / 100).unwrap();
        external.hws.command = Name16::new("PAUSE").unwrap();
        external.devices.resolvers.counts = [u32::try_from(37 * tick.0).unwrap(); 6];
        let before = memory;
        ladder.step(tick, &before, &external, &TaskData::default(), &mut memory);
        let (first, missing) = case.gap;
        if (first..first + missing).contains(&tick.0) {
            gap += 1;
            continue;
        }
        let mut recorded = TickRecord { tick, gap, external, memory, timing: None };
        recorded.memory.prim.status.distance += i32::from(case.changed == Some(tick.0));
        let state = (gap > 0 || tick.0 % 25 == 1) && tick.0 / 25 != case.without_states;
        log.tick(&recorded, state.then(|| ladder.state()).as_ref(), None).unwrap();
        gap = 0;
    }
    log.finish(&End::default(), Lost::default()).unwrap();
    let mut bytes = file.into_inner();
    if let Some(at) = &case.damaged {
        *at.get_mut(&mut bytes) ^= 0x55;
    }
    bytes
}

fn replayed(log: &Log, case: &Case, length: usize) -> Result<Replayed, String> {
    let options = Options { data: None, from: case.from.map(Tick), until: case.until.map(Tick) };
    let generations = [Store::default()];
    let stretches = ReplayParts::new(log, &options, &generations, length);
    stretches.replay().map_err(|error| error.to_string())
}

fn cases() -> impl Strategy<Value = Case> {
    let tick = 1..=TICKS;
    let gap = prop_oneof![Just((0, 0)), (tick.clone(), 1_u64..60)];
    let sometimes = || prop::option::weighted(0.3, tick.clone());
    let damaged = prop::option::weighted(0.3, any::<prop::sample::Index>());
    (gap, 0..40_u64, sometimes(), damaged, sometimes(), sometimes()).prop_map(
        |(gap, without_states, changed, damaged, from, until)| Case {
            gap,
            without_states,
            changed,
            damaged,
            from,
            until,
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn stretches_of_any_length_have_the_same_result(case in cases()) {
        let Ok(log) = Log::from_bytes(Path::new("run.mcap"), log(&case)) else { return Ok(()) };
        let whole = replayed(&log, &case, usize::MAX);
        for length in [1, 2, 5, STRETCH] {
            prop_assert_eq!(&replayed(&log, &case, length), &whole, "stretches of {}", length);
        }
    }
}

#[test]
fn a_run_is_replayed_whole() {
    let case =
        Case { gap: (0, 0), without_states: 1000, changed: None, damaged: None, from: None, until: None };
    let log = Log::from_bytes(Path::new("run.mcap"), log(&case)).unwrap();
    assert!(log.parts() > 12, "{} parts", log.parts());
    let mut digest = Digest::new();
    for logged in log.ticks() {
        digest.add(&logged.unwrap().memory);
    }
    let expected = Replayed { ticks: TICKS, skipped: 0, digest, first_difference: None };
    assert_eq!(replayed(&log, &case, 1), Ok(expected));
}
