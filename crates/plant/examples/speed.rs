//! How fast the cell runs: ticks of a pick and carry, in microseconds, on one core.

#[path = "../tests/rig/mod.rs"]
mod rig;

use std::time::Instant;

use rig::{Rig, description};

fn main() {
    let mut rig = Rig::new(&description(), 1);
    for sector in 1..=4 {
        rig.place("LINKBAR1_BH", sector, 0.0, 0.0, 20.0);
    }
    rig.ticks(100);
    measure("four parts at rest, arm at rest", &mut rig, 2000, |rig| rig.tick());
    let started = (Instant::now(), rig.count);
    rig.pick(0.0, 0.0, 20.0, 30.0);
    rig.carry();
    rig.insert();
    let ticks = rig.count - started.1;
    report("pick, carry, insert", started.0.elapsed().as_secs_f64(), ticks);
    measure("part held, arm at rest", &mut rig, 2000, |rig| rig.tick());
}

fn measure(what: &str, rig: &mut Rig, ticks: u64, mut work: impl FnMut(&mut Rig)) {
    let start = Instant::now();
    for _ in 0..ticks {
        work(rig);
    }
    report(what, start.elapsed().as_secs_f64(), ticks);
}

fn report(what: &str, seconds: f64, ticks: u64) {
    let tick = seconds / ticks as f64;
    println!("{what:35} {ticks:6} ticks, {:6.1} us a tick, {:5.0} x real time", tick * 1e6, 0.040 / tick);
}
