//! The log of a run in which task data were loaded replays across the reload.

use std::path::Path;

use interfaces::{CommonMemory, ExternalInputs, Reason, hws::HwsReport};
use levels::ladder::Ladder;
use rcs_core::{Plain, digest::Digest, name::Name16, tick::Tick};
use record::{Attachment, End, Epoch, Pace, Recorder, ReplayError, Setup, replay};
use taskdata::load::{Source, Store};

const RELOADED: u64 = 40; // tick from which the reload is valid
const TICKS: u64 = 80;

fn block(text: &str) -> Vec<Source> {
    vec![Source { name: "home.blk".into(), text: text.into() }]
}

fn home() -> Vec<Source> {
    block(
        "BLOCK# 10 OFFSET 21000\n  0 -5022 636\n  0 -7145 -1483\n  3000 -7145 -1483  -pose- ... HOME-POS\n\n\
         BLOCK# 11 OFFSET 21000\n  -pt-  HOME  HOME-POS  ...\n",
    )
}

/// MOVE to HOME once before and once after the reload. Before it, HOME is not in the data.
fn inputs(tick: u64) -> ExternalInputs {
    let mut external = ExternalInputs::default();
    external.hws.number = if tick < 10 { 0 } else { 1 + u32::from(tick > RELOADED + 10) };
    external.hws.command = Name16::new("MOVE").unwrap();
    external.hws.destination = Some(Name16::new("HOME").unwrap());
    external.generation = u32::from(tick >= RELOADED);
    external
}

fn record_run(path: &Path, attach: bool) -> Vec<(HwsReport, Reason)> {
    let before = Store::default();
    let (after, _) = before.with_blocks(home()).expect("the blocks are sound");
    let setup = Setup { epoch: Epoch::Fixed, ..Setup::default() };
    let mut recorder = Recorder::start(path, Pace::Wait, setup).unwrap();
    let (mut ladder, mut memory, mut digest) = (Ladder::default(), CommonMemory::default(), Digest::new());
    let mut reports = Vec::new();
    for tick in 1..=TICKS {
        let (last, external) = (memory, inputs(tick));
        let store = if external.generation == 0 { &before } else { &after };
        if tick == RELOADED && attach {
            for file in Attachment::reload(1, &home()) {
                recorder.attach(Tick(tick), file);
            }
        }
        ladder.step(Tick(tick), &last, &external, &store.view(), &mut memory);
        digest.add_record(&memory, &mut [0; CommonMemory::SIZE]);
        recorder.tick(Tick(tick), &external, &memory, || ladder.state());
        reports.push((memory.task.status.report, memory.task.status.reason));
    }
    recorder
        .finish(End { digest: Some(digest.value()), result: "stopped".into(), ..End::default() })
        .unwrap();
    reports
}

#[test]
fn log_replays_across_a_reload() {
    let directory = tempfile::tempdir().unwrap();
    let (with, without) = (directory.path().join("with.mcap"), directory.path().join("without.mcap"));

    let reports = record_run(&with, true);
    assert!(reports.contains(&(HwsReport::Error, Reason::UnknownLocation)), "before it HOME is unknown");
    assert_ne!(reports.last(), Some(&(HwsReport::Error, Reason::UnknownLocation)), "after it HOME is known");
    let report = replay(&with).unwrap();
    assert!(report.is_same(), "{:?}", report.first_difference);
    assert_eq!(report.ticks, TICKS);

    record_run(&without, false);
    let error = replay(&without).expect_err("the second generation is missing");
    assert!(matches!(error, ReplayError::Generation { tick: RELOADED, generation: 1 }), "{error}");
}
