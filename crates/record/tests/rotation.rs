//! A run writes several logs, one after the other. Each is read and replayed without the others.

use std::{fs, path::PathBuf};

use interfaces::{CommonMemory, ExternalInputs};
use levels::ladder::Ladder;
use rcs_core::{name::Name16, tick::Tick};
use record::{
    Attachment, End, Log, LogFile, LogLimit, Pace, Recorder, Setup, replay,
    tap::{Channel, Tap},
};
use taskdata::files::TaskData;

const TICKS: u64 = 1000; // number of ticks of the run
const SIZE: u64 = 60_000; // size of a log, bytes: some seconds of this run

const ADDED: u64 = 30; // tick in which the run gets another file

fn inputs(tick: Tick) -> ExternalInputs {
    let mut external = ExternalInputs::default();
    let turn = u32::try_from(tick.0 * 37 % 131_072).unwrap();
    external.devices.resolvers.counts = [turn, 5 * turn % 131_072, 0, 0, 0, 1];
    external.devices.resolvers.valid = true;
    external.hws.number = u32::try_from(tick.0 / 100).unwrap();
    external.hws.command = Name16::new("TRANSFER").unwrap();
    external
}

#[derive(Default)]
struct Counts(std::sync::Arc<std::sync::Mutex<(usize, usize)>>);

impl Tap for Counts {
    fn channel(&mut self, _: u16, channel: &Channel<'_>) {
        self.0.lock().unwrap().0 += usize::from(channel.topic == "/replay");
    }

    fn message(&mut self, _: u16, _: u64, _: &[u8]) {
        self.0.lock().unwrap().1 += 1;
    }
}

/// Record a run with a limit; returns the logs in the order of their ticks, and the messages of its tap.
fn recorded(directory: &std::path::Path, kept: Option<usize>) -> (Vec<PathBuf>, (usize, usize), usize) {
    let path = directory.join("run.mcap");
    let attachments = vec![Attachment::text(Attachment::JOB, "TRANSFER")];
    let setup = Setup { attachments, ..Setup::default() };
    let counts = Counts::default();
    let tapped = counts.0.clone();
    let limit = Some(LogLimit { bytes: SIZE, kept });
    let file = LogFile::claim(&path).unwrap();
    let mut recorder = Recorder::start_in(file, Pace::Wait, setup, Some(Box::new(counts)), limit).unwrap();
    let (mut ladder, mut memory) = (Ladder::default(), CommonMemory::default());
    for tick in (1..=TICKS).map(Tick) {
        let (before, external) = (memory, inputs(tick));
        ladder.step(tick, &before, &external, &TaskData::default(), &mut memory);
        if tick.0 == ADDED {
            recorder.attach(tick, Attachment::text("added.txt", "a file of the run"));
        }
        recorder.tick(tick, &external, &memory, || ladder.state());
    }
    let end = End { digest: Some(1), result: "finished".into(), ..End::default() };
    let earlier = recorder.finish(end).unwrap().earlier;
    let mut logs: Vec<PathBuf> =
        fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path()).collect();
    logs.sort_by_key(|log| Log::open(log).unwrap().ticks().next().unwrap().unwrap().tick);
    let counted = *tapped.lock().unwrap();
    (logs, counted, earlier)
}

#[test]
fn every_log_of_a_run_replays_alone() {
    let place = tempfile::tempdir().unwrap();
    let (logs, (channels, messages), earlier) = recorded(place.path(), None);
    assert!(logs.len() > 3 && earlier == logs.len() - 1, "{logs:?}");
    assert_eq!(logs.last().unwrap(), &place.path().join("run.mcap"));
    let mut next = 1;
    for (at, path) in logs.iter().enumerate() {
        let log = Log::open(path).unwrap();
        assert!(log.complete && log.damage().is_none(), "{}", path.display());
        let ticks: Vec<u64> = log.ticks().map(|tick| tick.unwrap().tick.0).collect();
        assert_eq!(ticks, (next..next + ticks.len() as u64).collect::<Vec<_>>(), "{}", path.display());
        let has_added = log.attachment("added.txt").is_some();
        assert_eq!(has_added, next + ticks.len() as u64 > ADDED, "{}", path.display());
        assert!(log.attachment(Attachment::JOB).is_some(), "{}", path.display());
        let report = replay(path).unwrap();
        assert!(report.first_difference.is_none(), "{}: {:?}", path.display(), report.first_difference);
        // The first tick of a later log is taken over with its states.
        let taken_over = u64::from(at > 0);
        assert_eq!(report.ticks, ticks.len() as u64 - taken_over, "{}", path.display());
        let says = |text: &str| log.lines().any(|line| line.text.contains(text));
        assert_eq!(says("the ticks before this one are in run-"), at > 0);
        assert!(!says("could not keep up"));
        next += ticks.len() as u64;
    }
    assert_eq!(next, TICKS + 1, "no tick is missing");
    assert_eq!(channels, 1, "viewers keep their channels");
    assert!(messages > usize::try_from(TICKS).unwrap());
}

#[test]
fn only_the_newest_logs_are_kept() {
    let place = tempfile::tempdir().unwrap();
    let (logs, _, earlier) = recorded(place.path(), Some(2));
    assert!(earlier > 2);
    assert_eq!(logs.len(), 3, "{logs:?}");
    let first = Log::open(&logs[0]).unwrap().ticks().next().unwrap().unwrap().tick;
    assert!(first > Tick(1), "the oldest logs are gone");
    logs.iter().for_each(|log| assert!(replay(log).unwrap().first_difference.is_none()));
    let limit = |kept| LogLimit { bytes: SIZE, kept };
    let link = place.path().join("link");
    std::os::unix::fs::symlink(&logs[0], &link).unwrap();
    for path in [&logs[0], &link] {
        assert!(limit(Some(2)).may_remove(&logs[2], path) && !limit(None).may_remove(&logs[2], path));
    }
    assert!(!limit(Some(2)).may_remove(&logs[2], &logs[2]), "the log itself is not an earlier one");
}
