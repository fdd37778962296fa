//! Splits a log file, which may be damaged, into pieces.
//!
//! Every length is checked against the size of the file before use. An unreadable piece ends at the next readable
//! record with the right checksum. The total of decompressed bytes, and with it memory and time, is limited. Logs that
//! other programs have rewritten are also read; damage in a part without a checksum may remain undetected.
//!
//! A whole file has the right checksums at its end, and its chunks are decompressed only when read. In other files the
//! checksum of each chunk decides whether it is readable; all processors check the first chunks ahead. Decompressed
//! data are not kept, because decompressing them again is as fast as reading them from memory.

use std::{collections::BTreeMap, io::Read as _, iter, ops::Range, thread};

use lz4_flex::frame::FrameDecoder;
use mcap::{
    MAGIC, McapError, McapResult, parse_record,
    records::{Record, op},
};
use zstd::bulk::Decompressor;

use crate::names::{END, RUN};

const HEAD: usize = 9; // size of a record's header, bytes: operation code and length
/// Largest decompressed size of a chunk, bytes. Other programs write chunks of some tens of megabytes.
const CHUNK: u64 = 64 << 20;
const LOOSE: usize = 1 << 18; // messages outside chunks are read in parts of about this size, bytes
/// Largest ratio of decompressed bytes to bytes of the file. The recorder's chunks have a ratio of two to eleven.
const EXPANSION: u64 = 64;
const LEAST: u64 = 64 << 20; // limit of decompressed bytes for small files
/// Limit of bytes that are checked ahead, about a quarter of an hour. It limits the memory for channels and schemas.
const AHEAD: u64 = 64 << 20;
const FOOTER: usize = 20; // size of the body of the last record, bytes
const CHECKSUM: usize = 4; // bytes
/// Size of the data before those of a message, bytes: channel, number, and two times.
const MESSAGE_HEAD: usize = 22;

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Damage {
    #[error("damaged")]
    Bytes,
    #[error("compressed with {0:?}, and only zstd, lz4 or no compression can be read")]
    Compression(String),
    #[error("a chunk of {0} bytes, and only chunks of at most {CHUNK} bytes can be read")]
    TooLarge(u64),
}

pub enum Piece<'a> {
    Record(Record<'a>),
    /// A chunk with its channels and schemas. A whole file repeats them after its data.
    Chunk(Range<usize>, Vec<Record<'static>>),
    Loose(Range<usize>),
    /// The previous chunk has messages of this channel.
    Index(u16),
    Damaged(Range<usize>, Damage),
}

pub struct Pieces<'a> {
    bytes: &'a [u8],
    is_whole: bool,
    at: usize,
    left: u64, // number of bytes that may still be decompressed or checksummed
    decoder: Decoder,
    /// Channels and schemas of the chunks that were checked ahead, by their positions; `None` for an unreadable one.
    ahead: BTreeMap<usize, Option<Vec<Record<'static>>>>,
}

impl<'a> Pieces<'a> {
    /// The pieces of a file. Fails with [`McapError::BadMagic`] if the file does not begin like MCAP.
    pub fn new(bytes: &'a [u8]) -> McapResult<Self> {
        if !bytes.starts_with(MAGIC) {
            return Err(McapError::BadMagic);
        }
        let size = u64::try_from(bytes.len()).unwrap_or(u64::MAX);
        let left = size.saturating_mul(EXPANSION).saturating_add(LEAST);
        let is_whole = is_whole(bytes).unwrap_or_default();
        let ahead = if is_whole { BTreeMap::new() } else { ahead(bytes) };
        let (at, decoder) = (MAGIC.len(), Decoder::default());
        Ok(Self { bytes, is_whole, at, left, decoder, ahead })
    }

    /// True if the file has the right checksums at its end, with its channels and schemas.
    pub const fn is_whole(&self) -> bool {
        self.is_whole
    }

    /// The record that begins at a position, and its end; `None` if it is unreadable.
    fn piece(&mut self, at: usize) -> Option<(Piece<'a>, usize)> {
        let (opcode, end) = frame(self.bytes, at)?;
        let body = self.bytes.get(at.checked_add(HEAD)?..end)?;
        let piece = match opcode {
            op::CHUNK => {
                let chunk = self.bytes.get(at..end)?;
                self.spend(chunk_size(chunk)?)?;
                let described = match self.ahead.remove(&at) {
                    Some(described) => described?,
                    None if self.is_whole => Packed::of(chunk).map(|_| Vec::new()).ok()?,
                    None => described(self.decoder.unpack(chunk)?)?,
                };
                Piece::Chunk(at..end, described)
            }
            op::ATTACHMENT => {
                self.spend(u64::try_from(body.len()).ok()?)?;
                Piece::Record(parse(opcode, body)?)
            }
            op::MESSAGE => {
                Message::of(body)?;
                let end = messages_end(self.bytes, at);
                return Some((Piece::Loose(at..end), end));
            }
            op::MESSAGE_INDEX => Piece::Index(u16::from_le_bytes(*body.first_chunk()?)),
            // This is the last record. After it the file ends with the magic of its beginning.
            op::FOOTER if self.bytes.get(end..) != Some(MAGIC) => return None,
            op::HEADER..=op::DATA_END => Piece::Record(parse(opcode, body)?),
            _ => return None,
        };
        Some((piece, end))
    }

    fn spend(&mut self, bytes: u64) -> Option<()> {
        self.left = self.left.checked_sub(bytes)?;
        Some(())
    }

    /// The next position from `from` at which a record certainly begins, or the end of the file.
    fn next_good(&mut self, from: usize) -> usize {
        let bytes = self.bytes;
        let surely = |piece: &Piece<'_>| match piece {
            Piece::Chunk(range, _) => bytes
                .get(range.clone())
                .and_then(|chunk| Packed::of(chunk).ok())
                .is_some_and(|it| it.checksum != 0),
            Piece::Record(Record::Attachment { crc, .. }) => *crc != 0,
            Piece::Record(Record::Metadata(metadata)) => metadata.name == RUN || metadata.name == END,
            Piece::Record(_) | Piece::Index(_) | Piece::Loose(_) | Piece::Damaged(..) => false,
        };
        let end = self.bytes.len();
        let begins =
            |bytes: &[u8], at| matches!(bytes.get(at), Some(&(op::CHUNK | op::ATTACHMENT | op::METADATA)));
        (from..end)
            .find(|at| begins(self.bytes, *at) && self.piece(*at).is_some_and(|(piece, _)| surely(&piece)))
            .unwrap_or(end)
    }
}

impl<'a> Iterator for Pieces<'a> {
    type Item = Piece<'a>;

    fn next(&mut self) -> Option<Self::Item> {
        let begin = self.at;
        if begin >= self.bytes.len() {
            return None;
        }
        let piece = if let Some((piece, end)) = self.piece(begin) {
            self.at = if matches!(piece, Piece::Record(Record::Footer(_))) { self.bytes.len() } else { end };
            piece
        } else {
            let (damage, after) =
                unreadable(self.bytes, begin).unwrap_or((Damage::Bytes, begin.saturating_add(1)));
            self.at = if damage == Damage::Bytes { self.next_good(after) } else { after };
            Piece::Damaged(begin..self.at, damage)
        };
        Some(piece)
    }
}

fn messages_end(bytes: &[u8], from: usize) -> usize {
    let is_message = |(_, opcode, _): &(usize, u8, usize)| *opcode == op::MESSAGE;
    let row =
        frames(bytes, from).take_while(is_message).take_while(|(at, ..)| at.saturating_sub(from) < LOOSE);
    row.last().map_or(from, |(.., end)| end)
}

/// Why a whole chunk is unreadable, and its end; `None` if no chunk begins there, or its head is damaged.
fn unreadable(bytes: &[u8], at: usize) -> Option<(Damage, usize)> {
    let (opcode, end) = frame(bytes, at).filter(|(opcode, _)| *opcode == op::CHUNK)?;
    frame(bytes, end)
        .filter(|(next, _)| (op::HEADER..=op::DATA_END).contains(next) && opcode == op::CHUNK)?;
    match Packed::of(bytes.get(at..end)?) {
        Err(damage) => Some((damage, end)),
        Ok(_) => None,
    }
}

/// True if the file ends with the right checksums of its data and of its summary; `None` without such an end.
fn is_whole(bytes: &[u8]) -> Option<bool> {
    // Footer: beginning of the summary, beginning of its offsets, checksum of the summary and of the footer up to here.
    let footer = bytes.len().checked_sub(HEAD + FOOTER + MAGIC.len())?;
    let (opcode, end) = frame(bytes, footer)?;
    if opcode != op::FOOTER || bytes.get(end..) != Some(MAGIC) {
        return None;
    }
    let begin = bytes.get(footer + HEAD..)?.first_chunk().map(|begin| u64::from_le_bytes(*begin))?;
    let begin = usize::try_from(begin).ok()?;
    let checksum_at = end.checked_sub(CHECKSUM)?;
    let is_right = |covered: Range<usize>, checksum: usize| {
        let checksum = u32::from_le_bytes(*bytes.get(checksum..)?.first_chunk()?);
        Some(checksum != 0 && crc32fast::hash(bytes.get(covered)?) == checksum)
    };
    let data_end = begin.checked_sub(HEAD + CHECKSUM)?;
    let (opcode, end) = frame(bytes, data_end)?;
    let ends = opcode == op::DATA_END && end == begin;
    let has = |kind: u8| frames(bytes, begin).any(|(_, opcode, _)| opcode == kind);
    Some(
        ends && has(op::CHANNEL)
            && has(op::SCHEMA)
            && is_right(begin..checksum_at, checksum_at)?
            && is_right(0..data_end, data_end + HEAD)?,
    )
}

/// The channels and schemas of the first chunks, checked by all processors.
fn ahead(bytes: &[u8]) -> BTreeMap<usize, Option<Vec<Record<'static>>>> {
    let (mut left, mut chunks) = (AHEAD, Vec::new());
    for (at, opcode, end) in frames(bytes, MAGIC.len()) {
        let chunk = bytes.get(at..end).filter(|_| opcode == op::CHUNK);
        if let Some(chunk) = chunk {
            let Some(rest) = chunk_size(chunk).and_then(|size| left.checked_sub(size)) else { break };
            left = rest;
            chunks.push((at, chunk));
        }
    }
    let check_some = |first: usize, step: usize| {
        let mut decoder = Decoder::default();
        let mut check = |chunk: &[u8]| described(decoder.unpack(chunk)?);
        chunks.iter().skip(first).step_by(step).map(|(at, chunk)| (*at, check(chunk))).collect::<Vec<_>>()
    };
    let threads = thread::available_parallelism().map_or(1, usize::from).min(chunks.len().max(1));
    thread::scope(|scope| {
        let others: Vec<_> =
            (1..threads).map(|first| scope.spawn(move || check_some(first, threads))).collect();
        let own = check_some(0, threads);
        // If a thread has panicked, the reader checks its chunks.
        own.into_iter().chain(others.into_iter().flat_map(|other| other.join().unwrap_or_default())).collect()
    })
}

fn chunk_size(chunk: &[u8]) -> Option<u64> {
    chunk.get(HEAD..)?.get(16..24)?.try_into().map(u64::from_le_bytes).ok()
}

/// The channels and schemas among the records of a chunk; `None` if a record is unreadable.
fn described(records: &[u8]) -> Option<Vec<Record<'static>>> {
    let (mut at, mut described) = (0, Vec::new());
    while at < records.len() {
        let (opcode, end) = frame(records, at)?;
        let body = records.get(at.checked_add(HEAD)?..end)?;
        if opcode == op::MESSAGE {
            Message::of(body)?;
        } else {
            described.push(parse(opcode, body)?.into_owned());
        }
        at = end;
    }
    Some(described)
}

#[derive(Clone, Copy)]
pub struct Message<'a> {
    pub channel: u16,
    pub sequence: u32,
    pub log_time: u64, // ns since 1970
    pub data: &'a [u8],
}

impl<'a> Message<'a> {
    fn of(body: &'a [u8]) -> Option<Self> {
        let (head, data) = body.split_first_chunk::<MESSAGE_HEAD>()?;
        let (channel, head) = head.split_first_chunk()?;
        let (sequence, head) = head.split_first_chunk()?;
        let (log_time, _) = head.split_first_chunk()?;
        let (channel, sequence) = (u16::from_le_bytes(*channel), u32::from_le_bytes(*sequence));
        Some(Self { channel, sequence, log_time: u64::from_le_bytes(*log_time), data })
    }
}

/// Time of the first message of a chunk according to its record header, nanoseconds since 1970.
pub fn chunk_begin(chunk: &[u8]) -> Option<u64> {
    chunk.get(HEAD..)?.first_chunk().map(|begin| u64::from_le_bytes(*begin))
}

pub fn messages(records: &[u8]) -> impl Iterator<Item = Message<'_>> {
    let mut at = 0;
    iter::from_fn(move || {
        loop {
            let (opcode, end) = frame(records, at)?;
            let body = records.get(at.checked_add(HEAD)?..end)?;
            at = end;
            if opcode == op::MESSAGE {
                return Message::of(body);
            }
        }
    })
}

/// Operation code and end of a record at a position; `None` if it would be longer than the file.
fn frame(bytes: &[u8], at: usize) -> Option<(u8, usize)> {
    let head = bytes.get(at..at.checked_add(HEAD)?)?;
    let (opcode, length) = head.split_first()?;
    let length = usize::try_from(u64::from_le_bytes(length.try_into().ok()?)).ok()?;
    let end = at.checked_add(HEAD)?.checked_add(length)?;
    (end <= bytes.len()).then_some((*opcode, end))
}

/// Begin, operation code and end of the records from a position on, up to one that would be longer than the file.
fn frames(bytes: &[u8], from: usize) -> impl Iterator<Item = (usize, u8, usize)> {
    let mut at = from;
    iter::from_fn(move || {
        let (opcode, end) = frame(bytes, at)?;
        Some((std::mem::replace(&mut at, end), opcode, end))
    })
}

/// Parse a record of a used kind. The library allocates before it checks a length, so lengths are checked here.
fn parse(opcode: u8, body: &[u8]) -> Option<Record<'_>> {
    match opcode {
        op::METADATA => texts(body, text(body, 0)?)?,
        // Number, name, encoding, schema.
        op::SCHEMA => text(body, text(body, text(body, 2)?)?)?,
        // Two numbers, topic, encoding, metadata.
        op::CHANNEL => texts(body, text(body, text(body, 4)?)?)?,
        // Two times, name, media type, length of the data, data, checksum.
        op::ATTACHMENT => body.get(text(body, text(body, 16)?)?..)?.len().checked_sub(12)?,
        op::MESSAGE | op::FOOTER => 0,
        opcode => return Some(Record::Unknown { opcode, data: body.into() }),
    };
    parse_record(opcode, body).ok()
}

fn text(body: &[u8], from: usize) -> Option<usize> {
    let begin = from.checked_add(4)?;
    let length = body.get(from..begin)?.try_into().map(u32::from_le_bytes).ok()?;
    let end = begin.checked_add(usize::try_from(length).ok()?)?;
    (end <= body.len()).then_some(end)
}

/// End of a list of pairs of texts that begins with its length.
fn texts(body: &[u8], from: usize) -> Option<usize> {
    let (mut at, end) = (from.checked_add(4)?, text(body, from)?);
    while at < end {
        at = text(body, text(body, at)?)?;
    }
    (at == end).then_some(end)
}

struct Packed<'a> {
    size: usize,
    checksum: u32, // checksum of the records; 0 for none
    compression: Compression,
    records: &'a [u8],
}

enum Compression {
    None,
    Zstd,
    Lz4,
}

impl<'a> Packed<'a> {
    /// The content of a chunk with its record header.
    fn of(chunk: &'a [u8]) -> Result<Self, Damage> {
        let (size, checksum, name, records) = Self::fields(chunk).ok_or(Damage::Bytes)?;
        let compression = match name {
            b"" => Compression::None,
            b"zstd" => Compression::Zstd,
            b"lz4" => Compression::Lz4,
            other => return Err(Damage::Compression(String::from_utf8_lossy(other).into_owned())),
        };
        let fits = usize::try_from(size).ok().filter(|_| size <= CHUNK);
        Ok(Self { size: fits.ok_or(Damage::TooLarge(size))?, checksum, compression, records })
    }

    /// Size, checksum, compression and records: two times, size, checksum, compression, length of the records, records.
    fn fields(chunk: &'a [u8]) -> Option<(u64, u32, &'a [u8], &'a [u8])> {
        let body = chunk.get(HEAD..)?;
        let size = chunk_size(chunk)?;
        let checksum = body.get(24..28)?.try_into().map(u32::from_le_bytes).ok()?;
        let name = text(body, 28)?;
        let (length, records) = body.get(name..)?.split_first_chunk()?;
        let records = records.get(..usize::try_from(u64::from_le_bytes(*length)).ok()?)?;
        Some((size, checksum, body.get(32..name)?, records))
    }
}

#[derive(Default)]
pub struct Decoder {
    zstd: Decompressor<'static>,
    records: Vec<u8>,
}

impl Decoder {
    /// The records of a chunk; `None` if it cannot be decompressed, or its checksum is wrong.
    pub fn unpack<'a>(&'a mut self, chunk: &'a [u8]) -> Option<&'a [u8]> {
        let Packed { size, checksum, compression, mut records } = Packed::of(chunk).ok()?;
        self.records.clear();
        match compression {
            Compression::None => {}
            Compression::Zstd => {
                self.records.reserve(size);
                self.zstd.decompress_to_buffer(records, &mut self.records).ok()?;
                records = &self.records;
            }
            Compression::Lz4 => {
                // One byte more than the stated size is read, because a longer chunk is damaged.
                let limit = u64::try_from(size).ok()?.saturating_add(1);
                FrameDecoder::new(records).take(limit).read_to_end(&mut self.records).ok()?;
                records = &self.records;
            }
        }
        let is_sound = checksum == 0 || crc32fast::hash(records) == checksum;
        (records.len() == size && is_sound).then_some(records)
    }
}
