//! Writes a log as one page: `cargo run --release -p page --example one_file -- RUN.mcap RUN.html`.
//!
//! The page has neither tables nor explanations; `rcs-log page` adds them.

use std::{env, fs, path::Path};

use record::Log;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut names = env::args().skip(1);
    let (Some(file), Some(output)) = (names.next(), names.next()) else {
        return Err("the names of a log and of a page were expected".into());
    };
    let log = Log::open(Path::new(&file))?;
    fs::write(output, page::document(&file, page::Content::Log(&page::pack(&log, &[]))))?;
    Ok(())
}
