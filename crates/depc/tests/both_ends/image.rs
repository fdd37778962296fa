//! The byte image that distinguishes states, without counters. Times and requested reports end at values beyond which
//! the host makes no difference: otherwise no state would repeat.

use depc::host::{Host, HostState, RESTART_TICKS, START_ATTEMPTS};
use rcs_core::{Plain, plain::Writer, reflect};
use std::{
    hash::{DefaultHasher, Hasher as _},
    ops::Range,
    sync::LazyLock,
};

#[derive(Default)]
pub struct Image(Vec<u8>);

const NAMES: [&str; 9] = [
    "counters",
    "lost_function",
    "frame",
    "candidate",
    "has_candidate",
    "waited",
    "asked",
    "attempts",
    "starting",
];

static FIELDS: LazyLock<[Range<usize>; 9]> = LazyLock::new(|| NAMES.map(field)); // in the image of the host

fn field(name: &str) -> Range<usize> {
    let (mut start, mut end) = (usize::MAX, 0);
    reflect::leaves(Host::STRUCT.fields, &mut |leaf| {
        if leaf.path.to_string().split(['.', '[']).next() == Some(name) {
            (start, end) = (start.min(leaf.offset), leaf.offset + leaf.size);
        }
    });
    assert!(start < end, "the host has no field {name}");
    start..end
}

impl Image {
    pub fn add(&mut self, bytes: &[u8]) {
        self.0.extend_from_slice(bytes);
    }

    pub fn add_plain<T: Plain>(&mut self, value: &T) {
        let from = self.0.len();
        self.0.resize(from + T::SIZE, 0);
        value.encode(&mut Writer::new(&mut self.0[from..]));
    }

    pub fn add_host(&mut self, host: &Host, faults: u8) {
        let from = self.0.len();
        self.add_plain(host);
        let image = &mut self.0[from..];
        let [counters, lost_function, frame, candidate, has_candidate, waited, asked, attempts, starting] =
            FIELDS.clone();
        image[counters].fill(0);
        image[lost_function].fill(0); // reported to the user, without effect on the behaviour
        if host.state() != HostState::Waiting {
            image[frame].fill(0);
        }
        if image[has_candidate.start] == 0 {
            image[candidate].fill(0);
        }
        for time in [waited, starting] {
            let ticks = reflect::unsigned(&image[time.clone()]).min(u64::from(RESTART_TICKS) + 5);
            image[time].copy_from_slice(&ticks.to_le_bytes()[..2]);
        }
        let attempts = &mut image[attempts.start];
        *attempts = (*attempts).min(START_ATTEMPTS);
        // Each damaged report reduces the awaited ones by one; larger numbers are equivalent.
        let asked = &mut image[asked.start];
        *asked = (*asked).min(faults + 4);
    }

    /// A hash: in a million states two are equal with a probability of 1 in 37 million.
    pub fn fingerprint(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        hasher.write(&self.0);
        hasher.finish()
    }
}
