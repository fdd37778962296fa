//! Messages for failures of shared memory, in the operating system or in iceoryx2.
//!
//! If shared memory is full when a page is first written, or another process truncates a file, the system ends the
//! program with SIGBUS. `executive::memory::place` checks the free space beforehand. If another process damages shared
//! memory during its set-up, iceoryx2 can wait forever ([`stuck`]).

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

/// Turn the signal at the file size limit of `ulimit -f` into an error of the write.
pub fn survive_file_limit() -> Result<(), Error> {
    flag::register(SIGXFSZ, Arc::default()).map(drop).map_err(Error::Signals)
}

/// Make this program print the reason when SIGBUS ends it. The exit status is that of a stopped robot.
#[expect(unsafe_code, reason = "what a signal handler may do is for its author to see to")]
pub fn explain() -> Result<(), Error> {
    let last_words = || {
        // A failure of this write cannot be reported.
        let _ = write(stderr(), WORDS);
        exit(i32::from(STOPPED));
    };
    // SAFETY: the handler only calls `write` and `exit`, which may be called in a handler. It does not return.
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
