//! A caller's own robot for the linkbar job: `cargo run --release -p runtime --example own_robot`. It reaches each
//! point at once; the rest of the cell is simulated, and the simulated arm follows it.

#![expect(clippy::print_stdout, reason = "an example prints what it does")]

use std::sync::{Arc, Mutex};

use depc::{
    Plate,
    controller::{Refusal, Robot, joints_for},
};
use geometry::kinematics::{HOME_JOINTS, Joints, T3};
use runtime::{Ending, LogTarget, OwnRobot, Run, RunConfig};

struct Ideal {
    joints: Joints,
    at: Plate,
    path: Arc<Mutex<f64>>, // length of the path so far, in
}

impl Robot for Ideal {
    fn present(&mut self) -> Plate {
        self.at
    }

    fn accept(&mut self, goal: &Plate) -> Result<(), Refusal> {
        self.joints = joints_for(&T3, goal, &self.joints)?;
        if let Ok(mut path) = self.path.lock() {
            *path += goal.to_frame().distance(&self.at.to_frame()).inches;
        }
        self.at = *goal;
        Ok(())
    }
}

impl OwnRobot for Ideal {
    fn advance(&mut self) {}

    fn position(&self) -> Option<Plate> {
        Some(self.at)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let data = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data");
    let config = RunConfig { log: LogTarget::None, shared_memory: false, ..RunConfig::new(data, "linkbar") };
    let path = Arc::new(Mutex::new(0.0));
    let at = Plate::from_frame(&T3.forward_plate(&HOME_JOINTS), &Plate::default())?;
    let robot = Ideal { joints: HOME_JOINTS, at, path: Arc::clone(&path) };
    let outcome = Run::with_robot(config, Box::new(robot), Box::new(()))?.complete();
    let inches = *path.lock().map_err(|_| "the run panicked")?;
    match outcome.ending {
        Ending::Finished => println!("finished after {} ticks and {inches:.0} in", outcome.result.ticks),
        Ending::Stopped | Ending::StoppedByUser => println!("stopped after {inches:.0} in"),
        Ending::Failed(account) => println!("failed at tick {}: {account}", account.first.tick),
    }
    Ok(())
}
