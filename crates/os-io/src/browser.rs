//! Opens a page in the person's browser.

use std::{
    ffi::OsStr,
    io,
    process::{Command, Stdio},
    thread,
};

/// Command that opens a file or an address with the desktop's default program.
const OPENER: &str = if cfg!(target_os = "macos") { "open" } else { "xdg-open" };

/// Starts the browser without waiting for it. The address must hold no secret, because other users can see it.
pub fn open(what: &OsStr) -> io::Result<()> {
    let mut program = Command::new(OPENER);
    let program = program.arg(what).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    let mut child = program
        .spawn()
        .map_err(|error| io::Error::new(error.kind(), format!("{OPENER} cannot be started: {error}")))?;
    // Without a thread that waits for it, an ended child would stay in the process list.
    thread::spawn(move || child.wait());
    Ok(())
}
