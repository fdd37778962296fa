//! A thousand records of a run that were cut off: journals and logs, at record boundaries and at random bytes. Each is
//! refused, or read as the last complete knowledge with doubt, never as an older one without.

use std::path::Path;

use interfaces::{CommonMemory, ExternalInputs};
use levels::ladder::Ladder;
use rcs_core::{name::Name16, tick::Tick};
use record::{
    End, Log, Pace, Recorder, Setup,
    journal::{self, Entry, FIRST, Identity, RunEnd, SLOT, SLOTS},
};
use taskdata::files::TaskData;

const CUTS: usize = 500; // per kind of record
const TICKS: u64 = 160;
const SEED: u64 = 0x9e37_79b9_7f4a_7c15;

/// Pseudo-random numbers, the same in each run of the test.
struct Random(u64);

impl Random {
    fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        usize::try_from(self.0 % u64::try_from(limit).unwrap()).unwrap()
    }
}

fn entry(sequence: u64) -> Entry {
    let mut entry = Entry { tick: Tick(100 + sequence), line: 3, ..Entry::default() };
    entry.memory.emove.estimates.empty = sequence.is_multiple_of(3);
    entry
}

/// A journal with the entries up to `last`, each written as a whole.
fn journal_of(last: u64) -> Vec<u8> {
    let (mut bytes, of_head) = journal::begun(&Identity::new(), Some(&entry(FIRST)));
    for sequence in FIRST + 1..=last {
        let at = journal::place(sequence);
        journal::fill(&mut bytes[at..at + SLOT], of_head, sequence, &entry(sequence));
    }
    bytes
}

#[test]
fn journals_cut_off_anywhere_are_refused_or_read_truly() {
    let mut random = Random(SEED);
    let (mut refused, mut doubted, mut whole) = (0, 0, 0);
    for cut in 0..CUTS {
        let last = 1 + u64::try_from(random.below(3 * SLOTS)).unwrap();
        let (before, after) = (journal_of(last), journal_of(last + 1));
        let bytes = match cut % 4 {
            // The file ends at a block, or anywhere.
            0 => before[..random.below(journal::length() / 4096) * 4096].to_vec(),
            1 => before[..random.below(journal::length())].to_vec(),
            // The next entry is written up to a byte, or up to a block with the blocks in any order.
            2 => {
                let end = journal::place(last + 1) + random.below(SLOT);
                [&after[..end], &before[end..]].concat()
            }
            _ => {
                let mut bytes = before.clone();
                let at = journal::place(last + 1);
                for block in 0..SLOT / 512 {
                    if random.below(2) == 0 {
                        let range = at + block * 512..at + (block + 1) * 512;
                        bytes[range.clone()].copy_from_slice(&after[range]);
                    }
                }
                bytes
            }
        };
        match journal::read(&bytes) {
            Err(_) => refused += 1,
            Ok(read) if read.end == RunEnd::Reached => {
                whole += 1;
                let expected = if bytes == after { last + 1 } else { last };
                assert!(bytes == before || bytes == after, "cut {cut}: it was cut, and read without doubt");
                assert_eq!(read.newest, entry(expected), "cut {cut}");
            }
            Ok(read) => {
                doubted += 1;
                assert_eq!((read.newest, read.end), (entry(last), RunEnd::CutOff), "cut {cut}");
                let memory = read.memory(Tick(500));
                assert!(!memory.emove.estimates.empty && journal::asks_for_line(read.end), "cut {cut}");
            }
        }
    }
    println!("{CUTS} journals: {refused} refused, {doubted} with doubt, {whole} unchanged");
    assert!(refused > CUTS / 4 && doubted > CUTS / 4);
}

/// A log of a short run, and the buffers after each tick.
fn log_of_a_run() -> (Vec<u8>, Vec<CommonMemory>) {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let mut recorder = Recorder::start(&path, Pace::Wait, Setup::default()).unwrap();
    let (mut ladder, mut memory) = (Ladder::default(), CommonMemory::default());
    let mut memories = Vec::new();
    for tick in (1..=TICKS).map(Tick) {
        let (before, mut external) = (memory, ExternalInputs::default());
        external.devices.resolvers.counts = [u32::try_from(tick.0 * 37 % 131_072).unwrap(); 6];
        external.hws.number = u32::try_from(tick.0 / 40).unwrap();
        external.hws.command = Name16::new("PAUSE").unwrap();
        ladder.step(tick, &before, &external, &TaskData::default(), &mut memory);
        recorder.tick(tick, &external, &memory, || ladder.state());
        memories.push(memory);
    }
    recorder.finish(End { result: "stopped as requested".into(), ..End::default() }).unwrap();
    (std::fs::read(&path).unwrap(), memories)
}

/// The ends of the records of an MCAP file.
fn boundaries(bytes: &[u8]) -> Vec<usize> {
    let mut ends = vec![8];
    while let Some(length) = bytes.get(ends[ends.len() - 1] + 1..).and_then(|rest| rest.first_chunk::<8>()) {
        let length = usize::try_from(u64::from_le_bytes(*length)).unwrap_or(usize::MAX);
        let end = ends[ends.len() - 1].saturating_add(9).saturating_add(length);
        if end > bytes.len() {
            break;
        }
        ends.push(end);
    }
    ends
}

#[test]
fn logs_cut_off_anywhere_are_refused_or_read_truly() {
    let (bytes, memories) = log_of_a_run();
    let ends = boundaries(&bytes);
    let mut random = Random(SEED);
    let (mut refused, mut newest) = (0, 0);
    let mut last = (0, 0);
    let mut cuts: Vec<usize> = (0..CUTS)
        .map(|cut| if cut % 2 == 0 { ends[random.below(ends.len())] } else { random.below(bytes.len()) })
        .collect();
    cuts.sort_unstable();
    for end in cuts {
        let log = Log::from_bytes(Path::new("cut"), bytes[..end].to_vec());
        let read = log.ok().and_then(|log| journal::logged(&log, Identity::new(), None).ok());
        let Some(read) = read else {
            assert_eq!(last.1, 0, "byte {end}: a shorter log was read");
            refused += 1;
            continue;
        };
        let tick = read.newest.tick.0;
        assert!(tick >= last.1, "a log of {end} bytes ends at tick {tick}, one of {} at {}", last.0, last.1);
        last = (end, tick);
        newest += u64::from(tick == TICKS);
        let expected = journal::kept(&memories[usize::try_from(tick - 1).unwrap()]);
        assert_eq!(read.newest.memory, expected, "byte {end}: tick {tick}");
        assert!(tick == TICKS || read.end == RunEnd::CutOff, "byte {end}: tick {tick} without doubt");
    }
    println!("{CUTS} logs: {refused} refused, the others to tick {}, {newest} of them the last", last.1);
    let whole = Log::from_bytes(Path::new("whole"), bytes).unwrap();
    let read = journal::logged(&whole, Identity::new(), None).unwrap();
    assert_eq!((read.newest.tick, read.end, read.newest.over), (Tick(TICKS), RunEnd::Logged, false));
    let earlier = journal::logged(&whole, Identity::new(), Some(Tick(70))).unwrap();
    assert_eq!((earlier.newest.tick, earlier.end), (Tick(70), RunEnd::Logged));
    assert_eq!(earlier.newest.memory, journal::kept(&memories[69]));
    assert!(journal::logged(&whole, Identity::new(), Some(Tick(TICKS + 1))).is_err());
}
