//! Sends a value to Foxglove or Lichtblick, 25 times per second: run `cargo run --release -p sessions --example sine`,
//! connect to the printed address, and plot `/wave.height`.

#![expect(clippy::print_stdout, reason = "an example prints what it does")]

use std::{
    thread,
    time::{Duration, SystemTime},
};

use record::tap::Channel;
use sessions::live::{Feed, Options, Port, Server};

const WAVE: u16 = 1;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let feed = Feed::default();
    let server = Server::start(Port::take(0)?, Options::default(), feed.clone())?;
    println!("ws://{}", server.address());

    let mut tap = feed.tap();
    let schema = br#"{"type": "object", "properties": {"height": {"type": "number"}}}"#;
    tap.channel(
        WAVE,
        &Channel {
            topic: "/wave",
            encoding: "json",
            schema_name: "Wave",
            schema_encoding: "jsonschema",
            schema,
        },
    );
    for tick in 0..250_u32 {
        let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH)?;
        let height = (f64::from(tick) / 10.0).sin();
        tap.message(WAVE, u64::try_from(now.as_nanos())?, format!("{{\"height\": {height}}}").as_bytes());
        thread::sleep(Duration::from_millis(40));
    }
    println!("{} viewers", feed.viewers());
    Ok(())
}
