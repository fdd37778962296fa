//! A run as a small file to keep with the source: its inputs, and fingerprints of its outputs.
//!
//! A golden has the inputs of the ladder as one column per field, the task data, and the digest of all output buffers
//! after each second. Its replay finds the second in which the present program first differs, and writes a [`Summary`]
//! as a text for review.
//!
//! ```text
//!  run --log--> golden::from_log --> NAME.golden, NAME.txt    once, by a command
//!  golden::read --> replay --> same digests, same text?       in every test
//! ```

mod columns;
mod summary;

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use interfaces::{CommonMemory, ExternalInputs};
use levels::ladder::Ladder;
use os_io::{files, replace::replace};
use prost::Message as _;
use rcs_core::{
    Plain as _,
    digest::Digest,
    plain::from_bytes,
    tick::{TICK_MS, Tick},
};
use taskdata::load::Store;

pub use summary::Summary;

use self::columns::{Columns, Reader};
use crate::{
    error::{ReadError, ReplayError},
    input::Attachment,
    layout,
    reader::Log,
    replay::{generations_of, log_sources},
};

const MAGIC: [u8; 8] = *b"RCSGOLD\x01";
/// Level of the compression. It is high, because a golden is written once and read a thousand times.
const COMPRESSION: i32 = 19;
const LARGEST: usize = 1 << 30; // greatest size of an unpacked golden, bytes: a day of running is less
const FILE: u64 = 1 << 28; // largest file of a golden, bytes
/// Ticks from one digest to the next: a second.
pub const SECOND: u64 = 25;
pub const EXTENSION: &str = "golden";

#[derive(Clone, PartialEq, prost::Message)]
struct Content {
    #[prost(string, tag = "1")]
    layout: String, // of the images of inputs and outputs
    #[prost(btree_map = "string, string", tag = "2")]
    run: BTreeMap<String, String>,
    /// Task data and reloads, under their names in the log.
    #[prost(message, repeated, tag = "3")]
    files: Vec<File>,
    #[prost(uint64, tag = "4")]
    ticks: u64,
    #[prost(bytes = "vec", repeated, tag = "5")]
    columns: Vec<Vec<u8>>, // one per field
    /// Digest of all ticks so far, after each second and after the last tick.
    #[prost(fixed64, repeated, tag = "6")]
    digests: Vec<u64>,
}

#[derive(Clone, PartialEq, prost::Message)]
struct File {
    #[prost(string, tag = "1")]
    name: String,
    #[prost(string, tag = "2")]
    text: String,
}

#[derive(Clone, PartialEq)]
pub struct Golden(Content);

#[derive(Debug, thiserror::Error)]
pub enum GoldenError {
    #[error("{}: {source}", path.display())]
    File { path: PathBuf, source: std::io::Error },
    #[error("{} is not a golden run of this format: {what}", path.display())]
    NotAGolden { path: PathBuf, what: String },
    #[error(
        "the golden was made with layout {found}, this program has layout {expected}: make it again from a run"
    )]
    OtherLayout { expected: String, found: String },
    #[error("the log cannot become a golden: {0}")]
    NotWhole(&'static str),
    #[error("the inputs of tick {tick} are damaged")]
    Damaged { tick: u64 },
    #[error(transparent)]
    Log(#[from] ReadError),
    #[error(transparent)]
    Replay(#[from] ReplayError),
}

#[derive(Clone, Debug)]
pub struct Played {
    pub ticks: u64,
    /// First and last tick of the first second with different output buffers, if any.
    pub difference: Option<(u64, u64)>,
    pub digest: Digest,
    pub summary: String,
    pub elapsed: Duration,
}

impl Played {
    /// Ratio of the run's duration in real time to the time of the replay.
    #[must_use]
    pub fn speed(&self) -> f64 {
        let simulated = Duration::from_millis(self.ticks.saturating_mul(TICK_MS));
        simulated.as_secs_f64() / self.elapsed.as_secs_f64().max(1e-9)
    }
}

pub fn read(path: &Path) -> Result<Golden, GoldenError> {
    let bytes =
        files::read(path, FILE).map_err(|source| GoldenError::File { path: path.to_owned(), source })?;
    let wrong = |what: String| GoldenError::NotAGolden { path: path.to_owned(), what };
    let packed = bytes.strip_prefix(&MAGIC).ok_or_else(|| wrong("it does not begin like one".into()))?;
    let content = zstd::bulk::decompress(packed, LARGEST).map_err(|error| wrong(error.to_string()))?;
    let content = Content::decode(content.as_slice()).map_err(|error| wrong(error.to_string()))?;
    let (expected, found) = (layout::interface_version(), content.layout.clone());
    if expected != found {
        return Err(GoldenError::OtherLayout { expected, found });
    }
    Ok(Golden(content))
}

pub fn write(golden: &Golden, path: &Path) -> Result<(), GoldenError> {
    let failed = |source| GoldenError::File { path: path.to_owned(), source };
    let mut bytes = MAGIC.to_vec();
    let packed = zstd::bulk::compress(&golden.0.encode_to_vec(), COMPRESSION).map_err(failed)?;
    bytes.extend_from_slice(&packed);
    replace(path, &bytes).map_err(failed)
}

/// Make a golden of the log of a whole run. Fails if the log has gaps or no end, or cannot be read.
pub fn from_log(log: &Log) -> Result<Golden, GoldenError> {
    log.check_layout()?;
    if !log.complete {
        return Err(GoldenError::NotWhole("it has no end"));
    }
    if log.damage().is_some() {
        return Err(GoldenError::NotWhole("it is damaged"));
    }
    let mut columns = Columns::new(ExternalInputs::STRUCT);
    let (mut digest, mut digests, mut ticks) = (Digest::new(), Vec::new(), 0_u64);
    for logged in log.ticks() {
        let logged = logged?;
        ticks += 1;
        if logged.tick.0 != ticks {
            return Err(GoldenError::NotWhole("ticks are missing"));
        }
        columns.add(&logged.external);
        digest.add(&logged.memory);
        if ticks.is_multiple_of(SECOND) {
            digests.push(digest.value());
        }
    }
    if !ticks.is_multiple_of(SECOND) {
        digests.push(digest.value());
    }
    let recorded = log.end.as_ref().and_then(|end| end.get("digest"));
    if recorded.is_some_and(|recorded| *recorded != digest.to_string()) {
        return Err(GoldenError::NotWhole("its digest is not that of its ticks"));
    }
    let wanted = |attachment: &&Attachment| {
        attachment.name.starts_with(Attachment::TASK_DATA) || attachment.name.starts_with(Attachment::RELOAD)
    };
    let file = |attachment: &Attachment| File {
        name: attachment.name.clone(),
        text: String::from_utf8_lossy(&attachment.data).into_owned(),
    };
    Ok(Golden(Content {
        layout: layout::interface_version(),
        run: kept(&log.run),
        files: log.attachments.iter().filter(wanted).map(file).collect(),
        ticks,
        columns: columns.finish(),
        digests,
    }))
}

/// The metadata that a golden keeps. They define the run, and exclude its time and directory.
fn kept(run: &BTreeMap<String, String>) -> BTreeMap<String, String> {
    let keys = ["job", "seed", "faults"];
    run.iter()
        .filter(|(key, _)| keys.contains(&key.as_str()))
        .map(|(key, value)| (key.clone(), value.clone()))
        .collect()
}

impl Golden {
    #[must_use]
    pub const fn ticks(&self) -> u64 {
        self.0.ticks
    }

    #[must_use]
    pub const fn run(&self) -> &BTreeMap<String, String> {
        &self.0.run
    }

    #[must_use]
    pub fn digest(&self) -> u64 {
        self.0.digests.last().copied().unwrap_or_default()
    }

    /// The task data of the run, in the order in which they were loaded, and after each reload.
    pub fn data(&self) -> Result<Vec<Store>, ReplayError> {
        let attachment = |file: &File| Attachment::text(&file.name, &file.text);
        let attachments: Vec<Attachment> = self.0.files.iter().map(attachment).collect();
        generations_of(log_sources(&attachments), &attachments)
    }

    pub fn inputs(&self) -> impl Iterator<Item = Result<(Tick, ExternalInputs), GoldenError>> {
        let mut reader = Reader::new(ExternalInputs::STRUCT, &self.0.columns);
        (1..=self.0.ticks).map(move |tick| {
            let image = reader.next_image().ok_or(GoldenError::Damaged { tick })?;
            let external = from_bytes(image).map_err(|_| GoldenError::Damaged { tick })?;
            Ok((Tick(tick), external))
        })
    }
}

/// Run the present program on the inputs of a golden, with its task data. A difference is part of the result.
pub fn replay(golden: &Golden) -> Result<Played, GoldenError> {
    replay_with(golden, &golden.data()?)
}

/// Like [`replay`], with other task data: one store per generation.
pub fn replay_with(golden: &Golden, data: &[Store]) -> Result<Played, GoldenError> {
    let started = Instant::now();
    let (mut ladder, mut memory, mut digest) = (Ladder::default(), CommonMemory::default(), Digest::new());
    let mut scratch = vec![0; CommonMemory::SIZE];
    let mut summary = Summary::new(golden.run());
    let mut difference = None;
    for step in golden.inputs() {
        let (tick, external) = step?;
        let missing = ReplayError::Generation { tick: tick.0, generation: external.generation };
        let store = usize::try_from(external.generation).ok().and_then(|at| data.get(at)).ok_or(missing)?;
        let before = memory;
        ladder.step(tick, &before, &external, &store.view(), &mut memory);
        digest.add_record(&memory, &mut scratch);
        summary.observe(tick, &external, &before, &memory);
        let last = tick.0 == golden.ticks();
        if difference.is_none() && (last || tick.0.is_multiple_of(SECOND)) {
            let second = tick.0.div_ceil(SECOND);
            let at = usize::try_from(second - 1).ok();
            let recorded = at.and_then(|at| golden.0.digests.get(at));
            if recorded != Some(&digest.value()) {
                difference = Some(((second - 1) * SECOND + 1, tick.0));
            }
        }
    }
    let (ticks, elapsed) = (golden.ticks(), started.elapsed());
    Ok(Played { ticks, difference, digest, summary: summary.text(digest), elapsed })
}
