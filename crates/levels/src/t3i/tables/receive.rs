//! The command from Prim.

use rcs_core::{Actions, Plain, decision_table};

/// What to do with the command in the buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain, Actions)]
pub enum T3iIntake {
    /// Continue the current command.
    Keep,
    /// Empty the queue, clear all faults, and start the link again.
    Restart,
    /// Empty the queue.
    Pause,
    /// Append the point to the queue.
    Append,
    /// Drop the point; the reason is already reported.
    Ignore,
    /// Empty the queue and report an invalid command.
    Refuse,
}

decision_table! {
    /// RECEIVE (VI.1.1): decides whether the command is accepted. A refusal lasts until RESTART or PAUSE, because
    /// the next point is already in transit when Prim reads it. A failed link lasts until RESTART.
    pub RECEIVE: fn receive(enum ReceiveStep, super::Request) -> T3iIntake {
        any {
            1:  arrival: Nothing | Same                                      => Keep;
            2:  arrival: Restarted                                           => Keep     -> Refusing;
            3:  arrival: New, command: Restart                               => Restart  -> Accepting;
            4:  arrival: New, command: Pause                                 => Pause    -> Accepting;
            5:  arrival: New, command: None                                  => Refuse   -> Refusing;
        }
        /// No command was refused since the last RESTART or PAUSE.
        Accepting {
            6:  arrival: New, link: Failed                                   => Ignore;
            7:  arrival: New, link: Starting                                 => Refuse   -> Refusing;
            8:  arrival: New, link: Running, point: Gap | Unsendable | Full  => Refuse   -> Refusing;
            9:  arrival: New, link: Running, point: Next                     => Append;
        }
        /// A command was refused: `status-arg-out` 5.
        Refusing {
            10: arrival: New                                                 => Ignore;
        }
    }
}
