//! The channels of the buffers, found in the schemas of [`CommonMemory`] and [`ExternalInputs`]: `/process/buffer`, for
//! commands `/process/buffer_command`, and `/process/row` ([`crate::rows`]). A message is written when its buffer
//! changes, and at least every ten seconds for a viewer that starts in the middle.

use std::{
    collections::BTreeMap,
    io::{Seek, Write},
    ops::Range,
};

use interfaces::{CommonMemory, ExternalInputs, Header};
use levels::ladder::{Ladder, ProcessInfo};
use mcap::{McapResult, records::MessageHeader};
use rcs_core::{
    plain::{self, Schema, StructSchema},
    table::Fired,
    tick::Tick,
};

use crate::{
    input::Epoch,
    layout,
    proto::{descriptor, message},
    tap::{Channel, Tap},
};

pub const PROTOBUF: &str = "protobuf";

/// An MCAP file in which every message has the time of its tick.
pub struct Output<W: Write + Seek> {
    pub mcap: mcap::Writer<W>,
    pub epoch: Epoch,
    pub tap: Option<Box<dyn Tap>>,
}

impl<W: Write + Seek> Output<W> {
    pub fn protobuf(&mut self, topic: &str, schema: &str, descriptors: &[u8]) -> McapResult<u16> {
        self.channel(topic, schema, PROTOBUF, descriptors, PROTOBUF)
    }

    pub fn channel(
        &mut self,
        topic: &str,
        schema: &str,
        schema_encoding: &str,
        definition: &[u8],
        message_encoding: &str,
    ) -> McapResult<u16> {
        let number = self.mcap.add_schema(schema, schema_encoding, definition)?;
        let id = self.mcap.add_channel(number, topic, message_encoding, &BTreeMap::new())?;
        if let Some(tap) = &mut self.tap {
            let (encoding, schema_name, schema) = (message_encoding, schema, definition);
            tap.channel(id, &Channel { topic, encoding, schema_name, schema_encoding, schema });
        }
        Ok(id)
    }

    pub fn put(&mut self, channel: u16, tick: Tick, data: &[u8]) -> McapResult<()> {
        self.write(channel, tick, data)?;
        self.pass(channel, tick, data);
        Ok(())
    }

    /// Write a message of a tick that was already passed to the tap.
    pub fn write(&mut self, channel_id: u16, tick: Tick, data: &[u8]) -> McapResult<()> {
        let log_time = self.epoch.of(tick);
        // After five years, a tick number needs more than 32 bits.
        let sequence = u32::try_from(tick.0).unwrap_or(u32::MAX);
        let header = MessageHeader { channel_id, sequence, log_time, publish_time: log_time };
        self.mcap.write_to_known_channel(&header, data)
    }

    pub fn pass(&mut self, channel: u16, tick: Tick, data: &[u8]) {
        if let Some(tap) = &mut self.tap {
            tap.message(channel, self.epoch.of(tick), data);
        }
    }

    /// Report to the tap that a tick is complete.
    pub fn end_tick(&mut self, tick: Tick) {
        if let Some(tap) = &mut self.tap {
            tap.tick(self.epoch.of(tick));
        }
    }
}

/// Fields that change by themselves: clocks of the T3 interface, frames on the line, numbers of changing poses. They do
/// not cause a message of their buffer; their values are on `/replay`.
const CLOCKS: [&str; 7] =
    ["cycle", "cycle_echo", "frames", "acknowledged", "reference_pose", "present_pose", "sensor_pose"];

/// Buffers that repeat other data in every tick; written only with the repetitions.
const SCRATCH: [&str; 1] = ["/prim/poses"];

struct Buffer {
    channel: u16,
    bytes: Range<usize>,
    /// Parts of the image that are compared: all except the [`CLOCKS`].
    compared: Vec<Range<usize>>,
    schema: StructSchema,
}

pub struct Buffers(Vec<Buffer>);

struct Place {
    topic: String,
    bytes: Range<usize>,
    schema: StructSchema,
}

/// The buffers of a record: its fields except the header, named after `prefix`.
fn places(prefix: &str, record: &'static StructSchema, mut offset: usize) -> Vec<Place> {
    let mut found = Vec::new();
    for field in record.fields {
        let size = field.schema.size();
        let (name, fields) = match &field.schema {
            Schema::Struct(of) => (of.name, of.fields),
            // An array is a message with itself as its only field.
            _ => (field.name, std::slice::from_ref(field)),
        };
        if name != Header::STRUCT.name {
            let command = name.ends_with("Command") && !field.name.ends_with("command");
            let topic = format!("{prefix}/{}{}", field.name, if command { "_command" } else { "" });
            found.push(Place {
                topic,
                bytes: offset..offset + size,
                schema: StructSchema::new(name, fields),
            });
        }
        offset += size;
    }
    found
}

fn external_places() -> Vec<Place> {
    places("/external", ExternalInputs::STRUCT, 0)
}

fn memory_places() -> Vec<Place> {
    let mut offset = 0;
    let mut found = Vec::new();
    for process in CommonMemory::STRUCT.fields {
        if let Schema::Struct(outputs) = &process.schema {
            found.extend(places(&format!("/{}", process.name), outputs, offset));
        }
        offset += process.schema.size();
    }
    found
}

fn compared(schema: &StructSchema, offset: usize) -> Vec<Range<usize>> {
    let mut found: Vec<Range<usize>> = Vec::new();
    for leaf in layout::leaves_of(schema.fields) {
        let start = offset + leaf.offset;
        let range = start..start + leaf.schema.size();
        let name = leaf.path.rsplit('.').next().unwrap_or_default();
        match found.last_mut() {
            _ if CLOCKS.contains(&name) => {}
            Some(last) if last.end == range.start => last.end = range.end,
            _ => found.push(range),
        }
    }
    found
}

impl Buffers {
    pub fn external<W: Write + Seek>(output: &mut Output<W>) -> McapResult<Self> {
        Self::open(output, external_places())
    }

    pub fn memory<W: Write + Seek>(output: &mut Output<W>) -> McapResult<Self> {
        Self::open(output, memory_places())
    }

    fn open<W: Write + Seek>(output: &mut Output<W>, places: Vec<Place>) -> McapResult<Self> {
        let open = |Place { topic, bytes, schema }| {
            let descriptors = descriptor::descriptor_set(&schema);
            let channel = output.protobuf(&topic, &descriptor::message_name(&schema), &descriptors)?;
            let scratch = SCRATCH.contains(&topic.as_str());
            let compared = if scratch { Vec::new() } else { compared(&schema, bytes.start) };
            Ok(Buffer { channel, bytes, compared, schema })
        };
        places.into_iter().map(open).collect::<McapResult<_>>().map(Self)
    }

    /// Write the buffers of `image` that differ from `last`, or all of them.
    pub fn write<W: Write + Seek>(
        &self,
        output: &mut Output<W>,
        tick: Tick,
        last: &[u8],
        image: &[u8],
        all: bool,
    ) -> McapResult<()> {
        let mut data = Vec::new();
        for buffer in &self.0 {
            let now = image.get(buffer.bytes.clone()).unwrap_or_default();
            let changed = |range: &Range<usize>| last.get(range.clone()) != image.get(range.clone());
            if all || buffer.compared.iter().any(changed) {
                data.clear();
                message::encode(&buffer.schema, now, &mut data);
                output.put(buffer.channel, tick, &data)?;
            }
        }
        Ok(())
    }
}

#[derive(Clone, Copy, Debug)]
pub struct HeaderPlace {
    pub field: &'static str,
    /// First byte of the header.
    pub offset: usize,
    pub process: &'static ProcessInfo,
}

impl HeaderPlace {
    #[must_use]
    pub fn read(&self, image: &[u8]) -> Header {
        image.get(self.offset..).and_then(|bytes| plain::from_bytes(bytes).ok()).unwrap_or_default()
    }

    #[must_use]
    pub fn fired(&self, header: &Header) -> Option<Fired> {
        self.process.fired(header)
    }
}

/// The headers of all processes. Processes and fields of common memory have the same order.
#[must_use]
pub fn headers() -> Vec<HeaderPlace> {
    let mut offset = 0;
    let mut found = Vec::new();
    for (field, process) in CommonMemory::STRUCT.fields.iter().zip(Ladder::processes()) {
        found.push(HeaderPlace { field: field.name, offset, process });
        offset += field.schema.size();
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::Decided;
    use rcs_core::Plain;
    use std::collections::BTreeSet;

    #[test]
    fn every_buffer_has_its_own_topic() {
        let topics: Vec<String> =
            external_places().into_iter().chain(memory_places()).map(|place| place.topic).collect();
        assert_eq!(topics.iter().collect::<BTreeSet<_>>().len(), topics.len());
        for topic in [
            "/external/hws_command",
            "/external/devices",
            "/task/status",
            "/task/subtask_command",
            "/emove/prim_command",
            "/prim/t3i_command",
            "/prim/poses",
            "/t3i/link_tx",
            "/grip/valves",
        ] {
            assert!(topics.iter().any(|known| known == topic), "{topic} is not among {topics:?}");
        }
    }

    #[test]
    fn header_places_follow_the_processes() {
        let mut memory = CommonMemory::default();
        memory.prim.header =
            Header { stamp: Tick(7), decided: Some(Decided { table: 2, row: 3 }), ..Header::default() };
        let mut image = vec![0; CommonMemory::SIZE];
        memory.encode(&mut plain::Writer::new(&mut image));
        let headers = headers();
        assert_eq!(headers.len(), CommonMemory::STRUCT.fields.len());
        let prim = headers.iter().find(|place| place.field == "prim").unwrap();
        assert_eq!(prim.read(&image), memory.prim.header);
        assert!(prim.process.name.eq_ignore_ascii_case("prim"));
    }
}
