//! Execution of commands by every double: it takes a new command and works on it for some ticks.

use rcs_core::handshake::{Arrival, Receiver};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    Takes,
    Ends,  // the command ends in this tick
    Waits, // works, or has no command
}

/// Ticks of work that are left for the last command.
#[derive(Clone, Debug, Default)]
pub struct Worker {
    receiver: Receiver,
    left: u32,
}

impl Worker {
    /// `number` is the command number in the buffer; a command takes `ticks`.
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
