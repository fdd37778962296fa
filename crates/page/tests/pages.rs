//! A log becomes a page: the copy of the log has the messages and files that the page reads, and can be decompressed.

use std::{collections::BTreeMap, io::Read as _};

use flate2::read::ZlibDecoder;
use interfaces::{CommonMemory, ExternalInputs};
use rcs_core::tick::Tick;
use record::{Attachment, End, Epoch, Log, Pace, Recorder, Setup};

/// Ticks of the run: more than a second, so that the log has several chunks.
const TICKS: u64 = 60;

/// A log of a run in which Task's status changes in every tick.
fn log() -> Log {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let attachments =
        vec![Attachment::text(Attachment::JOB, "== PAUSE"), Attachment::text("cell.toml", "[arm]")];
    let setup = Setup { epoch: Epoch::Fixed, attachments, ..Setup::default() };
    let mut recorder = Recorder::start(&path, Pace::Wait, setup).unwrap();
    let mut memory = CommonMemory::default();
    for tick in 1..=TICKS {
        memory.task.status.echo = u32::try_from(tick).unwrap();
        recorder.tick(Tick(tick), &ExternalInputs::default(), &memory, Default::default);
    }
    recorder.finish(End::default()).unwrap();
    Log::open(&path).unwrap()
}

/// The records of a block: code and body.
fn records(mut block: &[u8]) -> Vec<(u8, Vec<u8>)> {
    let mut found = Vec::new();
    while let Some((head, rest)) = block.split_at_checked(9) {
        let (body, after) = rest.split_at(u64::from_le_bytes(head[1..].try_into().unwrap()) as usize);
        found.push((head[0], body.to_vec()));
        block = after;
    }
    assert!(block.is_empty(), "a record is incomplete");
    found
}

/// The text at a place, where its length precedes it, and the place after the text.
fn text(body: &[u8], at: usize) -> (String, usize) {
    let size = u32::from_le_bytes(body[at..at + 4].try_into().unwrap()) as usize;
    let end = at + 4 + size;
    (String::from_utf8(body[at + 4..end].to_vec()).unwrap(), end)
}

fn inflated(data: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    ZlibDecoder::new(data).read_to_end(&mut out).unwrap();
    out
}

/// Ticks and data of the messages of a copy, by topic.
fn messages(copy: &[(u8, Vec<u8>)]) -> BTreeMap<String, Vec<(u64, Vec<u8>)>> {
    let mut topics = BTreeMap::new();
    let mut found: BTreeMap<String, Vec<(u64, Vec<u8>)>> = BTreeMap::new();
    for (code, body) in copy {
        if *code == 0x04 {
            topics.insert(u16::from_le_bytes([body[0], body[1]]), text(body, 4).0);
        }
        if *code != 0x06 {
            continue;
        }
        let (compression, at) = text(body, 28);
        assert_eq!(compression, "deflate");
        for (code, message) in records(&inflated(&body[at + 8..])) {
            assert_eq!(code, 0x05);
            let topic = &topics[&u16::from_le_bytes([message[0], message[1]])];
            let tick = u32::from_le_bytes(message[2..6].try_into().unwrap());
            found.entry(topic.clone()).or_default().push((tick.into(), message[22..].to_vec()));
        }
    }
    found
}

#[test]
fn a_log_becomes_a_page_with_its_messages() {
    let log = log();
    let copy = page::pack(&log, &[]);
    let magic = b"\x89MCAP0\r\n";
    let inner = copy.strip_prefix(magic).and_then(|rest| rest.strip_suffix(magic)).expect("an MCAP file");
    let found = messages(&records(inner));
    assert!(!found.contains_key("/replay"));
    for topic in ["/task/status", "/task/row", "/external/devices", "/log"] {
        let expected: Vec<_> = log.messages(topic).map(|(tick, data)| (tick.0, data)).collect();
        assert_eq!(found.get(topic).cloned().unwrap_or_default(), expected, "{topic}");
    }
    // The last tick is written again at the end.
    assert_eq!(found["/task/status"].len() as u64, TICKS + 1);
}

#[test]
fn a_copy_has_the_job_and_what_the_program_adds() {
    let added = Attachment::text("why.json", "{}");
    let copy = page::pack(&log(), &[added]);
    let files =
        records(&copy[8..copy.len() - 8]).into_iter().filter(|(code, _)| *code == 0x09).map(|(_, body)| {
            let (name, at) = text(&body, 16);
            let (_, at) = text(&body, at);
            let size = u64::from_le_bytes(body[at..at + 8].try_into().unwrap()) as usize;
            (name, inflated(&body[at + 8..at + 8 + size]))
        });
    let expected = [("job.deflate", "== PAUSE"), ("why.json.deflate", "{}")];
    let expected: Vec<_> = expected.map(|(name, text)| (name.to_owned(), text.as_bytes().to_vec())).into();
    assert_eq!(files.collect::<Vec<_>>(), expected);
}
