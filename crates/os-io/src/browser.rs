//! Opens a page in the person's browser.

use std::{
    ffi::OsStr,
    io,
    process::{Command, Stdio},
    thread,
};

/// Opens a file or an address as the desktop is set up.
const OPENER: &str = if cfg!(target_os = "macos") { "open" } else { "xdg-open" };

/// Starts the browser and does not wait for it. Other users can see the address in the list of processes: no secrets.
pub fn open(what: &OsStr) -> io::Result<()> {
    let mut program = Command::new(OPENER);
    let program = program.arg(what).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    let mut child = program
        .spawn()
        .map_err(|error| io::Error::new(error.kind(), format!("{OPENER} cannot be started: {error}")))?;
    // Without a waiting thread, an ended child stays in the list of processes.
    thread::spawn(move || child.wait());
    Ok(())
}
