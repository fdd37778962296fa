//! Checks whether the robot can stand at a pose of the task data, and 40 in below it:
//! `cargo run --release -p paths --example stand`.

#![expect(clippy::print_stdout, reason = "an example prints what it does")]

use std::{error::Error, path::Path};

use geometry::pose::Pose;
use paths::stand::Standing;
use plant::{CellDescription, room::Room};
use taskdata::load::Store;

fn main() -> Result<(), Box<dyn Error>> {
    let data = Path::new("data");
    let (store, _) = Store::load(data).map_err(|report| report.render(false))?;
    let room = Room::new(&CellDescription::load(&data.join("cell.toml"))?);
    let named = store
        .view()
        .poses
        .iter()
        .find(|record| record.name.as_str() == "UNIT-V1")
        .ok_or("no pose UNIT-V1")?;
    let mut frame = named.pose.to_frame()?;
    println!("UNIT-V1\n{}", Standing::of(&named.pose, &store.view(), &room)?);
    frame.position.z -= 40.0;
    println!("40 in below\n{}", Standing::of(&Pose::from_frame(&frame), &store.view(), &room)?);
    Ok(())
}
