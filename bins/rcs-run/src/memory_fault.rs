//! Messages for failures of shared memory, in the operating system or in iceoryx2.
//!
//! Shared memory consists of files in a memory file system. If it is full when a page is first written, or if another
//! process truncates such a file, the system can only end the program with the signal SIGBUS, without a reason.
//! `executive::memory::place` checks the free space before, but other programs can fill `/dev/shm` in between.
//!
//! If another process damages shared memory during its set-up, iceoryx2 can wait forever ([`stuck`]).

use std::{sync::Arc, time::Duration};

use os_io::stderr_line;
use rustix::{io::write, stdio::stderr};
use signal_hook::{
    consts::{SIGBUS, SIGXFSZ},
    flag,
    low_level::{exit, register},
};

use crate::rcs_run::error::{Error, STOPPED, UNUSABLE};

const WORDS: &[u8] =
    b"\nrcs-run: shared memory went away under the program: /dev/shm is full, or another process cut an object short; \
      the robot gets no further point\n";

/// Turn the signal at the file size limit of `ulimit -f` into an error of the write, like that of a full disk, so that
/// the program does not end.
///
/// # Errors
/// [`Error::Signals`] if the system refuses the handler.
pub fn survive_file_limit() -> Result<(), Error> {
    flag::register(SIGXFSZ, Arc::default()).map(drop).map_err(Error::Signals)
}

/// Make this program print the reason when SIGBUS ends it for lack of memory. The exit status is that of a stopped
/// robot.
///
/// # Errors
/// [`Error::Signals`] if the system refuses the handler.
#[expect(unsafe_code, reason = "what a signal handler may do is for its author to see to")]
pub fn explain() -> Result<(), Error> {
    let last_words = || {
        // A failure of this write cannot be reported.
        let _ = write(stderr(), WORDS);
        exit(i32::from(STOPPED));
    };
    // SAFETY: a handler may call `write` and `_exit`, which `exit` is. The handler does not allocate or lock, and does
    // not return to the code that failed.
    unsafe { register(SIGBUS, last_words) }.map(drop).map_err(Error::Signals)
}

/// End this program: the set-up of shared memory took too long. Nothing has moved.
pub fn stuck(limit: Duration) {
    stderr_line!(
        "rcs-run: shared memory was not set up within {} s: another program damages it; end that, or do without by \
         --shared-memory off",
        limit.as_secs()
    );
    exit(i32::from(UNUSABLE));
}
