//! Reads a log, which may be incomplete or damaged.
//!
//! All readable data of a killed or damaged log are read ([`crate::pieces`]). Images are differences, so after damage
//! the ticks continue with the next whole images, once per second. Missing parts are reported, but are not an error.

use std::{
    borrow::Borrow,
    collections::BTreeMap,
    io::Read,
    iter,
    ops::Range,
    path::{Path, PathBuf},
};

use mcap::{McapError, records::Record};
use os_io::files;
use os_io::text::amount;
use rcs_core::tick::Tick;

use crate::{
    delta::Codec,
    described::Described,
    error::ReadError,
    input::Attachment,
    layout,
    lossless::{Codecs, replay_field},
    names::{END, LAYOUT, LOG_TOPIC, REPLAY, RUN},
    operator::{OPERATOR, OperatorLine},
    pieces::{self, Damage, Decoder, Message, Piece, Pieces},
    proto::{
        foxglove::{self, Level, Link, Transform},
        wire::{Fields, Value},
    },
    scene::{TF, TF_STATIC},
    tap::Tap,
    writer::Timing,
};

const HEAD: u64 = 8; // size of the magic of an MCAP file, bytes

pub struct Log {
    path: PathBuf,
    bytes: Vec<u8>,
    segments: Vec<Segment>,
    channels: BTreeMap<String, u16>,
    described: Described,              // channels and schemas of the file, by number
    pub run: BTreeMap<String, String>, // facts of the run, from its start
    /// Metadata of the end: the ending of the run; `None` if the program was killed.
    pub end: Option<BTreeMap<String, String>>,
    pub attachments: Vec<Attachment>, // in order
    /// True if the file has its end. Otherwise at most the last second of the run is missing.
    pub complete: bool,
}

enum Segment {
    /// A chunk with the channels of its messages; an empty list if they are uncertain.
    Chunk(Range<usize>, Vec<u16>),
    Loose(Range<usize>),
    Damaged(Range<usize>, Damage),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LoggedTick {
    pub tick: Tick,
    pub gap: u64,               // missing ticks before it
    pub external: Vec<u8>,      // of [`interfaces::ExternalInputs`]
    pub memory: Vec<u8>,        // of [`interfaces::CommonMemory`], after the tick
    pub state: Option<Vec<u8>>, // of [`levels::ladder::LadderState`], if recorded
    pub world: Option<u64>,     // digest before the tick, if recorded
    pub timing: Option<Timing>, // if recorded
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LogLine {
    pub tick: Tick,
    pub level: Level,
    pub source: String,
    pub text: String,
    /// Code of the event, such as `cell.dropped`, or source file of the decision table; empty if there is neither.
    pub code: String,
}

impl Log {
    /// Read a log, which may be incomplete or damaged; its layout is not checked ([`Log::check_layout`]).
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        let unreadable = |source| ReadError::Unreadable { path: path.to_owned(), source };
        let mut file = files::open(path).map_err(unreadable)?;
        // The magic is checked before the rest, which may be long, is read into memory.
        let mut bytes = Vec::new();
        file.by_ref().take(HEAD).read_to_end(&mut bytes).map_err(unreadable)?;
        if bytes == mcap::MAGIC {
            file.read_to_end(&mut bytes).map_err(unreadable)?;
        }
        Self::from_bytes(path, bytes)
    }

    /// A log from the bytes of a file; `path` names it in errors. Fails like [`Log::open`].
    pub fn from_bytes(path: &Path, bytes: Vec<u8>) -> Result<Self, ReadError> {
        let mut log = Self {
            path: path.to_owned(),
            bytes: Vec::new(),
            segments: Vec::new(),
            channels: BTreeMap::new(),
            described: Described::default(),
            run: BTreeMap::new(),
            end: None,
            attachments: Vec::new(),
            complete: false,
        };
        let mut is_log = false;
        let pieces = Pieces::new(&bytes).map_err(|source| log.not_mcap(source))?;
        let is_whole = pieces.is_whole();
        for piece in pieces {
            match piece {
                Piece::Chunk(range, described) => {
                    described.iter().for_each(|record| log.note(record));
                    log.segments.push(Segment::Chunk(range, Vec::new()));
                }
                Piece::Index(channel) => {
                    if let Some(Segment::Chunk(_, channels)) = log.segments.last_mut().filter(|_| is_whole) {
                        channels.push(channel);
                    }
                }
                Piece::Loose(range) => log.segments.push(Segment::Loose(range)),
                Piece::Damaged(range, damage) => log.segments.push(Segment::Damaged(range, damage)),
                Piece::Record(Record::Metadata(metadata)) if metadata.name == RUN => {
                    if is_log && log.run != metadata.metadata {
                        return Err(ReadError::Merged { path: log.path });
                    }
                    (log.run, is_log) = (metadata.metadata, true);
                }
                Piece::Record(Record::Metadata(metadata)) if metadata.name == END => {
                    log.end = Some(metadata.metadata);
                }
                Piece::Record(Record::Attachment { header, data, .. }) => {
                    let (name, media_type) = (header.name, header.media_type);
                    log.attachments.push(Attachment { name, media_type, data: data.into_owned() });
                }
                Piece::Record(Record::Footer(_)) => log.complete = true,
                Piece::Record(record) => log.note(&record),
            }
        }
        // A killed program leaves an incomplete record at the end, which is not damage.
        let half = |segment: &mut Segment| matches!(segment, Segment::Damaged(range, Damage::Bytes) if range.end == bytes.len());
        if !log.complete {
            log.segments.pop_if(half);
        }
        if !is_log {
            return Err(match log.damage() {
                Some(_) => ReadError::HeadDamaged { path: log.path },
                None if bytes.len() == mcap::MAGIC.len() => log.not_mcap(McapError::UnexpectedEof),
                None => ReadError::NotALog { path: log.path },
            });
        }
        log.bytes = bytes;
        Ok(log)
    }

    fn note(&mut self, record: &Record<'_>) {
        self.described.note(record);
        if let Record::Channel(channel) = record {
            self.channels.entry(channel.topic.clone()).or_insert(channel.id);
        }
    }

    fn not_mcap(&self, source: McapError) -> ReadError {
        ReadError::NotMcap { path: self.path.clone(), source }
    }

    /// The damaged parts of the file, as text, if any.
    #[must_use]
    pub fn damage(&self) -> Option<String> {
        let damaged = |segment: &Segment| match segment {
            Segment::Damaged(range, damage) => {
                Some(format!("{} from byte {}: {damage}", amount(range.len(), "byte"), range.start))
            }
            Segment::Chunk(..) | Segment::Loose(_) => None,
        };
        let places: Vec<String> = self.segments.iter().filter_map(damaged).collect();
        let (first, more) = (places.first()?, places.len().saturating_sub(1));
        Some(match more {
            0 => format!("{first}; their contents are missing"),
            1 => format!("{first}, and 1 more place cannot be read; their contents are missing"),
            _ => format!("{first}, and {more} more places cannot be read; their contents are missing"),
        })
    }

    #[must_use]
    pub fn size(&self) -> usize {
        self.bytes.len()
    }

    /// Check that the byte images have the layout of this program.
    pub fn check_layout(&self) -> Result<(), ReadError> {
        let expected = layout::version();
        let found = self.run.get(LAYOUT).cloned().unwrap_or_default();
        if found == expected {
            return Ok(());
        }
        let version = self.run.get("version").cloned().unwrap_or_default();
        Err(ReadError::OtherLayout { expected, found, version })
    }

    #[must_use]
    pub fn attachment(&self, name: &str) -> Option<&Attachment> {
        self.attachments.iter().find(|attachment| attachment.name == name)
    }

    /// The recorded ticks, in order, up to the end or the damage.
    pub fn ticks(&self) -> impl Iterator<Item = Result<LoggedTick, ReadError>> {
        let mut ticks = self.ticks_from(0, Codecs::new());
        iter::from_fn(move || ticks.advance().map(|read| read.map(|(_, logged)| logged.clone())))
    }

    /// The number of parts of the file with messages, about two per second of the run.
    pub(crate) const fn parts(&self) -> usize {
        self.segments.len()
    }

    /// True if a part of the file from this one on is damaged.
    pub(crate) fn is_damaged_from(&self, part: usize) -> bool {
        self.segments.iter().skip(part).any(|segment| matches!(segment, Segment::Damaged(..)))
    }

    /// The recorded ticks from the first whole images in a part of the file on.
    pub(crate) fn ticks_from<C: Borrow<Codecs>>(
        &self,
        first: usize,
        codecs: C,
    ) -> Ticks<C, impl Iterator<Item = Item>> {
        let sizes = codecs.borrow();
        let last = LoggedTick {
            tick: Tick::BEFORE_START,
            gap: 0,
            external: vec![0; sizes.external.size()],
            memory: vec![0; sizes.memory.size()],
            state: None,
            world: None,
            timing: None,
        };
        Ticks { items: self.items(REPLAY, first), codecs, last, has_base: first == 0 }
    }

    pub fn lines(&self) -> impl Iterator<Item = LogLine> {
        self.messages(LOG_TOPIC).map(|(tick, data)| {
            let (source, text, code) = Default::default();
            let mut line = LogLine { tick, level: Level::Info, source, text, code };
            for field in Fields(&data) {
                match field {
                    (2, Value::Number(code)) => line.level = Level::from_code(code),
                    (3, Value::Bytes(text)) => line.text = String::from_utf8_lossy(text).into_owned(),
                    (4, Value::Bytes(source)) => line.source = String::from_utf8_lossy(source).into_owned(),
                    (5, Value::Bytes(code)) => line.code = String::from_utf8_lossy(code).into_owned(),
                    _ => {}
                }
            }
            line
        })
    }

    pub fn operator_lines(&self) -> impl Iterator<Item = OperatorLine> {
        self.messages(OPERATOR).map(|(tick, data)| OperatorLine::decode(tick, &data))
    }

    /// The last tick of the log; `None` without ticks.
    #[must_use]
    pub fn last_tick(&self) -> Option<Tick> {
        self.messages(REPLAY).last().map(|(tick, _)| tick)
    }

    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The digests of the simulated cell at the start of each tick; empty for a real cell.
    pub fn cell_digests(&self) -> impl Iterator<Item = (Tick, u64)> {
        self.ticks().map_while(Result::ok).filter_map(|logged| Some((logged.tick, logged.world?)))
    }

    /// Positions of links, in the order of the log: first the fixed links, then those that moved in each tick.
    pub fn places(&self) -> impl Iterator<Item = (Tick, Vec<(Link, Transform)>)> {
        let fixed = self.messages(TF_STATIC);
        fixed.chain(self.messages(TF)).map(|(tick, data)| (tick, foxglove::take_transforms(&data)))
    }

    /// Pass the channels to a tap, except those without a schema.
    pub fn send_channels(&self, tap: &mut dyn Tap) {
        self.described.tell(tap);
    }

    /// Pass all messages to a tap, by time. `before` receives the time of each, ns since 1970, and may wait.
    pub fn play(&self, tap: &mut dyn Tap, mut before: impl FnMut(u64)) {
        let mut decoder = Decoder::default();
        let mut waiting: Vec<(u64, u16, Vec<u8>)> = Vec::new();
        for (segment, next) in iter::zip(&self.segments, self.next_times()) {
            let messages = self.messages_in(segment, &mut decoder).into_iter().flatten();
            waiting
                .extend(messages.map(|message| (message.log_time, message.channel, message.data.to_vec())));
            waiting.sort_by_key(|(time, ..)| *time);
            let due = waiting.partition_point(|(time, ..)| *time < next);
            for (time, channel, data) in waiting.drain(..due) {
                before(time);
                tap.message(channel, time, &data);
            }
        }
    }

    /// For each part of the file, the time of the next message after it: nanoseconds since 1970.
    fn next_times(&self) -> Vec<u64> {
        let begins = self.segments.iter().rev().map(|segment| self.begin(segment));
        let mut times: Vec<u64> = begins
            .scan(u64::MAX, |next, begin| Some(std::mem::replace(next, begin.unwrap_or(u64::MAX).min(*next))))
            .collect();
        times.reverse();
        times
    }

    pub fn messages(&self, topic: &str) -> impl Iterator<Item = (Tick, Vec<u8>)> {
        self.items(topic, 0).filter_map(|(_, message)| message)
    }

    /// The messages of a topic from a part on, with their ticks, or `None` at damage, and the number of their part.
    fn items(&self, topic: &str, first: usize) -> impl Iterator<Item = Item> + use<'_> {
        let id = self.channels.get(topic).copied();
        let mut decoder = Decoder::default();
        self.segments.iter().enumerate().skip(first).flat_map(move |(part, segment)| {
            match segment {
                Segment::Damaged(..) => return vec![(part, None)],
                Segment::Chunk(_, known)
                    if !known.is_empty() && !id.is_some_and(|id| known.contains(&id)) =>
                {
                    return Vec::new();
                }
                Segment::Chunk(..) | Segment::Loose(_) => {}
            }
            // A chunk of a whole file is checked only here.
            let Some(messages) = self.messages_in(segment, &mut decoder) else { return vec![(part, None)] };
            let of_topic = messages.filter(|message| Some(message.channel) == id);
            let item = |message: Message<'_>| (Tick(u64::from(message.sequence)), message.data.to_vec());
            of_topic.map(|message| (part, Some(item(message)))).collect()
        })
    }

    /// The messages of a chunk; `None` for an unreadable or damaged part.
    fn messages_in<'a>(
        &'a self,
        segment: &Segment,
        decoder: &'a mut Decoder,
    ) -> Option<impl Iterator<Item = Message<'a>> + use<'a>> {
        let records = match segment {
            Segment::Chunk(range, _) => decoder.unpack(self.bytes.get(range.clone())?)?,
            Segment::Loose(range) => self.bytes.get(range.clone())?,
            Segment::Damaged(..) => return None,
        };
        Some(pieces::messages(records))
    }

    fn begin(&self, segment: &Segment) -> Option<u64> {
        match segment {
            Segment::Chunk(range, _) => pieces::chunk_begin(self.bytes.get(range.clone())?),
            Segment::Loose(range) => {
                pieces::messages(self.bytes.get(range.clone())?).next().map(|it| it.log_time)
            }
            Segment::Damaged(..) => None,
        }
    }
}

/// A message with its tick, or `None` at damage, and the number of its part of the file.
type Item = (usize, Option<(Tick, Vec<u8>)>);

pub(crate) struct Ticks<C, I> {
    items: I,
    codecs: C,
    last: LoggedTick,
    has_base: bool, // true if the last tick can be the base of the next message's differences
}

impl<C: Borrow<Codecs>, I: Iterator<Item = Item>> Ticks<C, I> {
    /// The next tick, with the number of its part of the file.
    pub(crate) fn advance(&mut self) -> Option<Result<(usize, &LoggedTick), ReadError>> {
        loop {
            let (part, item) = self.items.next()?;
            let Some((_, data)) = item else {
                self.has_base = false;
                continue;
            };
            self.has_base |= is_full(&data);
            if !self.has_base {
                continue;
            }
            let before = self.last.tick;
            let sound = advance(self.codecs.borrow(), &mut self.last, &data);
            let tick = self.last.tick;
            if !sound || tick <= before || tick.0 > u64::from(u32::MAX) {
                return Some(Err(ReadError::Damaged { tick: tick.0 }));
            }
            self.last.gap = tick.since(before).saturating_sub(1);
            return Some(Ok((part, &self.last)));
        }
    }
}

/// True if a message on [`REPLAY`] contains whole images.
fn is_full(data: &[u8]) -> bool {
    Fields(data).any(|(field, value)| {
        matches!(value, Value::Number(full) if field == u64::from(replay_field::FULL) && full != 0)
    })
}

/// Apply the message of the next tick to the last tick. Returns false if the message does not fit.
fn advance(codecs: &Codecs, last: &mut LoggedTick, data: &[u8]) -> bool {
    let (mut full, mut sound) = (false, true);
    (last.state, last.world, last.timing) = (None, None, None);
    let number = |field: u32| u64::from(field);
    for (field, value) in Fields(data) {
        match value {
            Value::Number(value) if field == number(replay_field::TICK) => last.tick = Tick(value),
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
