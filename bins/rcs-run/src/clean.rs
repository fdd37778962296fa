//! `rcs-run clean`: removes the shared memory of killed runs.

use std::process::ExitCode;

use os_io::console;

use crate::rcs_run::error::{Error, UNUSABLE};

pub fn clean() -> Result<ExitCode, Error> {
    let cleaned = executive::memory::clean()?;
    let objects = executive::memory::clean_objects()?;
    let removed = cleaned.removed.iter().map(|run| format!("removed {run}\n"));
    let alive = cleaned.alive.iter().map(|run| format!("{run} is running and was not touched\n"));
    let mut text: String = removed.chain(alive).collect();
    if objects > 0 {
        text.push_str(&format!("removed the shared memory of {objects} killed runs without a directory\n"));
    }
    if text.is_empty() && cleaned.failed.is_empty() {
        text.push_str("no shared memory was left behind\n");
    }
    console::answer(&text)?;
    for failure in &cleaned.failed {
        os_io::stderr_line!("rcs-run: {failure}");
    }
    Ok(ExitCode::from(if cleaned.failed.is_empty() { 0 } else { UNUSABLE }))
}
