//! Copies a log into the form that the page reads: an MCAP file that every browser can decompress.
//!
//! The copy differs from the log in four ways. Its chunks are compressed with zlib's deflate, which browsers have. A
//! chunk has messages of one channel only. So similar messages compress to a third, and the page decompresses a channel
//! only to show it. Channels and attachments that the page does not read are left out. One is `/replay`, so the copy
//! cannot be replayed. Attachments that only a program can make are added.
//!
//! The order of the messages of a channel, their times and their sequence numbers (the tick) stay as they are.

use std::{collections::BTreeMap, io::Write as _};

use flate2::{Compression, write::ZlibEncoder};
use record::{
    Log,
    input::Attachment,
    instruments::INSTRUMENTS,
    ladder::LADDER,
    names::{END, REPLAY, RUN},
    proto::wire::{Fields, Value},
    tap::{Channel, Tap},
};

/// Topics that the page does not read: bytes for programs, and data that the page computes from other topics.
const LEFT_OUT: [&str; 6] = [REPLAY, "/trail", "/t3i/link_tx", "/robot_description", LADDER, INSTRUMENTS];
const KEPT: [&str; 2] = [Attachment::JOB, "faults.toml"];
/// Size at which a chunk is closed, bytes before compression.
const CHUNK: usize = 1 << 20;
/// Name of the compression in the chunks. The MCAP specification does not define it.
const COMPRESSION: &str = "deflate";
/// End of the names of attachments, which are compressed in the same way.
const DEFLATED: &str = ".deflate";
/// Nanoseconds of a tick.
const TICK_NS: u64 = 40_000_000;

/// First and last bytes of an MCAP file.
const MAGIC: &[u8] = b"\x89MCAP0\r\n";

mod code {
    pub const HEADER: u8 = 0x01;
    pub const FOOTER: u8 = 0x02;
    pub const SCHEMA: u8 = 0x03;
    pub const CHANNEL: u8 = 0x04;
    pub const MESSAGE: u8 = 0x05;
    pub const CHUNK: u8 = 0x06;
    pub const MESSAGE_INDEX: u8 = 0x07;
    pub const ATTACHMENT: u8 = 0x09;
    pub const METADATA: u8 = 0x0C;
    pub const DATA_END: u8 = 0x0F;
}

/// The copy of a log for the page, with further attachments.
#[must_use]
pub fn pack(log: &Log, added: &[Attachment]) -> Vec<u8> {
    let mut packer = Packer::default();
    log.send_channels(&mut packer);
    log.play(&mut packer, |_| ());
    let mut out = begin(&log.run, &log.attachments, added);
    packer.write(&mut out);
    if let Some(end) = &log.end {
        metadata(END, end, &mut out);
    }
    finish(out)
}

/// Data of a run before its first message: metadata, files, and further attachments. The messages arrive over the live
/// view.
#[must_use]
pub fn pack_start(
    run: &BTreeMap<String, String>,
    attachments: &[Attachment],
    added: &[Attachment],
) -> Vec<u8> {
    finish(begin(run, attachments, added))
}

/// The start of a file: header, metadata of the run, attachments.
fn begin(run: &BTreeMap<String, String>, attachments: &[Attachment], added: &[Attachment]) -> Vec<u8> {
    let mut out = MAGIC.to_vec();
    record(code::HEADER, &mut out, |body| {
        text("", body);
        text(concat!("rcs-page ", env!("CARGO_PKG_VERSION")), body);
    });
    metadata(RUN, run, &mut out);
    let is_kept =
        |file: &&Attachment| KEPT.contains(&file.name.as_str()) || file.name.starts_with(Attachment::PLAYED);
    attachments.iter().filter(is_kept).chain(added).for_each(|file| attachment(file, &mut out));
    out
}

/// The end of a file. There is no summary: the page reads the file from its beginning.
fn finish(mut out: Vec<u8>) -> Vec<u8> {
    record(code::DATA_END, &mut out, |body| number32(0, body));
    record(code::FOOTER, &mut out, |body| body.extend_from_slice(&[0; 20]));
    out.extend_from_slice(MAGIC);
    out
}

/// Sorts the messages of a log by their channels.
#[derive(Default)]
struct Packer {
    channels: BTreeMap<u16, Described>,
    replay: Option<u16>,
    /// Time of tick 0, nanoseconds since 1970.
    epoch: Option<u64>,
    messages: BTreeMap<u16, Vec<(u64, Vec<u8>)>>,
}

struct Described {
    topic: String,
    encoding: String,
    schema_name: String,
    schema_encoding: String,
    schema: Vec<u8>,
}

impl Tap for Packer {
    fn channel(&mut self, id: u16, channel: &Channel<'_>) {
        if channel.topic == REPLAY {
            self.replay = Some(id);
        }
        if !LEFT_OUT.contains(&channel.topic) {
            let described = Described {
                topic: channel.topic.to_owned(),
                encoding: channel.encoding.to_owned(),
                schema_name: channel.schema_name.to_owned(),
                schema_encoding: channel.schema_encoding.to_owned(),
                schema: channel.schema.to_vec(),
            };
            self.channels.insert(id, described);
        }
    }

    fn message(&mut self, channel: u16, time: u64, data: &[u8]) {
        if Some(channel) == self.replay && self.epoch.is_none() {
            self.epoch = tick_of(data).and_then(|tick| time.checked_sub(tick.checked_mul(TICK_NS)?));
        }
        if self.channels.contains_key(&channel) {
            self.messages.entry(channel).or_default().push((time, data.to_vec()));
        }
    }
}

/// The tick of a message on `/replay`.
fn tick_of(data: &[u8]) -> Option<u64> {
    let tick = u64::from(record::lossless::replay_field::TICK);
    Fields(data).find_map(|(field, value)| match value {
        Value::Number(value) if field == tick => Some(value),
        _ => None,
    })
}

impl Packer {
    /// Write schemas and channels, and the messages of each channel that has any.
    fn write(self, out: &mut Vec<u8>) {
        let epoch = self.epoch.unwrap_or_default();
        let used = self.channels.iter().filter(|(id, _)| self.messages.contains_key(id));
        for (schema, (id, channel)) in (1_u16..).zip(used) {
            record(code::SCHEMA, out, |body| {
                number16(schema, body);
                text(&channel.schema_name, body);
                text(&channel.schema_encoding, body);
                bytes(&channel.schema, body);
            });
            record(code::CHANNEL, out, |body| {
                number16(*id, body);
                number16(schema, body);
                text(&channel.topic, body);
                text(&channel.encoding, body);
                number32(0, body);
            });
        }
        for (id, messages) in &self.messages {
            write_messages(*id, messages, epoch, out);
        }
    }
}

/// Write the messages of a channel as chunks of about [`CHUNK`] bytes.
fn write_messages(channel: u16, messages: &[(u64, Vec<u8>)], epoch: u64, out: &mut Vec<u8>) {
    let mut records = Vec::new();
    let mut times: Option<(u64, u64)> = None;
    for (position, (time, data)) in messages.iter().enumerate() {
        record(code::MESSAGE, &mut records, |body| {
            number16(channel, body);
            number32(u32::try_from(time.saturating_sub(epoch) / TICK_NS).unwrap_or(u32::MAX), body);
            number64(*time, body);
            number64(*time, body);
            body.extend_from_slice(data);
        });
        let (start, _) = *times.get_or_insert((*time, *time));
        times = Some((start, *time));
        if records.len() >= CHUNK || position + 1 == messages.len() {
            write_chunk(channel, times.take().unwrap_or_default(), &records, out);
            records.clear();
        }
    }
}

fn write_chunk(channel: u16, (start, end): (u64, u64), records: &[u8], out: &mut Vec<u8>) {
    record(code::CHUNK, out, |body| {
        number64(start, body);
        number64(end, body);
        number64(records.len() as u64, body);
        // The checksum; 0 for none.
        number32(0, body);
        text(COMPRESSION, body);
        let compressed = deflated(records);
        number64(compressed.len() as u64, body);
        body.extend_from_slice(&compressed);
    });
    // The index only names the channel of the chunk, because the page reads all messages of a chunk.
    record(code::MESSAGE_INDEX, out, |body| {
        number16(channel, body);
        number32(0, body);
    });
}

fn deflated(data: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    // Writing to a vector cannot fail.
    let _ = encoder.write_all(data);
    encoder.finish().unwrap_or_default()
}

fn metadata(name: &str, entries: &BTreeMap<String, String>, out: &mut Vec<u8>) {
    record(code::METADATA, out, |body| {
        text(name, body);
        let mut map = Vec::new();
        for (key, value) in entries {
            text(key, &mut map);
            text(value, &mut map);
        }
        bytes(&map, body);
    });
}

fn attachment(file: &Attachment, out: &mut Vec<u8>) {
    let data = deflated(&file.data);
    record(code::ATTACHMENT, out, |body| {
        number64(0, body);
        number64(0, body);
        text(&format!("{}{DEFLATED}", file.name), body);
        text(&file.media_type, body);
        number64(data.len() as u64, body);
        body.extend_from_slice(&data);
        // The checksum; 0 for none.
        number32(0, body);
    });
}

fn record(code: u8, out: &mut Vec<u8>, write: impl FnOnce(&mut Vec<u8>)) {
    let mut body = Vec::new();
    write(&mut body);
    out.push(code);
    number64(body.len() as u64, out);
    out.append(&mut body);
}

fn number16(value: u16, out: &mut Vec<u8>) {
    out.extend_from_slice(&value.to_le_bytes());
}

fn number32(value: u32, out: &mut Vec<u8>) {
    out.extend_from_slice(&value.to_le_bytes());
}

fn number64(value: u64, out: &mut Vec<u8>) {
    out.extend_from_slice(&value.to_le_bytes());
}

fn text(value: &str, out: &mut Vec<u8>) {
    bytes(value.as_bytes(), out);
}

fn bytes(value: &[u8], out: &mut Vec<u8>) {
    number32(value.len() as u32, out);
    out.extend_from_slice(value);
}
