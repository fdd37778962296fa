//! Reads a log back.
//!
//! A program that was killed leaves a file without an end, perhaps with half a record in it. Everything
//! before the damage is read; that the file is not whole is told, and is no error.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use mcap::{
    McapError,
    read::{ChunkFlattener, LinearReader, Options},
    records::Record,
};
use rcs_core::tick::Tick;

use crate::{
    delta::Codec,
    error::ReadError,
    input::{Attachment, Link},
    layout,
    proto::{
        foxglove::{self, Level, Transform},
        wire::{Fields, Value},
    },
    scene::{TF, TF_STATIC},
    writer::{Codecs, END, LAYOUT, LOG_TOPIC, REPLAY, RUN, Timing, replay_field},
};

/// A log that was read.
pub struct Log {
    path: PathBuf,
    bytes: Vec<u8>,
    /// Metadata of the start: what run it was.
    pub run: BTreeMap<String, String>,
    /// Metadata of the end: how the run ended; none if the program was killed.
    pub end: Option<BTreeMap<String, String>>,
    /// Files that travelled in the log, in their order.
    pub attachments: Vec<Attachment>,
    /// The file has its end. If not, up to a second before the end of the run is missing.
    pub complete: bool,
}

/// A tick as it was recorded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LoggedTick {
    /// The tick.
    pub tick: Tick,
    /// Ticks that are missing before it.
    pub gap: u64,
    /// Byte image of [`ExternalInputs`].
    pub external: Vec<u8>,
    /// Byte image of [`CommonMemory`] after the tick.
    pub memory: Vec<u8>,
    /// Byte image of [`levels::ladder::LadderState`] after the tick, where it was recorded.
    pub state: Option<Vec<u8>>,
    /// Fingerprint of the simulated cell before the tick, where it was recorded.
    pub world: Option<u64>,
    /// How punctual the tick was, where it was recorded.
    pub timing: Option<Timing>,
}

/// A line on `/log`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LogLine {
    /// The tick.
    pub tick: Tick,
    /// How much it matters.
    pub level: Level,
    /// Who says it.
    pub source: String,
    /// The sentence.
    pub text: String,
}

impl Log {
    /// Read a log, whole or not.
    ///
    /// # Errors
    /// [`ReadError`] if the file is not a log. The layout is not looked at: see [`Log::check_layout`].
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        let unreadable = |source| ReadError::Unreadable { path: path.to_owned(), source };
        let bytes = std::fs::read(path).map_err(unreadable)?;
        let mut log = Self {
            path: path.to_owned(),
            bytes: Vec::new(),
            run: BTreeMap::new(),
            end: None,
            attachments: Vec::new(),
            complete: false,
        };
        let (mut is_log, mut first) = (false, true);
        // Chunks are passed over here: what is asked for stands between them.
        let outside = LinearReader::new_with_options(&bytes, Options::IgnoreEndMagic.into());
        for record in outside.map_err(|source| log.not_mcap(source))? {
            match record {
                Ok(Record::Metadata(metadata)) if metadata.name == RUN => {
                    (log.run, is_log) = (metadata.metadata, true);
                }
                Ok(Record::Metadata(metadata)) if metadata.name == END => log.end = Some(metadata.metadata),
                Ok(Record::Attachment { header, data, .. }) => {
                    let (name, media_type) = (header.name, header.media_type);
                    log.attachments.push(Attachment { name, media_type, data: data.into_owned() });
                }
                Ok(Record::Footer(_)) => log.complete = true,
                Ok(_) => {}
                Err(source) if first => return Err(log.not_mcap(source)),
                Err(_) => break,
            }
            first = false;
        }
        if !is_log {
            return Err(ReadError::NotALog { path: log.path });
        }
        log.bytes = bytes;
        Ok(log)
    }

    fn not_mcap(&self, source: McapError) -> ReadError {
        ReadError::NotMcap { path: self.path.clone(), source }
    }

    /// Bytes of the file.
    #[must_use]
    pub fn size(&self) -> usize {
        self.bytes.len()
    }

    /// Refuse a log whose byte images mean something else in this program.
    ///
    /// # Errors
    /// [`ReadError::OtherLayout`].
    pub fn check_layout(&self) -> Result<(), ReadError> {
        let expected = layout::version();
        let found = self.run.get(LAYOUT).cloned().unwrap_or_default();
        if found == expected {
            return Ok(());
        }
        let version = self.run.get("version").cloned().unwrap_or_default();
        Err(ReadError::OtherLayout { expected, found, version })
    }

    /// An attachment by its name.
    #[must_use]
    pub fn attachment(&self, name: &str) -> Option<&Attachment> {
        self.attachments.iter().find(|attachment| attachment.name == name)
    }

    /// The recorded ticks, in order, up to the end or the damage.
    pub fn ticks(&self) -> impl Iterator<Item = Result<LoggedTick, ReadError>> {
        let codecs = Codecs::new();
        let mut last = LoggedTick {
            tick: Tick::BEFORE_START,
            gap: 0,
            external: vec![0; codecs.external.size()],
            memory: vec![0; codecs.memory.size()],
            state: None,
            world: None,
            timing: None,
        };
        self.messages(REPLAY).map(move |(_, data)| {
            if advance(&codecs, &mut last, &data) {
                Ok(last.clone())
            } else {
                Err(ReadError::Damaged { tick: last.tick.0 })
            }
        })
    }

    /// The lines on `/log`, in order.
    pub fn lines(&self) -> impl Iterator<Item = LogLine> {
        self.messages(LOG_TOPIC).map(|(tick, data)| {
            let (level, source, text) = (Level::Info, String::new(), String::new());
            let mut line = LogLine { tick, level, source, text };
            for field in Fields(&data) {
                match field {
                    (2, Value::Number(code)) => line.level = Level::from_code(code),
                    (3, Value::Bytes(text)) => line.text = String::from_utf8_lossy(text).into_owned(),
                    (4, Value::Bytes(source)) => line.source = String::from_utf8_lossy(source).into_owned(),
                    _ => {}
                }
            }
            line
        })
    }

    /// The digests of the simulated cell, as the controller met it in each tick; none of a real one.
    pub fn cell_digests(&self) -> impl Iterator<Item = (Tick, u64)> {
        self.ticks().map_while(Result::ok).filter_map(|logged| Some((logged.tick, logged.world?)))
    }

    /// Where links are from a tick on, in the order of the log: what never moves first, then what moved in each
    /// tick.
    pub fn places(&self) -> impl Iterator<Item = (Tick, Vec<(Link, Transform)>)> {
        let fixed = self.messages(TF_STATIC);
        fixed.chain(self.messages(TF)).map(|(tick, data)| (tick, foxglove::take_transforms(&data)))
    }

    /// The messages of a topic with their ticks.
    pub fn messages(&self, topic: &str) -> impl Iterator<Item = (Tick, Vec<u8>)> {
        let topic = topic.to_owned();
        let mut channel = None;
        // `open` has been through the file: what stops here is its end, or its damage.
        let readable = records(&self.bytes).into_iter().flatten().map_while(Result::ok);
        readable.filter_map(move |record| match record {
            Record::Channel(found) if found.topic == topic => {
                channel = Some(found.id);
                None
            }
            Record::Message { header, data } if Some(header.channel_id) == channel => {
                Some((Tick(u64::from(header.sequence)), data.into_owned()))
            }
            _ => None,
        })
    }
}

fn records(bytes: &[u8]) -> Result<ChunkFlattener<'_>, McapError> {
    ChunkFlattener::new_with_options(bytes, Options::IgnoreEndMagic | Options::ValidateChunkCrcs)
}

/// Go on from one recorded tick to the next; false if the message does not fit.
fn advance(codecs: &Codecs, last: &mut LoggedTick, data: &[u8]) -> bool {
    let (mut full, mut sound) = (false, true);
    (last.state, last.world, last.timing) = (None, None, None);
    let number = |field: u32| u64::from(field);
    for (field, value) in Fields(data) {
        match value {
            Value::Number(value) if field == number(replay_field::TICK) => last.tick = Tick(value),
            Value::Number(value) if field == number(replay_field::GAP) => last.gap = value,
            Value::Number(value) if field == number(replay_field::FULL) => full = value != 0,
            Value::Bytes(delta) if field == number(replay_field::EXTERNAL) => {
                sound &= change(&codecs.external, &mut last.external, delta, full);
            }
            Value::Bytes(delta) if field == number(replay_field::MEMORY) => {
                sound &= change(&codecs.memory, &mut last.memory, delta, full);
            }
            Value::Bytes(delta) if field == number(replay_field::STATE) => {
                let mut state = vec![0; codecs.state.size()];
                sound &= codecs.state.apply(delta, &mut state);
                last.state = Some(state);
            }
            Value::Bytes(world) if field == number(replay_field::WORLD) => {
                last.world = world.try_into().map(u64::from_le_bytes).ok();
            }
            Value::Number(value) if field == number(replay_field::CONTROLLER_NS) => {
                last.timing.get_or_insert_default().controller_ns = value;
            }
            Value::Number(value) if field == number(replay_field::SKIPPED) => {
                last.timing.get_or_insert_default().skipped = value;
            }
            _ => {}
        }
    }
    sound
}

fn change(codec: &Codec, image: &mut [u8], delta: &[u8], full: bool) -> bool {
    if full {
        image.fill(0);
    }
    codec.apply(delta, image)
}
