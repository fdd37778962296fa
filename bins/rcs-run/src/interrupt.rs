//! Signals that end a command in an orderly way.

use std::sync::{Arc, atomic::AtomicBool};

use signal_hook::{
    consts::{SIGHUP, SIGINT, SIGTERM},
    flag,
};

use crate::error::Error;

/// A flag that an interrupt, a hang-up or a termination request sets; the second signal ends the program at once.
///
/// # Errors
/// [`Error::Signals`] if the system refuses the handlers.
pub fn interruption() -> Result<Arc<AtomicBool>, Error> {
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM, SIGHUP] {
        flag::register_conditional_shutdown(signal, 128 + signal, Arc::clone(&stop))
            .map_err(Error::Signals)?;
        flag::register(signal, Arc::clone(&stop)).map_err(Error::Signals)?;
    }
    Ok(stop)
}
