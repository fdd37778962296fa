//! Signals that end a command in an orderly way.

use std::{
    io,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use os_io::stderr_line;
use signal_hook::{
    consts::{SIGHUP, SIGINT, SIGTERM},
    iterator::Signals,
    low_level,
};

use crate::rcs_run::error::Error;

/// Signals within this time are treated as one: a terminal, `timeout` and a service manager send several.
const SAME: Duration = Duration::from_secs(1);

/// A flag that an interrupt, a hang-up or a termination request sets. A second signal at least [`SAME`] later ends the
/// program.
pub fn interruption() -> Result<Arc<AtomicBool>, Error> {
    let stop = Arc::new(AtomicBool::new(false));
    watch(Arc::clone(&stop)).map_err(Error::Signals)?;
    Ok(stop)
}

fn watch(stop: Arc<AtomicBool>) -> io::Result<()> {
    let mut signals = Signals::new([SIGINT, SIGTERM, SIGHUP])?;
    let wait = move || {
        let mut first = None;
        for signal in signals.forever() {
            stop.store(true, Ordering::Relaxed);
            if is_second(&mut first, Instant::now()) {
                stderr_line!("rcs-run: a second signal ends the program at once");
                // This exit runs no destructors, because a blocked destructor may be the reason for the second signal.
                low_level::exit(128 + signal);
            }
        }
    };
    thread::Builder::new().name("signals".into()).spawn(wait).map(drop)
}

/// Record the first signal. Returns true for a later signal that is not treated as the same one.
fn is_second(first: &mut Option<Instant>, now: Instant) -> bool {
    now.saturating_duration_since(*first.get_or_insert(now)) > SAME
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signals_within_a_second_are_one_signal() {
        let (begin, mut first) = (Instant::now(), None);
        for milliseconds in [0, 1, 400, 1000] {
            assert!(!is_second(&mut first, begin + Duration::from_millis(milliseconds)), "{milliseconds} ms");
        }
        assert!(is_second(&mut first, begin + Duration::from_millis(1001)));
    }
}
