//! An emulated coupler, a BK9000 or another kind, and a controller that switches its outputs: two programs to test networks and other programs.
//!
//! `coupler station 127.0.0.1:1502` prints changes of the outputs, and the greatest age of an image that was carried
//! out. `coupler controller 127.0.0.1:1502 60` runs for 60 s with an output on, releases a tripped device, and prints
//! its states. Both must run on one machine: the images hold its time.
//!
//! `cargo run --release -p executive --example coupler -- station 127.0.0.1:1502`

#![expect(clippy::print_stdout, reason = "an example says what it does")]

use std::{error::Error, mem::discriminant, net::SocketAddr, thread::sleep, time::Duration};

use couplers::{Area, Emulated, Fallback, Kind, Mode, Orders, OutWords, Plan, Span, State};
use executive::{
    clock::{Grid, Monotonic, Time},
    field::{Device, Station},
    realtime,
};
use rcs_core::Plain;

const CLOCK: usize = 1; // word of the output image that holds the time of its tick, ms

/// The time, ms; it begins again every 65 s.
fn milliseconds() -> u16 {
    u16::try_from(Monotonic.now().as_millis() % 0x1_0000).unwrap_or(0)
}

/// Requests priority, so that other programs do not affect the measurement.
fn prepare() {
    if let Err(why) = realtime::raise_priority(realtime::FIELD_PRIORITY) {
        println!("without priority: {why}");
    }
}

fn station(address: SocketAddr, kind: Kind) -> Result<(), Box<dyn Error>> {
    // Its threads inherit the priority.
    prepare();
    let station = Station::open(address, Emulated::new(kind, 1, 8, 4))?;
    println!("a {kind} at {}: 8 registers of inputs, 4 of outputs", station.address());
    let (mut written, mut shown, mut oldest) = (0, (u16::MAX, 0, 0), 0);
    loop {
        sleep(Duration::from_millis(1));
        let (outputs, writes, fallbacks) =
            station.with(|coupler| (*coupler.outputs(), coupler.writes(), coupler.fallbacks()));
        if writes != written && outputs[CLOCK] != 0 {
            oldest = oldest.max(milliseconds().wrapping_sub(outputs[CLOCK]));
        }
        written = writes;
        let now = (outputs[0], fallbacks, oldest);
        if now != shown {
            println!("output {}, {writes} writes, the oldest {oldest} ms, {fallbacks} fallbacks", outputs[0]);
            shown = now;
        }
    }
}

fn controller(address: SocketAddr, seconds: u64) -> Result<(), Box<dyn Error>> {
    let mut rest = OutWords::ZERO;
    rest.words[CLOCK] = u16::MAX;
    let plan = Plan {
        unit: 1,
        kind: Kind::Bk9000,
        fallback: Fallback::Zero,
        watchdog_ms: 5000,
        stale_ms: 100,
        reads: vec![Span { area: Area::Input, first: 0, count: 8 }],
        writes: vec![Span { area: Area::Holding, first: 0x800, count: 4 }],
        safe: OutWords::ZERO,
        rest,
        alive: None,
    };
    let mut device = Device::open(address, Duration::from_millis(15), plan, prepare)?;
    let mut grid = Grid::new(Monotonic);
    device.align(grid.start());
    let mut orders = Orders { tick: 0, mode: Mode::Run, go: 0, words: OutWords::ZERO };
    let mut before = None;
    for _ in 0..seconds * 25 {
        grid.wait();
        let report = *device.report();
        if before
            .replace(report.state)
            .is_none_or(|before| discriminant(&before) != discriminant(&report.state))
        {
            println!("{:?}", report.state);
        }
        orders.tick += 1;
        orders.words.words[0] = u16::from(report.state == State::Running);
        orders.words.words[CLOCK] = milliseconds();
        orders.go += u32::from(matches!(report.state, State::Tripped(_)));
        device.order(&orders);
    }
    println!("{:?}", device.report().counters);
    println!("end confirmed: {}", device.end());
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        ["station", address] => station(address.parse()?, Kind::Bk9000),
        ["station", address, kind] => station(address.parse()?, Kind::from_text(kind).ok_or("unknown kind")?),
        ["controller", address, seconds] => controller(address.parse()?, seconds.parse()?),
        _ => Err("expected: station ADDRESS:PORT [KIND], or controller ADDRESS:PORT SECONDS".into()),
    }
}
