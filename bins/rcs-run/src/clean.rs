//! `rcs-run clean`: removes what killed runs left in shared memory.

use std::process::ExitCode;

use crate::error::{Error, UNUSABLE};

/// Remove, and say what was done.
pub fn clean() -> Result<ExitCode, Error> {
    let cleaned = executive::memory::clean()?;
    for run in &cleaned.removed {
        println!("removed {run}");
    }
    for run in &cleaned.alive {
        println!("{run} is alive and was left alone");
    }
    if cleaned.removed.is_empty() && cleaned.alive.is_empty() && cleaned.failed.is_empty() {
        println!("nothing was left behind");
    }
    for failure in &cleaned.failed {
        eprintln!("rcs-run: {failure}");
    }
    Ok(ExitCode::from(if cleaned.failed.is_empty() { 0 } else { UNUSABLE }))
}
