//! Command numbers and echoes between two processes (docs/design/handshake.md).
//!
//! A receiver echoes the number of a command with *its* status. A status is valid only for the last command, and a
//! repeated text is new only with a new number. A restarted process neither executes an old command nor uses an old
//! status.
//!
//! | tick | commander                     | receiver                                  |
//! |------|-------------------------------|-------------------------------------------|
//! | k    | writes number n               |                                           |
//! | k+1  | reads echo n-1: `Pending`     | reads n, acts, writes echo n and status   |
//! | k+2  | reads echo n and its status   |                                           |

use crate::{Plain, header::Header, tick::Tick};

/// Ticks after which a command without an echo is treated as lost.
pub const ECHO_LIMIT: u64 = 3;

/// A starting commander begins this far after the last number that it finds, beyond those of commands in transit.
pub const FIRST_STEP: u32 = 4;

/// The command number after `number`. Numbers wrap around and skip 0, which means none.
#[must_use]
pub const fn successor(number: u32) -> u32 {
    match number.checked_add(1) {
        Some(next) => next,
        None => 1,
    }
}

/// The status of a subordinate, as its commander reads it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Lower {
    /// The last command is not echoed yet, so it is neither done nor failed.
    Pending,
    /// The last command is being executed.
    Executing,
    /// The last command is done.
    Done,
    /// The last command failed.
    Error,
    /// The operator controls the robot.
    #[text = "joystick-on"]
    Joystick,
    /// The subordinate does not answer: its stamp is old, or it does not echo.
    Lost,
}

/// The output buffers of a process, as its commander reads them.
pub trait Answer {
    /// Stamp and row.
    fn header(&self) -> &Header;

    /// Number of the command to which the status belongs.
    fn echo(&self) -> u32;

    /// The report as a state variable of the superior.
    fn report(&self) -> Lower;
}

/// The commander's side of one interface.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Commander {
    /// Number of the last command; 0 before the first.
    pub number: u32,
    /// Tick in which it was written.
    pub sent: Tick,
    /// A command has been sent since the start.
    pub started: bool,
}

impl Commander {
    /// Call first in a tick, for devices and other systems: adopts the subordinate's echo before the first command.
    pub fn start(&mut self, echo: u32) {
        if !self.started {
            self.number = echo;
        }
    }

    /// Like [`Self::start`], for a commander of a process. Its output buffer survives a restart, with the number
    /// `written` of a command that may not be echoed yet: numbers continue there. In the first tick the echo may be
    /// stale.
    pub fn start_from(&mut self, tick: Tick, written: u32, echo: u32) {
        self.start(if written == 0 { echo } else { written });
        if !self.started {
            self.sent = tick;
        }
    }

    /// Returns the number of a new command. The first skips numbers, because earlier commands may be in transit.
    pub fn send(&mut self, tick: Tick) -> u32 {
        let steps = if self.started { 1 } else { FIRST_STEP };
        for _ in 0..steps {
            self.number = successor(self.number);
        }
        self.started = true;
        self.sent = tick;
        self.number
    }

    /// Status of the subordinate: its report is valid only if its echo is the last number sent.
    #[must_use]
    pub fn status_of(&self, tick: Tick, below: &impl Answer) -> Lower {
        self.read(tick, below.header(), below.echo(), below.report())
    }

    /// Read the status of the subordinate: `report` is valid only if `echo` is the last number sent.
    #[must_use]
    pub fn read(&self, tick: Tick, below: &Header, echo: u32, report: Lower) -> Lower {
        if below.stamp != tick.previous() {
            Lower::Lost
        } else if self.number == echo {
            report
        } else if !below.republished && tick.since(self.sent) > ECHO_LIMIT {
            Lower::Lost
        } else {
            Lower::Pending
        }
    }
}

/// The present content of a process's command buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Arrival {
    /// No command was ever sent.
    Nothing,
    /// A new command.
    New,
    /// The command that is being executed.
    Same,
    /// A command that was already there when this process started. This process has not executed it.
    Restarted,
}

/// The receiver's side of one interface.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Receiver {
    /// Number of the last command read, echoed.
    pub echo: u32,
    /// The process has read its command buffer at least once.
    pub started: bool,
    /// The echoed command was adopted at the start and never executed.
    pub adopted: bool,
}

impl Receiver {
    /// Read the command number in the buffer.
    pub fn observe(&mut self, number: u32) -> Arrival {
        if !self.started {
            *self = Self { echo: number, started: true, adopted: number != 0 };
        } else if number != self.echo && number != 0 {
            *self = Self { echo: number, started: true, adopted: false };
            return Arrival::New;
        }
        if self.adopted {
            Arrival::Restarted
        } else if self.echo == 0 {
            Arrival::Nothing
        } else {
            Arrival::Same
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn header(stamp: u64) -> Header {
        Header { stamp: Tick(stamp), ..Header::default() }
    }

    #[test]
    fn a_repeated_text_is_new_only_with_a_new_number() {
        let mut receiver = Receiver::default();
        assert_eq!(receiver.observe(0), Arrival::Nothing);
        assert_eq!(receiver.observe(1), Arrival::New);
        assert_eq!(receiver.observe(1), Arrival::Same);
        assert_eq!(receiver.observe(2), Arrival::New);
    }

    #[test]
    fn a_restarted_receiver_does_not_execute_the_old_command() {
        let mut receiver = Receiver::default();
        assert_eq!(receiver.observe(7), Arrival::Restarted);
        assert_eq!(receiver.observe(7), Arrival::Restarted);
        assert_eq!(receiver.observe(8), Arrival::New);
    }

    #[test]
    fn an_old_status_is_discarded() {
        let mut commander = Commander::default();
        commander.start_from(Tick(10), 0, 41);
        assert_eq!(commander.send(Tick(10)), 41 + FIRST_STEP);
        assert_eq!(commander.read(Tick(11), &header(10), 41, Lower::Done), Lower::Pending);
        assert_eq!(
            commander.read(Tick(12), &header(11), 41 + FIRST_STEP, Lower::Executing),
            Lower::Executing
        );
        assert_eq!(commander.read(Tick(14), &header(13), 41, Lower::Done), Lower::Lost);
        assert_eq!(commander.read(Tick(14), &header(12), 42, Lower::Done), Lower::Lost);
    }

    #[test]
    fn a_command_is_lost_when_its_echo_is_later_than_the_limit() {
        let commander = Commander { number: 7, sent: Tick(10), started: true };
        let read = |tick| commander.read(Tick(tick), &header(tick - 1), 6, Lower::Done);
        assert_eq!(read(10 + ECHO_LIMIT), Lower::Pending);
        assert_eq!(read(11 + ECHO_LIMIT), Lower::Lost);
    }

    #[test]
    fn numbers_wrap_around_without_zero() {
        let mut commander = Commander { number: u32::MAX, sent: Tick(1), started: true };
        assert_eq!(commander.send(Tick(2)), 1);
    }

    #[test]
    fn restarted_commander_uses_no_number_in_transit() {
        let mut commander = Commander::default();
        commander.start_from(Tick(10), 0, 41);
        let under_way = commander.send(Tick(10));
        // The restarted commander has lost its state but not its output buffer, and reads the old echo.
        let mut restarted = Commander::default();
        restarted.start_from(Tick(11), under_way, 41);
        assert_eq!(restarted.read(Tick(11), &header(10), 41, Lower::Done), Lower::Pending, "that is another");
        let mut receiver = Receiver { echo: 41, started: true, adopted: false };
        assert_eq!(receiver.observe(under_way), Arrival::New);
        let first = restarted.send(Tick(11));
        assert_eq!(receiver.observe(first), Arrival::New);
    }

    #[test]
    fn commander_waiting_for_an_earlier_command_is_not_lost() {
        let mut commander = Commander::default();
        commander.start_from(Tick(100), 45, 41);
        assert_eq!(commander.read(Tick(100), &header(99), 41, Lower::Done), Lower::Pending);
        commander.start_from(Tick(101), 45, 45);
        assert_eq!(commander.read(Tick(101), &header(100), 45, Lower::Executing), Lower::Executing);
    }

    /// A command with an identity that distinguishes it from all others, in addition to its number.
    #[derive(Clone, Copy, Debug, Default, PartialEq)]
    struct Content {
        number: u32,
        text: usize,
    }

    proptest! {
        /// Despite any restarts, no command (by content, not number) is executed twice or gets the status of another.
        #[test]
        fn each_command_is_executed_at_most_once(events in prop::collection::vec(0_u8..12, 1..300)) {
            let mut commander = Commander::default();
            let mut receiver = Receiver::default();
            // Values of the previous tick, kept until overwritten, also over a restart.
            let (mut written, mut echo) = (Content::default(), (0_u32, Lower::Done));
            let mut current = Content::default(); // executed or adopted last: the status belongs to it
            let mut executed = std::collections::HashSet::new();
            let mut about = current;
            for (k, event) in events.into_iter().enumerate() {
                let tick = Tick(k as u64 + 1);
                match event {
                    0 => commander = Commander::default(),
                    1 => receiver = Receiver::default(),
                    _ => {}
                }
                let (old_written, old_echo, old_about) = (written, echo, about);
                commander.start_from(tick, old_written.number, old_echo.0);
                let status = commander.read(tick, &header(k as u64), old_echo.0, old_echo.1);
                if commander.started && matches!(status, Lower::Done | Lower::Executing | Lower::Error) {
                    prop_assert_eq!(old_about, old_written, "the status is that of another command");
                }
                if matches!(status, Lower::Done | Lower::Error) || (event >= 8 && status != Lower::Pending)
                    || event == 2 {
                    written = Content { number: commander.send(tick), text: k };
                }
                let arrival = receiver.observe(old_written.number);
                if arrival == Arrival::New {
                    prop_assert!(executed.insert(old_written.text), "{:?} was executed twice", old_written);
                }
                if matches!(arrival, Arrival::New | Arrival::Restarted) {
                    current = old_written;
                }
                let report = match arrival {
                    Arrival::Restarted => Lower::Error,
                    Arrival::Nothing | Arrival::Same => Lower::Done,
                    Arrival::New => Lower::Executing,
                };
                (echo, about) = ((receiver.echo, report), current);
            }
        }
    }
}
