//! Execution of commands by every double: it takes a new command and works on it for some ticks.

use rcs_core::handshake::{Arrival, Receiver};

/// The activity of a double in a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    Takes,
    /// The command ends in this tick.
    Ends,
    /// It works, or has no command.
    Waits,
}

/// The last command of a double, and the remaining ticks of work.
#[derive(Clone, Debug, Default)]
pub struct Worker {
    receiver: Receiver,
    left: u32,
}

impl Worker {
    /// A tick with a command number in the buffer; the command takes `ticks`.
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
