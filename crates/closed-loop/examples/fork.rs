//! Plays a job and forks it in the middle; in the copy the cable to the robot is cut: `cargo run --release -p
//! closed-loop --example fork`.

#![expect(clippy::print_stdout, reason = "an example prints its results")]

use std::{error::Error, path::Path, sync::Arc};

use closed_loop::{ClosedLoop, JobPlayer, Present};
use neighbours::workstation::player::{Hwsc, Progress, TIME_LIMIT};
use plant::{Cell, CellDescription};
use rcs_core::tick::Tick;
use taskdata::load::{Job, Store};

fn main() -> Result<(), Box<dyn Error>> {
    let data = Path::new("data");
    let (store, _) = Store::load(data).map_err(|report| report.in_line())?;
    let (job, _) = Job::load(&data.join("jobs/linkbar.job"), &store).map_err(|report| report.in_line())?;
    let cell = Cell::new(&CellDescription::load(&data.join("cell.toml"))?, 1)?;
    let mut closed = ClosedLoop::new(Present::default(), Arc::new(store), Arc::new(job.reloads), cell);
    let mut player = JobPlayer::new(Hwsc::new(job.steps, TIME_LIMIT));
    while closed.tick() < Tick(3000) {
        player.step(&mut closed);
    }
    let (mut copy, mut other) = (closed.clone(), player.clone());
    copy.line_mut().cut(Tick(3000));
    for (name, closed, player) in [("original", &mut closed, &mut player), ("copy", &mut copy, &mut other)] {
        let progress = loop {
            match player.step(closed) {
                Progress::Running => {}
                progress => break progress,
            }
        };
        println!("{name}: {progress:?} at tick {}, digest {}", closed.tick(), closed.digest());
    }
    Ok(())
}
