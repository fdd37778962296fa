//! Moves an emulated EGM robot 50 mm along X and back in ten seconds of simulated time.
//! `cargo run --release -p executive --example emulated`.

#![expect(clippy::print_stdout, reason = "an example prints what it does")]

use egm::{Pose, Twist};
use executive::egm::{EgmOptions, Line, Order, Placement};

const TICK_NS: u64 = 40_000_000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let options: EgmOptions = "sim,loss=1".parse()?;
    let mut line = Line::Simulated(Box::new(options.simulated(&Placement::default())));
    let mut from: Option<Pose> = None;
    let mut points = 0_u32;
    while points < 250 {
        let (at, sample) = (line.now(), line.sample());
        match (from, sample.start) {
            (Some(from), _) if sample.is_moving => {
                points += 1;
                let part = (1.0 - (f64::from(points) * 0.04 * 0.628).cos()) / 2.0;
                let way = Twist { linear: [50.0 * part, 0.0, 0.0], angular: [0.0; 3] };
                line.order(&Order::Point { at, to: from.moved(&way) });
                if points.is_multiple_of(25) {
                    let [target, robot] = [sample.target, sample.feedback].map(|pose| pose.distance(&from).0);
                    println!("{points:>4} points: target {target:5.2} mm, robot {robot:5.2} mm");
                }
            }
            (None, Some(start)) => {
                from = Some(start);
                line.order(&Order::Begin { at, from: start });
            }
            _ => {}
        }
        line.advance(TICK_NS);
    }
    println!("{:?}", line.sample().counters);
    Ok(())
}
