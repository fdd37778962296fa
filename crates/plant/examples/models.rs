//! Writes the meshes of the cell as GLB files: `cargo run --release -p plant --example models -- DIRECTORY`.

use std::{env, error::Error, fs, io::Write as _, path::PathBuf};

use plant::{CellDescription, scene::Scene};

fn main() -> Result<(), Box<dyn Error>> {
    let directory = PathBuf::from(env::args().nth(1).ok_or("a directory was expected")?);
    let cell = CellDescription::from_toml(&fs::read_to_string("data/cell.toml")?)?;
    fs::create_dir_all(&directory)?;
    let mut out = std::io::stdout();
    for model in Scene::new(&cell, (1..).zip(&cell.part)).models() {
        let glb = model.glb();
        writeln!(
            out,
            "{:7} triangles {:8} bytes  {} on {}",
            model.mesh.triangles(),
            glb.len(),
            model.name,
            model.frame
        )?;
        fs::write(directory.join(format!("{}.glb", model.name)), glb)?;
    }
    Ok(())
}
