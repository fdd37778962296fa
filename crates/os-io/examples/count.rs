//! Counts the lines of a file. A directory, a device or text that is not UTF-8 is an error; a closed output pipe is
//! not: `cargo run --release -p os-io --example count -- FILE | head -0`.

use std::{env, io, path::Path};

use os_io::{console, files};

fn main() -> io::Result<()> {
    let name = env::args().nth(1).unwrap_or_else(|| "Cargo.toml".to_owned());
    let text = files::read_text(Path::new(&name))?;
    console::answer(&format!("{name}: {} lines\n", text.lines().count()))
}
