//! Measures a device behind an emulated coupler on this machine: age of the inputs at the tick, the tick's share, and
//! the time until outputs are safe or inputs are fresh after a disturbance.
//!
//! `cargo run --release -p executive --example field -- 500 20`: 500 ticks, and each disturbance 20 times. Real-time
//! scheduling is requested for both threads; without the permission they run without.

#![expect(clippy::print_stdout, reason = "an example says what it does")]

use std::{
    error::Error,
    net::{Ipv4Addr, SocketAddr},
    thread::sleep,
    time::{Duration, Instant},
};

use couplers::{Area, Emulated, Fallback, Kind, MS, Mode, Orders, OutWords, Plan, Report, Span, State};
use executive::{
    clock::{Grid, Monotonic},
    field::{Device, Station},
    realtime,
};
use rcs_core::Plain;

struct Bench {
    station: Station,
    device: Device,
    grid: Grid<Monotonic>,
    orders: Orders,
    ages: Vec<Duration>,
    shares: Vec<Duration>,
}

impl Bench {
    fn new(plan: Plan) -> Result<Self, Box<dyn Error>> {
        // The threads of station and device inherit the priority.
        if let Err(why) = realtime::raise_priority(realtime::FIELD_PRIORITY) {
            println!("without priority: {why}");
        }
        let local = SocketAddr::from((Ipv4Addr::LOCALHOST, 0));
        let station = Station::open(local, Emulated::new(Kind::Bk9000, 1, 33, 4))?;
        let device = Device::open(station.address(), Duration::from_millis(15), plan, || {})?;
        let grid = Grid::new(Monotonic);
        device.align(grid.start());
        let orders = Orders { tick: 0, mode: Mode::Run, go: 0, words: OutWords::ZERO };
        Ok(Self { station, device, grid, orders, ages: Vec::new(), shares: Vec::new() })
    }

    fn tick(&mut self) -> Report {
        self.grid.wait();
        let begun = Instant::now();
        let age = self.device.inputs().map(|(_, age)| age);
        self.orders.tick += 1;
        self.device.order(&self.orders);
        self.shares.push(begun.elapsed());
        self.ages.extend(age.map(Duration::from_nanos));
        *self.device.report()
    }

    /// Ticks until the device runs with its output on; releases it if it is tripped.
    fn until_on(&mut self) {
        loop {
            let report = self.tick();
            let is_on = self.station.with(|coupler| coupler.outputs()[0] == 1);
            if report.state == State::Running && is_on {
                return;
            }
            self.orders.words.words[0] = u16::from(report.state == State::Running);
            self.orders.go += u32::from(matches!(report.state, State::Tripped(_)));
        }
    }

    /// Time from the last orders until the output is safe.
    fn hang(&mut self) -> Duration {
        self.until_on();
        let begun = Instant::now();
        while self.station.with(|coupler| coupler.outputs()[0] == 1) {
            sleep(Duration::from_micros(200));
        }
        begun.elapsed()
    }

    /// Time from the end of a cut until the inputs are valid.
    fn cut(&mut self, length: Duration) -> Duration {
        self.until_on();
        self.station.cut(true);
        let begun = Instant::now();
        while begun.elapsed() < length {
            self.tick();
        }
        self.station.cut(false);
        let begun = Instant::now();
        while self.device.inputs().is_none_or(|(_, age)| age > 50 * MS) {
            self.tick();
        }
        begun.elapsed()
    }
}

fn print(what: &str, mut times: Vec<Duration>) {
    times.sort_unstable();
    let at = |percent: usize| {
        times.get((times.len() * percent / 100).min(times.len() - 1)).copied().unwrap_or_default()
    };
    println!("{what}: median {:?}, p99 {:?}, most {:?}", at(50), at(99), at(100));
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut numbers = std::env::args().skip(1).map(|text| text.parse::<u32>());
    let ticks = numbers.next().transpose()?.unwrap_or(500);
    let times = numbers.next().transpose()?.unwrap_or(20);
    let mut bench = Bench::new(Plan {
        unit: 1,
        kind: Kind::Bk9000,
        fallback: Fallback::Zero,
        watchdog_ms: 500,
        stale_ms: 100,
        reads: vec![Span { area: Area::Input, first: 0, count: 33 }],
        writes: vec![Span { area: Area::Holding, first: 0x800, count: 4 }],
        safe: OutWords::ZERO,
        rest: OutWords::ZERO,
        alive: None,
    })?;
    bench.until_on();
    (bench.ages, bench.shares) = (Vec::new(), Vec::new());
    for _ in 0..ticks {
        bench.tick();
    }
    print("age of the inputs at the tick", std::mem::take(&mut bench.ages));
    print("share of the tick", std::mem::take(&mut bench.shares));
    println!("slots skipped: {}; {:?}", bench.grid.skipped(), bench.device.report().counters);
    print("hung tick until safe", (0..times).map(|_| bench.hang()).collect());
    for length in [60, 200, 1000, 2000] {
        let length = Duration::from_millis(length);
        print(&format!("cut of {length:?} until fresh"), (0..times).map(|_| bench.cut(length)).collect());
    }
    println!("end confirmed: {}", bench.device.end());
    Ok(())
}
