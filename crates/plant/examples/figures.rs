//! Prints figures of the simulation: cost of a tick, error at rest, penetration, creep. Argument: number of sub-steps.

#![expect(clippy::print_stdout, reason = "figures are what it is for")]

#[path = "../tests/rig/mod.rs"]
mod rig;

use plant::WorkstationAction::{ViseClose, ViseOpen, VisePartial};
use rig::{FX1, HOLD, Rig, SEAT, description};

fn main() {
    let mut cell = description();
    if let Some(substeps) = std::env::args().nth(1).and_then(|word| word.parse().ok()) {
        cell.physics.substeps = substeps;
    }
    let mut rig = Rig::new(&cell, 1);
    for sector in 1..=4 {
        rig.place("LINKBAR1_BH", sector, 0.0, 0.0, 20.0);
    }
    rig.ticks(100);
    let rest = rig.cell.parts()[3].position[2];
    println!("a blank on the tray floor sinks by {:.4} in", -16.55 + 0.3125 - rest);
    cost("arm and four parts at rest", &mut rig, |rig| rig.ticks(2000));
    rig.vise(VisePartial);
    cost("pick, carry, insert", &mut rig, |rig| {
        rig.pick(0.0, 0.0, 20.0, 30.0);
        rig.carry();
        rig.insert();
    });
    let wanted = Rig::fixture(&FX1, 0.0, 0.0);
    println!(
        "at rest the tool is {:.4} in from the command",
        (rig.cell.tool().position - wanted.position).norm()
    );
    let before = rig.in_fixture().position;
    cost("a part held, arm at rest, one minute", &mut rig, |rig| rig.ticks(1500));
    println!("in that minute the part creeps by {:.5} in", (rig.in_fixture().position - before).norm());
    cost("hold and seat", &mut rig, |rig| {
        rig.vise(ViseClose);
        rig.open(3.5);
        rig.go(Rig::fixture(&FX1, 8.0, 0.0), 4.0);
        rig.go(Rig::fixture(&HOLD, 5.0, 0.0), 4.0);
        rig.close(40.0);
        rig.go_and_stop(Rig::fixture(&HOLD, 0.0, 0.0), 0.5);
        rig.vise(ViseOpen);
        rig.go_and_stop(Rig::fixture(&SEAT, 0.0, 0.0), 0.5);
    });
    let seated = rig.in_fixture().position;
    println!("pressed to the back of the notch with 30 lb the blank sinks by {:.4} in", seated.x - 0.0975);
    println!("on the ledge it sinks by {:.4} in", -1.25 - seated.z);
}

fn cost(what: &str, rig: &mut Rig, work: impl FnOnce(&mut Rig)) {
    let start = (seconds(), rig.count);
    work(rig);
    let ticks = rig.count - start.1;
    let tick = (seconds() - start.0) / ticks as f64;
    println!("{what:37} {ticks:6} ticks, {:6.1} us a tick, {:5.0} x real time", tick * 1e6, 0.040 / tick);
}

fn seconds() -> f64 {
    // CPU time of this thread, s
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").expect("a Linux with schedstat");
    let nanoseconds: f64 =
        text.split(' ').next().and_then(|word| word.parse().ok()).expect("nanoseconds first");
    nanoseconds / 1e9
}
