//! How every double executes its commands: it takes a new one, and works on it for some ticks.

use rcs_core::handshake::{Arrival, Receiver};

/// What a double does in a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    Takes,
    /// The command ends in this tick.
    Ends,
    /// It works, or has nothing to do.
    Waits,
}

/// The last command that a double has taken, and how long it still works on it.
#[derive(Clone, Debug, Default)]
pub struct Worker {
    receiver: Receiver,
    left: u32,
}

impl Worker {
    /// A tick in which a command with a number is in the buffer. It takes so many ticks.
    pub fn turn(&mut self, number: u32, ticks: u32) -> Turn {
        if self.receiver.observe(number) == Arrival::New {
            self.left = ticks;
            return Turn::Takes;
        }
        let ends = self.left == 1;
        self.left = self.left.saturating_sub(1);
        if ends { Turn::Ends } else { Turn::Waits }
    }

    pub const fn echo(&self) -> u32 {
        self.receiver.echo
    }

    pub const fn is_working(&self) -> bool {
        self.left > 0
    }

    pub const fn stop(&mut self) {
        self.left = 0;
    }
}
