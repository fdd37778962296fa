//! Cuts the line to an emulated coupler for a time, and prints the state of the device in each tick.
//!
//! `cargo run --release -p couplers --example cut -- 0.2` shows stale, then running. With `-- 1` the device trips.

#![expect(clippy::print_stdout, reason = "an example says what it does")]

use std::error::Error;

use couplers::{Area, Emulated, Fallback, Kind, MS, Mode, Orders, OutWords, Plan, Simulated, Span};
use rcs_core::Plain;

fn main() -> Result<(), Box<dyn Error>> {
    let seconds: f64 = std::env::args().nth(1).ok_or("name the length of the cut, s")?.parse()?;
    let mut one = OutWords::ZERO;
    one.words[0] = 1;
    let plan = Plan {
        unit: 1,
        kind: Kind::Bk9000,
        fallback: Fallback::Zero,
        watchdog_ms: 500,
        stale_ms: 100,
        reads: vec![Span { area: Area::Input, first: 0, count: 4 }],
        writes: vec![Span { area: Area::Holding, first: 0x800, count: 1 }],
        safe: OutWords::ZERO,
        // The output may be on at rest. Otherwise the device would refuse a release while it is on.
        rest: one,
        alive: None,
    };
    let mut device = Simulated::new(plan, Emulated::new(Kind::Bk9000, 1, 4, 1), 15)?;
    let mut orders = Orders { tick: 0, mode: Mode::Run, go: 0, words: one };
    let mut before = None;
    for tick in 1..=100_u32 {
        let second = f64::from(tick) * 0.04;
        orders.tick = u64::from(tick);
        device.cut((0.5..0.5 + seconds).contains(&second));
        orders.go = u32::from(second > 3.5);
        for offset in [1, 32] {
            device.exchange((u64::from(tick) * 40 + offset) * MS, &orders);
        }
        let now = (device.report().state, device.coupler().outputs()[0]);
        if before.replace(now) != Some(now) {
            println!("{second:.2} s: {:?}, output {}", now.0, now.1);
        }
    }
    println!("{:?}", device.report().counters);
    Ok(())
}
