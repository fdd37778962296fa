//! SIGINT, SIGTERM and SIGHUP end a gateway in order.

use std::io;

use signal_hook::{
    consts::{SIGHUP, SIGINT, SIGTERM},
    iterator::Signals,
};

pub fn receive() -> io::Result<Signals> {
    Signals::new([SIGINT, SIGTERM, SIGHUP])
}

pub fn wait(mut signals: Signals) {
    signals.forever().next();
}
