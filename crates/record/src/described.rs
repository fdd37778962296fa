//! Descriptions of the channels and schemas of a file.

use std::collections::BTreeMap;

use mcap::records::{self, Record};

use crate::tap::{Channel, Tap};

/// Channels and schemas by number. The first entry of a number is used.
#[derive(Default)]
pub struct Described {
    channels: BTreeMap<u16, records::Channel>,
    schemas: BTreeMap<u16, (records::SchemaHeader, Vec<u8>)>,
}

impl Described {
    pub fn note(&mut self, record: &Record<'_>) {
        match record {
            Record::Channel(channel) => {
                self.channels.entry(channel.id).or_insert_with(|| channel.clone());
            }
            Record::Schema { header, data } => {
                self.schemas.entry(header.id).or_insert_with(|| (header.clone(), data.to_vec()));
            }
            _ => {}
        }
    }

    pub fn tell(&self, tap: &mut dyn Tap) {
        for (id, channel) in &self.channels {
            let Some((header, schema)) = self.schemas.get(&channel.schema_id) else { continue };
            let (topic, encoding) = (&channel.topic, &channel.message_encoding);
            let (schema_name, schema_encoding) = (&header.name, &header.encoding);
            tap.channel(*id, &Channel { topic, encoding, schema_name, schema_encoding, schema });
        }
    }
}
