//! The reader of logs: any bytes as a file, and as the messages of a file whose checksums are right.
//!
//! What can be read comes in the order of its ticks, and everything else is an error in words. Memory is
//! bounded by the fuzzer.

#![no_main]

use std::{io::Cursor, path::Path};

use libfuzzer_sys::fuzz_target;
use mcap::{
    WriteOptions,
    records::{MessageHeader, Metadata},
};
use record::{Log, layout};

const TOPICS: [&str; 5] = ["/replay", "/log", "/tf_static", "/tf", "/joint_states"];

/// A log with a message for each piece of the data: topic, length, bytes.
fn sound(mut data: &[u8]) -> Vec<u8> {
    let mut writer = WriteOptions::new().create(Cursor::new(Vec::new())).expect("memory takes it");
    let run = [("layout".to_owned(), layout::version())].into();
    writer.write_metadata(&Metadata { name: "rcs-run".into(), metadata: run }).expect("memory takes it");
    let channels = TOPICS
        .map(|topic| writer.add_channel(0, topic, "protobuf", &Default::default()).expect("memory takes it"));
    let mut sequence = 0;
    while let [topic, length, rest @ ..] = data {
        let (message, later) = rest.split_at(rest.len().min(usize::from(*length) * 8));
        data = later;
        sequence += 1;
        let channel_id = channels[usize::from(*topic) % channels.len()];
        let header = MessageHeader { channel_id, sequence, log_time: 0, publish_time: 0 };
        writer.write_to_known_channel(&header, message).expect("memory takes it");
    }
    writer.finish().expect("memory takes it");
    writer.into_inner().into_inner()
}

fn read(bytes: Vec<u8>) {
    let log = match Log::from_bytes(Path::new("log"), bytes) {
        Ok(log) => log,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    let mut last = 0;
    for tick in log.ticks().map_while(Result::ok) {
        assert!(tick.tick.0 > last, "ticks go forward");
        last = tick.tick.0;
    }
    let _ = (log.lines().count(), log.places().count(), log.damage());
}

fuzz_target!(|data: &[u8]| {
    read(data.to_vec());
    read(sound(data));
});
