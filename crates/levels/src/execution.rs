//! The table common to all processes: the upper of the two state tables (II.2.2.2).
//!
//! The lower tables belong to commands; this one decides whether they are consulted at all. An outcome, once
//! reached, stays until a new command number comes.
//!
//! ```text
//!            new number           table says Finish
//!   Idle ----------------> Executing ----------------> Done
//!                           ^   |  \
//!                           |   |   `-- table says JoystickOn --> Joystick
//!                           |   |
//!                           |   | table says Fail
//!   Error <-----------------|---'
//!     |______ new number ___|
//! ```
//!
//! What a process consults in addition, and in which order, is declared once: `before` and `after` in `commands!`
//! of its `tables/mod.rs`. The function `decide` that follows from it is described in `docs/design/tables.md`
//! "Order of the tables". [`Execution::halt`] and [`Execution::effect`] are in [`halt`](crate::halt), and
//! [`Execution::confirm`] in [`confirm`](crate::confirm).

use interfaces::{Reason, StatusReport, Unconfirmed};
use rcs_core::{
    Actions, Plain, Variables, decision_table,
    handshake::{Arrival, Lower, Receiver},
    table::{Decision, Verdict},
    tick::Tick,
};

use crate::{halt::Halt, rows::Rows};

/// How far the current command has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Outcome {
    /// Nothing was commanded yet.
    Idle,
    /// Under way.
    Executing,
    /// Finished.
    Done,
    /// Failed.
    Error,
    /// Given up, because the operator took the robot.
    Joystick,
}

impl Outcome {
    /// The same as `status-report` (V.2.2, V.3.2).
    #[must_use]
    pub const fn report(self) -> StatusReport {
        match self {
            Self::Idle => StatusReport::Idle,
            Self::Executing => StatusReport::Executing,
            Self::Done => StatusReport::Done,
            Self::Error => StatusReport::Error,
            Self::Joystick => StatusReport::JoystickOn,
        }
    }
}

/// What to do with the tables of the current command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain, Actions)]
pub enum Course {
    /// Leave everything as it is.
    Rest,
    /// Report that the command was not executed, because the process was restarted.
    Refuse,
    /// Consult the tables, from the first step.
    Begin,
    /// Consult the tables.
    Continue,
}

/// The command buffer, for [`EXECUTE`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct Buffer {
    /// What the command buffer holds now.
    pub arrival: Arrival,
}

decision_table! {
    /// Upper state table: are the tables of the current command consulted?
    pub EXECUTE: fn execute(Outcome, Buffer) -> Course {
        any {
            1: arrival: Nothing    => Rest    -> Idle;
            2: arrival: Restarted  => Refuse  -> Error;
            3: arrival: New        => Begin   -> Executing;
        }
        Executing {
            4: arrival: Same       => Continue;
        }
        Idle | Done | Error | Joystick {
            5: arrival: Same       => Rest;
        }
    }
}

/// Is the command in the buffer a new one? Only then it is checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Asked {
    /// No: the current command goes on.
    Before,
    /// Yes.
    Now,
}

/// What a table ACCEPT decides in a process that does something beside its command in the same tick: it
/// watches or calibrates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Refusal {
    /// Report an error.
    Fail(Reason),
}

/// What the current command has ordered last of a process below, once failures are passed up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Work {
    /// It is not done yet.
    Busy,
    /// It is done, or nothing was ordered.
    Over,
}

/// A row that has ordered something of a process below.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub struct LastOrder {
    /// Its table.
    pub table: u8,
    /// Its number.
    pub row: u8,
    /// The state variables of its table at that time, as one number.
    pub variables: u64,
}

/// The actions with which a command ends, for [`CONFIRM`](crate::confirm::CONFIRM).
pub trait Ending: Sized {
    const WAIT: Self;

    fn fail(reason: Reason) -> Self;

    /// The action reports the command as done.
    fn ends(&self) -> bool;
}

/// The current command of a process and how far it has come.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Execution {
    /// Echo and adoption.
    pub receiver: Receiver,
    /// How far it has come.
    pub outcome: Outcome,
    /// Why it failed.
    pub reason: Reason,
    /// Part of its goal that no sensor has confirmed at its end.
    pub unconfirmed: Unconfirmed,
    /// The rows for the header.
    pub rows: Rows,
    /// The command is new and neither accepted nor refused yet.
    pub waiting: bool,
    /// What is done so that it can be.
    pub halt: Halt,
    /// What was ordered last for the command.
    pub last_order: Option<LastOrder>,
    /// Ticks for which a row has reported it done and the sensors have contradicted.
    pub claimed: u8,
}

/// How far a command has come, for the process above.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Report {
    pub outcome: Outcome,
    pub reason: Reason,
    /// Part of the goal that no sensor has confirmed, for a command that is done.
    pub unconfirmed: Unconfirmed,
}

/// Number of [`EXECUTE`] in every process.
const EXECUTE_NUMBER: u8 = 1;
/// Number of the table ACCEPT in every process.
const ACCEPT_NUMBER: u8 = 2;

impl Execution {
    /// A tick begins: read the number of the command in the buffer. Is the command to be accepted or refused, as soon
    /// as HALT allows it?
    pub fn observe(&mut self, tick: Tick, number: u32) -> (Arrival, Asked) {
        self.rows.begin(tick);
        let arrival = self.receiver.observe(number);
        let is_asked = self.waiting || arrival == Arrival::New;
        (arrival, if is_asked { Asked::Now } else { Asked::Before })
    }

    /// The process was dormant in the tick before: the next command number it reads is adopted, not executed.
    pub fn wake(&mut self) {
        self.receiver = Receiver::default();
    }

    /// Consult [`EXECUTE`].
    pub fn execute(&mut self, arrival: Arrival) -> Course {
        let decision = execute(self.outcome, &Buffer { arrival });
        self.outcome = decision.next;
        match decision.action {
            Course::Refuse => {
                self.reason = Reason::Restarted;
                self.rows.decide(&decision.of(EXECUTE_NUMBER));
            }
            Course::Begin => {
                (self.reason, self.unconfirmed, self.claimed) = (Reason::None, Unconfirmed::None, 0);
            }
            Course::Rest | Course::Continue => {}
        }
        decision.action
    }

    /// Note what a table ACCEPT has decided whose process does more in the same tick. False if it refused the
    /// command.
    pub fn accepts<Step>(&mut self, verdict: Verdict<Refusal, Step, ()>) -> bool {
        match verdict {
            Verdict::Passed(()) => true,
            Verdict::Decided(decision @ Decision { action: Refusal::Fail(reason), .. }) => {
                self.rows.decide(&decision.of(ACCEPT_NUMBER));
                self.fail(reason);
                false
            }
        }
    }

    /// True in the tick in which a command was accepted: `asked` is that of the tick, HALT has let the command pass, and
    /// none of the tables that check a new command has refused it. `checks` are the numbers of these tables.
    #[must_use]
    pub fn accepted(&self, asked: Asked, checks: &[u8]) -> bool {
        let is_refused = self.rows.decided.is_some_and(|decided| checks.contains(&decided.table));
        asked == Asked::Now && !self.waiting && !is_refused
    }

    pub fn finish(&mut self) {
        self.outcome = Outcome::Done;
    }

    pub fn fail(&mut self, reason: Reason) {
        (self.outcome, self.reason) = (Outcome::Error, reason);
    }

    /// The process below ended with something other than done: pass it up.
    pub fn pass_up(&mut self, lower: Lower, reason: Reason) {
        match lower {
            Lower::Joystick => (self.outcome, self.reason) = (Outcome::Joystick, Reason::JoystickOn),
            Lower::Lost => self.fail(Reason::NeighbourLost),
            Lower::Pending | Lower::Executing | Lower::Done | Lower::Error => self.fail(reason),
        }
    }

    /// What the process above is to see. A process that was restarted executes until what it had commanded is at rest.
    ///
    /// `standing` is the reason that the process below reports while the command is a PAUSE. A link that fails while a
    /// PAUSE stands is no failure of it: the reason accompanies `done` (docs/design/link.md).
    #[must_use]
    pub const fn report(&self, standing: Option<Reason>) -> Report {
        let Self { outcome, reason, .. } = *self;
        match (outcome, self.halt, standing) {
            (Outcome::Error, Halt::Stopping, _) => {
                Report { outcome: Outcome::Executing, reason: Reason::None, unconfirmed: Unconfirmed::None }
            }
            (Outcome::Done, _, Some(below)) => {
                Report { outcome, reason: below, unconfirmed: self.unconfirmed }
            }
            (Outcome::Done, _, None) => Report { outcome, reason, unconfirmed: self.unconfirmed },
            (Outcome::Idle | Outcome::Executing | Outcome::Error | Outcome::Joystick, ..) => {
                Report { outcome, reason, unconfirmed: Unconfirmed::None }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::Decided;
    use rcs_core::table::Values;

    #[test]
    fn an_outcome_stays_until_a_new_number_comes() {
        let mut e = Execution::default();
        let mut course = |number, end: fn(&mut Execution)| {
            let arrival = e.receiver.observe(number);
            let course = e.execute(arrival);
            end(&mut e);
            (course, e.outcome, e.reason)
        };
        assert_eq!(course(0, |_| {}), (Course::Rest, Outcome::Idle, Reason::None));
        assert_eq!(course(1, |_| {}), (Course::Begin, Outcome::Executing, Reason::None));
        assert_eq!(course(1, Execution::finish), (Course::Continue, Outcome::Done, Reason::None));
        assert_eq!(course(1, |_| {}), (Course::Rest, Outcome::Done, Reason::None));
        let refuse = |e: &mut Execution| e.fail(Reason::UnknownObject);
        assert_eq!(course(2, refuse), (Course::Begin, Outcome::Error, Reason::UnknownObject));
        assert_eq!(course(2, |_| {}), (Course::Rest, Outcome::Error, Reason::UnknownObject));
        assert_eq!(course(3, |_| {}), (Course::Begin, Outcome::Executing, Reason::None));
    }

    #[test]
    fn a_refusal_beside_something_else_ends_the_command() {
        let mut e = Execution::default();
        e.execute(Arrival::New);
        assert!(e.accepts(Verdict::<Refusal, (), ()>::Passed(())));
        assert_eq!((e.outcome, e.rows.decided), (Outcome::Executing, None));
        let action = Refusal::Fail(Reason::UnknownCommand);
        let refusal = Decision { row: 2, action, next: (), values: Values::default() };
        assert!(!e.accepts(Verdict::Decided(refusal)));
        assert_eq!((e.outcome, e.reason), (Outcome::Error, Reason::UnknownCommand));
        assert_eq!(e.rows.decided, Some(Decided { table: ACCEPT_NUMBER, row: 2 }));
        assert!(!e.accepted(Asked::Now, &[ACCEPT_NUMBER]));
        assert!(e.accepted(Asked::Now, &[ACCEPT_NUMBER + 1]), "another table decided");
    }

    #[test]
    fn reason_from_below_accompanies_a_standing_pause_and_nothing_else() {
        let mut e = Execution::default();
        e.finish();
        let report = |e: &Execution, standing| (e.report(standing).outcome, e.report(standing).reason);
        assert_eq!(report(&e, None), (Outcome::Done, Reason::None));
        assert_eq!(report(&e, Some(Reason::LinkOff)), (Outcome::Done, Reason::LinkOff));
        e.fail(Reason::NotAtGoal);
        assert_eq!(report(&e, Some(Reason::LinkOff)), (Outcome::Error, Reason::NotAtGoal));
    }

    #[test]
    fn a_restarted_process_refuses_what_stands_in_its_buffer() {
        let mut e = Execution::default();
        let arrival = e.receiver.observe(7);
        assert_eq!((e.execute(arrival), e.reason), (Course::Refuse, Reason::Restarted));
        assert_eq!(e.rows.decided, Some(Decided { table: EXECUTE_NUMBER, row: 2 }));
    }
}
