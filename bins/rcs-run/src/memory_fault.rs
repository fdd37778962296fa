//! What this program says when the system or iceoryx2 fails it.
//!
//! Shared memory lies in files of a file system in memory. If that is full when a page is first touched, or
//! if another process cuts such a file short, the system can only end the program, by the signal SIGBUS,
//! without a reason. What can be asked beforehand is asked (`executive::memory::place`), but others can fill
//! `/dev/shm` between the question and the touch.
//!
//! If another process damages shared memory while it is set up, iceoryx2 can wait without end ([`stuck`]).

use std::{sync::Arc, time::Duration};

use os_io::stderr_line;
use rustix::{io::write, stdio::stderr};
use signal_hook::{
    consts::{SIGBUS, SIGXFSZ},
    flag,
    low_level::{exit, register},
};

use crate::error::{Error, STOPPED, UNUSABLE};

const WORDS: &[u8] =
    b"\nrcs-run: shared memory went away under the program: /dev/shm is full, or another process cut an object short; \
      the robot gets no further point\n";

/// A file that reaches the limit of `ulimit -f` ends with an error of the write, such as a full disk gives,
/// and not the program.
///
/// # Errors
/// [`Error::Signals`] if the system does not take a handler.
pub fn survive_file_limit() -> Result<(), Error> {
    flag::register(SIGXFSZ, Arc::default()).map(drop).map_err(Error::Signals)
}

/// Have this program say why when the system ends it for want of memory. The exit status is that of a robot
/// that was stopped.
///
/// # Errors
/// [`Error::Signals`] if the system does not take a handler.
#[expect(unsafe_code, reason = "what a signal handler may do is for its author to see to")]
pub fn explain() -> Result<(), Error> {
    let last_words = || {
        // If this fails there is nothing left to do.
        let _ = write(stderr(), WORDS);
        exit(i32::from(STOPPED));
    };
    // SAFETY: `write` and `_exit`, which `exit` is, are among the calls that a handler may make; nothing is
    // allocated or locked, and the handler does not return to what cannot go on.
    unsafe { register(SIGBUS, last_words) }.map(drop).map_err(Error::Signals)
}

/// End this program: shared memory was not set up in time. Nothing has moved.
pub fn stuck(limit: Duration) {
    stderr_line!(
        "rcs-run: shared memory was not set up within {} s: another program has damaged it meanwhile; \
         end that program and try again; a run on one board can do without: --shared-memory off",
        limit.as_secs()
    );
    exit(i32::from(UNUSABLE));
}
