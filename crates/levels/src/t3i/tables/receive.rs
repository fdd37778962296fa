//! The command from Prim.

use rcs_core::{Actions, Plain, decision_table};

/// What to do with the command in the buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain, Actions)]
pub enum T3iIntake {
    /// Go on with the current command.
    Keep,
    /// Empty the queue, forget all faults, and begin the link again.
    Restart,
    /// Empty the queue.
    Pause,
    /// Append the point to the queue.
    Append,
    /// Leave the point out; the reason is already reported.
    Ignore,
    /// Empty the queue and report an invalid command.
    Refuse,
}

decision_table! {
    /// RECEIVE (VI.1.1): is the command taken? A refusal lasts until RESTART or PAUSE, because the next
    /// point is already on its way when Prim reads of it; a failed link until RESTART.
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
