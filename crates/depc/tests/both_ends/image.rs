//! The byte image that distinguishes states.
//!
//! Counters are left out. A time is limited to the value beyond which the host makes no difference, and so is the
//! number of requested reports: otherwise no state would ever repeat.

use depc::host::{Host, HostState, RESTART_TICKS, START_ATTEMPTS};
use rcs_core::{
    Plain,
    plain::{Schema, StructSchema, Writer},
};
use std::hash::{DefaultHasher, Hasher as _};

/// A state as bytes.
#[derive(Default)]
pub struct Image(Vec<u8>);

const HOST: &StructSchema = match &Host::SCHEMA {
    Schema::Struct(fields) => fields,
    _ => panic!("the host is a struct"),
};

/// Offset of a field of the host in its image, and its size.
fn field(name: &str) -> (usize, usize) {
    let mut at = 0;
    for field in HOST.fields {
        if field.name == name {
            return (at, field.schema.size());
        }
        at += field.schema.size();
    }
    panic!("the host has no field {name}");
}

/// Offsets and sizes of the fields that are changed.
pub struct Fields {
    counters: (usize, usize),
    lost_function: (usize, usize),
    frame: (usize, usize),
    candidate: (usize, usize),
    has_candidate: (usize, usize),
    waited: (usize, usize),
    asked: (usize, usize),
    attempts: (usize, usize),
    starting: (usize, usize),
}

impl Fields {
    fn new() -> Self {
        Self {
            counters: field("counters"),
            lost_function: field("lost_function"),
            frame: field("frame"),
            candidate: field("candidate"),
            has_candidate: field("has_candidate"),
            waited: field("waited"),
            asked: field("asked"),
            attempts: field("attempts"),
            starting: field("starting"),
        }
    }
}

static FIELDS: std::sync::LazyLock<Fields> = std::sync::LazyLock::new(Fields::new);

impl Image {
    pub fn add(&mut self, bytes: &[u8]) {
        self.0.extend_from_slice(bytes);
    }

    pub fn add_plain<T: Plain>(&mut self, value: &T) {
        let from = self.0.len();
        self.0.resize(from + T::SIZE, 0);
        value.encode(&mut Writer::new(&mut self.0[from..]));
    }

    /// Add the host; `faults` is the number of faults that can still happen.
    pub fn add_host(&mut self, host: &Host, faults: u8) {
        let from = self.0.len();
        self.add_plain(host);
        let (image, fields) = (&mut self.0[from..], &*FIELDS);
        let clear = |image: &mut [u8], (at, size): (usize, usize)| image[at..at + size].fill(0);
        clear(image, fields.counters);
        // It is only reported to the user; nothing depends on it.
        clear(image, fields.lost_function);
        if host.state() != HostState::Waiting {
            clear(image, fields.frame);
        }
        if image[fields.has_candidate.0] == 0 {
            clear(image, fields.candidate);
        }
        for time in [fields.waited, fields.starting] {
            let ticks = u16::from_le_bytes([image[time.0], image[time.0 + 1]]);
            let bounded = ticks.min(RESTART_TICKS + 5);
            image[time.0..time.0 + 2].copy_from_slice(&bounded.to_le_bytes());
        }
        let attempts = &mut image[fields.attempts.0];
        *attempts = (*attempts).min(START_ATTEMPTS);
        // Each damaged report reduces the number of awaited ones by one; all numbers beyond that are equivalent.
        let asked = &mut image[fields.asked.0];
        *asked = (*asked).min(faults + 4);
    }

    /// A 64-bit hash: in a million states two are equal with a probability of 1 in 37 million.
    pub fn fingerprint(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        hasher.write(&self.0);
        hasher.finish()
    }
}
