//! Counts the lines of a file; a closed output pipe is not an error: `cargo run --release -p os-io --example count --
//! FILE | head -0`.

use std::{env, io, path::Path};

use os_io::{console, files};

fn main() -> io::Result<()> {
    let name = env::args().nth(1).unwrap_or_else(|| "Cargo.toml".to_owned());
    let text = files::read_text(Path::new(&name))?;
    console::answer(&format!("{name}: {} lines\n", text.lines().count()))
}
