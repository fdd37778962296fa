//! Lists the files that the programs carry, and reads one of them as a program does that was installed.
//! `cargo run --release -p cli-pages --example list`.

use std::path::Path;

use cli_pages::shipped;
use os_io::{files, stdout_line};

fn main() -> std::io::Result<()> {
    for file in shipped::FILES {
        stdout_line!("{:>7} bytes  {}", file.bytes.len(), file.path);
    }
    shipped::carry();
    let cell = files::read_text(Path::new("shipped:data/cell.toml"))?;
    stdout_line!("data/cell.toml has {} lines", cell.lines().count());
    Ok(())
}
