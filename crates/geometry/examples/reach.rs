//! Solves the inverse kinematics for a frame 2 in below HOME: `cargo run --release -p geometry --example reach`.

#![expect(clippy::print_stdout, reason = "an example prints what it does")]

use geometry::kinematics::{HOME_JOINTS, JOINT_NAMES, ReachError, T3};

fn main() -> Result<(), ReachError> {
    let mut tool = T3.forward(&HOME_JOINTS);
    tool.position.z -= 2.0;
    // Of all solutions, the one nearest to HOME.
    let joints = T3.inverse(&tool, &HOME_JOINTS)?;
    for (name, radians) in JOINT_NAMES.iter().zip(joints) {
        println!("{name:<14} {:8.3} degrees", radians.to_degrees());
    }
    println!("off by {:.1e} in", T3.forward(&joints).distance(&tool).inches);
    Ok(())
}
