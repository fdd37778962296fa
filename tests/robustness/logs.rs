//! Damaged logs: `rcs-log` answers or gives a reason, within a gigabyte of memory. In half of the logs bytes change;
//! in the others messages change in chunks with correct checksums, as only an intruder would write.

use std::{
    collections::BTreeMap,
    fs,
    io::Cursor,
    path::{Path, PathBuf},
    process::{Command, Output},
};

use mcap::{
    MessageStream, WriteOptions,
    records::{MessageHeader, Metadata},
};
use record::Log;
use whole_system_tests::{Scratch, bench::Ended, rcs_log};

use crate::table::{Chance, Extent, Outcome, Row};

const LIMIT: &str = "1048576"; // address space, kilobytes

const QUESTIONS: [(&str, &[&str]); 6] = [
    ("info", &["info"]),
    ("replay", &["replay"]),
    ("why", &["why"]),
    ("why --tick", &["why", "--tick", "60"]),
    ("page", &["page", "-o", "page.html"]),
    ("golden", &["golden", "-o", "goldens"]),
];

fn damage(chance: &mut Chance, bytes: &mut Vec<u8>) {
    for _ in 0..=chance.below(4) {
        let at = chance.place(bytes.len());
        let rest = bytes.len() - at;
        let length = chance.place(64).min(rest);
        match chance.below(7) {
            0 if rest > 0 => bytes[at] ^= 1 << chance.below(8),
            1 if rest > 0 => bytes[at] = chance.byte(),
            // A very large length or number.
            2 if rest >= 8 => {
                bytes[at..at + 8].copy_from_slice(&(u64::MAX >> chance.below(64)).to_le_bytes())
            }
            3 => drop(bytes.drain(at..at + length)),
            4 => drop(bytes.splice(at..at, vec![0xFF; length])),
            5 => bytes[at..at + length].fill(0),
            6 if chance.below(10) == 0 => bytes.truncate(at),
            _ => {}
        }
    }
}

/// Some damaged messages, in chunks with correct checksums.
fn forged(log: &[u8], whole: &Log, chance: &mut Chance) -> Vec<u8> {
    let mut writer = WriteOptions::new().create(Cursor::new(Vec::new())).expect("a log begins");
    let run = Metadata { name: "rcs-run".into(), metadata: whole.run.clone() };
    writer.write_metadata(&run).expect("it takes metadata");
    let mut channels = BTreeMap::new();
    let every = 1 + chance.below(400);
    for message in MessageStream::new(log).expect("it is a log") {
        let mcap::Message { channel, sequence, log_time, publish_time, data } = message.expect("it is whole");
        let id = *channels.entry(channel.id).or_insert_with(|| {
            let schema = channel.schema.as_ref().expect("every channel has a schema");
            let schema = writer.add_schema(&schema.name, &schema.encoding, &schema.data).expect("a schema");
            writer
                .add_channel(schema, &channel.topic, &channel.message_encoding, &channel.metadata)
                .expect("a channel")
        });
        let mut data = data.into_owned();
        if chance.below(every) == 0 {
            damage(chance, &mut data);
        }
        let header = MessageHeader { channel_id: id, sequence, log_time, publish_time };
        writer.write_to_known_channel(&header, &data).expect("it takes messages");
    }
    writer.finish().expect("it ends");
    writer.into_inner().into_inner()
}

fn limited(directory: &Path, arguments: &[&str], files: &[&Path]) -> Output {
    let mut command = Command::new("sh");
    command.args(["-c", "ulimit -v \"$0\" && exec \"$@\"", LIMIT]).arg(rcs_log());
    command.args(arguments).args(files).current_dir(directory).output().expect("sh runs")
}

/// The program must end by itself, with a sentence if it has no answer.
fn judge(output: &Output) -> Outcome {
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(!said.contains("panicked"), "{said}");
    match output.status.code() {
        Some(0) => Outcome::WentOn,
        Some(1) => Outcome::InOrder,
        Some(2) if said.contains("rcs-log: ") => Outcome::InWords,
        _ => panic!("{}: {said}", output.status),
    }
}

pub fn rows(extent: Extent) -> Vec<Row> {
    let scratch = Scratch::new("logs");
    let place = scratch.file("");
    let ended =
        Ended::run(&place, "linkbar", &["--ticks", "120", "--shared-memory", "off", "--log", "good.mcap"]);
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    let good: PathBuf = scratch.file("good.mcap");
    let bad = scratch.file("bad.mcap");
    let bytes = fs::read(&good).expect("a log");
    let whole = Log::open(&good).expect("a log");
    let all = extent.of(10_000, 120);
    let questions = u64::try_from(QUESTIONS.len()).expect("64 bits") + 1;
    let row = |name: &str, number: u64, ask: &dyn Fn() -> Output| {
        let attack = format!("`rcs-log {name}` of a damaged log");
        // Together they are the requested number.
        let cases = (0..all).skip(usize::try_from(number).expect("small")).step_by(questions as usize);
        Row::of(extent, &attack, "1 GB of memory", cases, |case, chance| {
            let damaged = if (case / questions).is_multiple_of(2) {
                forged(&bytes, &whole, chance)
            } else {
                let mut damaged = bytes.clone();
                damage(chance, &mut damaged);
                damaged
            };
            fs::write(&bad, damaged).expect("it can be written");
            judge(&ask())
        })
    };
    let mut rows: Vec<Row> = (0..)
        .zip(QUESTIONS)
        .map(|(number, (name, arguments))| row(name, number, &|| limited(&place, arguments, &[&bad])))
        .collect();
    rows.push(row("diff", questions - 1, &|| limited(&place, &["diff"], &[&good, &bad])));
    rows
}
