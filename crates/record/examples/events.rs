//! The events of a log with their codes: `cargo run --release -p record --example events -- RUN.mcap`.

#![expect(clippy::print_stdout, reason = "an example prints what it does")]

use std::{env, path::Path};

use record::Log;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = env::args().nth(1).ok_or("the name of a log was expected")?;
    let log = Log::open(Path::new(&file))?;
    for line in log.lines().filter(|line| !line.code.is_empty() && !line.code.ends_with(".rs")) {
        println!("tick {:>6}  {:<20} {}: {}", line.tick, line.code, line.source, line.text);
    }
    Ok(())
}
