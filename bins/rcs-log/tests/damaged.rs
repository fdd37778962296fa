//! Damaged logs: whatever stands in the file, `rcs-log` answers or says why not, within a gigabyte of memory.
//!
//! ```text
//! DAMAGED_LOGS=10000 cargo test --release -p rcs-log --test damaged -- --nocapture
//! ```
//!
//! tries so many, 200 without it. Half are bytes that change in the file, half are messages that change in chunks whose checksums
//! are right: what only an intruder writes.

use std::{
    env,
    fs::{self, File},
    io::Cursor,
    path::{Path, PathBuf},
    process::{Command, Output},
};

use levels::ladder::Ladder;
use mcap::{MessageStream, WriteOptions, records::MessageHeader, records::Metadata};
use rcs_core::{
    interface::{CommonMemory, ExternalInputs},
    name::Name16,
    tick::Tick,
};
use record::{CellFrame, CellModel, End, Epoch, Log, Pace, Recorder, Setup, Timing};
use taskdata::files::TaskData;

const TICKS: u64 = 260;
/// Address space of the program, kilobytes.
const LIMIT: &str = "1048576";

/// A small run with everything that a log can have.
fn record(path: &Path) {
    let run = [("program", "test"), ("job", "nothing"), ("seed", "7")];
    let run = run.map(|(key, value)| (key.to_owned(), value.to_owned())).into();
    let setup = Setup { epoch: Epoch::Fixed, run, cell: Some(CellModel::default()), ..Setup::default() };
    let mut recorder = Recorder::start(path, Pace::Wait, setup).expect("the log begins");
    let (mut ladder, mut memory) = (Ladder::default(), CommonMemory::default());
    for tick in (1..=TICKS).map(Tick) {
        let mut external = ExternalInputs::default();
        external.devices.joystick.velocity = 1000;
        external.hws.number = u32::from(tick.0 >= 50);
        external.hws.command = Name16::new("TRANSFER").expect("a word");
        external.hws.object = Some(Name16::new("NOBODY").expect("a word"));
        let before = memory;
        ladder.step(tick, &before, &external, &TaskData::default(), &mut memory);
        recorder.cell(&CellFrame::new(tick).with_digest(tick.0));
        recorder.timing(Timing { controller_ns: 1000, skipped: 0 });
        recorder.tick(tick, &external, &memory, || ladder.state());
    }
    recorder.finish(End { result: "failed".into(), ..End::default() }).expect("the log ends");
}

/// Xorshift: the same damages in every run.
struct Chance(u64);

impl Chance {
    fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        usize::try_from(self.0 >> 11).unwrap() % limit.max(1)
    }

    /// Damage some bytes.
    fn damage(&mut self, bytes: &mut Vec<u8>) {
        for _ in 0..=self.below(4) {
            let at = self.below(bytes.len());
            let rest = bytes.len() - at;
            let length = self.below(64).min(rest);
            match self.below(7) {
                0 if rest > 0 => bytes[at] ^= 1 << self.below(8),
                1 if rest > 0 => bytes[at] = u8::try_from(self.below(256)).unwrap(),
                // A length or a number that is very large.
                2 if rest >= 8 => {
                    bytes[at..at + 8].copy_from_slice(&(u64::MAX >> self.below(64)).to_le_bytes())
                }
                3 => drop(bytes.drain(at..at + length)),
                4 => drop(bytes.splice(at..at, vec![0xFF; length])),
                5 => bytes[at..at + length].fill(0),
                6 if self.below(10) == 0 => bytes.truncate(at),
                _ => {}
            }
        }
    }
}

/// The log once more, with some messages damaged, in chunks with the right checksums.
fn forged(log: &[u8], whole: &Log, chance: &mut Chance) -> Vec<u8> {
    let mut writer = WriteOptions::new().create(Cursor::new(Vec::new())).unwrap();
    let run = Metadata { name: "rcs-run".into(), metadata: whole.run.clone() };
    writer.write_metadata(&run).unwrap();
    let mut channels = std::collections::BTreeMap::new();
    let every = 1 + chance.below(400);
    for message in MessageStream::new(log).unwrap() {
        let mcap::Message { channel, sequence, log_time, publish_time, data } = message.unwrap();
        let id = *channels.entry(channel.id).or_insert_with(|| {
            let schema = channel.schema.as_ref().unwrap();
            let schema = writer.add_schema(&schema.name, &schema.encoding, &schema.data).unwrap();
            writer.add_channel(schema, &channel.topic, &channel.message_encoding, &channel.metadata).unwrap()
        });
        let mut data = data.into_owned();
        if chance.below(every) == 0 {
            chance.damage(&mut data);
        }
        let header = MessageHeader { channel_id: id, sequence, log_time, publish_time };
        writer.write_to_known_channel(&header, &data).unwrap();
    }
    writer.finish().unwrap();
    writer.into_inner().into_inner()
}

/// `rcs-log` with little memory.
fn rcs_log(arguments: &[&str], files: &[&Path]) -> Output {
    let mut command = Command::new("sh");
    command.args(["-c", "ulimit -v \"$0\" && exec \"$@\"", LIMIT, env!("CARGO_BIN_EXE_rcs-log")]);
    command.args(arguments).args(files).output().expect("sh runs")
}

/// The program has ended by itself, with a sentence if it has no answer.
fn assert_answered(output: &Output, what: &str) -> i32 {
    let said = String::from_utf8_lossy(&output.stderr);
    let status = output.status.code();
    assert!(
        matches!(status, Some(0..=2)) && !said.contains("panicked"),
        "{what}: {:?}: {said}",
        output.status
    );
    assert!(status != Some(2) || said.contains("rcs-log: "), "{what}: no sentence: {said}");
    status.unwrap()
}

fn logs() -> u64 {
    env::var("DAMAGED_LOGS").map_or(200, |count| count.parse().expect("a number of logs"))
}

#[test]
fn a_damaged_log_is_answered_or_refused_in_words() {
    let place = tempfile::tempdir().unwrap();
    let (good, bad) = (place.path().join("good.mcap"), place.path().join("bad.mcap"));
    record(&good);
    let bytes = fs::read(&good).unwrap();
    let whole = Log::open(&good).unwrap();
    let html = place.path().join("page.html").display().to_string();
    let golden = place.path().join("goldens").display().to_string();
    let asked: [(&[&str], bool); 7] = [
        (&["info"], false),
        (&["why"], false),
        (&["why", "--tick", "60"], false),
        (&["replay"], false),
        (&["diff"], true),
        (&["report", "-o", &html], false),
        (&["golden", "-o", &golden], false),
    ];
    let mut statuses = [0_u64; 3];
    for seed in 1..=logs() {
        let mut chance = Chance(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15));
        let damaged = if seed % 2 == 0 {
            forged(&bytes, &whole, &mut chance)
        } else {
            let mut damaged = bytes.clone();
            chance.damage(&mut damaged);
            damaged
        };
        fs::write(&bad, damaged).unwrap();
        let (arguments, with_good) = asked[chance.below(asked.len())];
        let files: &[&Path] = if with_good { &[&good, &bad] } else { &[&bad] };
        let status = assert_answered(&rcs_log(arguments, files), &format!("seed {seed}, {arguments:?}"));
        statuses[usize::try_from(status).unwrap()] += 1;
    }
    println!("{} damaged logs: {statuses:?} ended with status 0, 1, 2", logs());
    assert!(statuses[0] > 0 && statuses[2] > 0, "{statuses:?}: the damages are too small or too large");
}

/// A log with a chunk in the middle whose bytes are changed, and the ticks in it.
fn with_a_bad_chunk(place: &Path) -> PathBuf {
    let path = place.join("middle.mcap");
    record(&path);
    let mut bytes = fs::read(&path).unwrap();
    let chunk = chunks(&bytes)[5];
    bytes[chunk + 200] ^= 0x55;
    fs::write(&path, bytes).unwrap();
    path
}

/// Where the chunks begin.
fn chunks(bytes: &[u8]) -> Vec<usize> {
    let (mut at, mut chunks) = (8, Vec::new());
    while at + 9 < bytes.len() {
        if bytes[at] == 6 {
            chunks.push(at);
        }
        at += 9 + usize::try_from(u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap())).unwrap();
    }
    chunks
}

#[test]
fn damage_in_the_middle_is_told_and_the_rest_is_read() {
    let place = tempfile::tempdir().unwrap();
    let path = with_a_bad_chunk(place.path());
    let output = rcs_log(&["info", "--json"], &[&path]);
    let info: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(info["missing_ticks"], 25, "{info}");
    assert_eq!((&info["ticks"], &info["complete"]), (&(TICKS - 25).into(), &true.into()));
    assert!(info["damage"].as_str().unwrap().contains("are damaged; what they held is missing"), "{info}");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("are damaged"), "{said}");
    let output = rcs_log(&["replay"], &[&path]);
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(
        output.status.success() && text.contains("ticks skipped") && text.contains("are damaged"),
        "{text}"
    );
}

#[test]
fn a_length_that_is_wrong_loses_one_chunk() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("length.mcap");
    record(&path);
    let mut bytes = fs::read(&path).unwrap();
    for wrong in [0_u64, 1 << 20, 1 << 40, u64::MAX] {
        let chunk = chunks(&fs::read(&path).unwrap())[5];
        bytes[chunk + 1..chunk + 9].copy_from_slice(&wrong.to_le_bytes());
        let log = Log::from_bytes(&path, bytes.clone()).unwrap();
        assert!(log.complete && log.end.is_some());
        assert_eq!(log.ticks().map(Result::unwrap).count(), 235, "length {wrong}");
    }
}

#[test]
fn only_regular_files_are_logs() {
    for file in ["/dev/zero", "/dev/stdin", "/"] {
        let output = rcs_log(&["info"], &[Path::new(file)]);
        assert_eq!(assert_answered(&output, file), 2);
    }
    // A file with a hole of a terabyte.
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("hole.mcap");
    File::create(&path).unwrap().set_len(1 << 40).unwrap();
    assert_eq!(assert_answered(&rcs_log(&["info"], &[&path]), "a hole"), 2);
}
