//! The table common to all processes: the upper of the two state tables (II.2.2.2).
//!
//! The lower tables belong to commands; this one decides whether they are consulted. An outcome stays until a new
//! command number arrives.
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
//! The other tables of a process and their order are declared once: `before` and `after` in `commands!` of its
//! `tables/mod.rs`. The function `decide` that follows from it is described in `docs/design/tables.md` "Order of
//! the tables". [`Execution::halt`] and [`Execution::effect`] are in [`halt`](crate::halt), and
//! [`Execution::confirm`] in [`confirm`](crate::confirm).

use interfaces::{Reason, StatusReport, Unconfirmed};
use rcs_core::{
    Actions, Plain, Variables, decision_table,
    handshake::{Arrival, Lower, Receiver},
    table::{Decision, Verdict},
    tick::Tick,
};

use crate::{halt::Halt, rows::Rows};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Outcome {
    /// No command has arrived yet.
    Idle,
    /// The command is in execution.
    Executing,
    /// The command is done.
    Done,
    /// The command has failed.
    Error,
    /// The command was given up because the operator took the robot.
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

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain, Actions)]
pub enum Course {
    /// Do not consult the tables.
    Rest,
    /// Report that the command was not executed, because the process was restarted.
    Refuse,
    /// Consult the tables, from the first step.
    Begin,
    /// Consult the tables from the current step.
    Continue,
}

#[derive(Clone, Copy, Debug, Variables)]
pub struct Buffer {
    /// Whether the command is new.
    pub arrival: Arrival,
}

decision_table! {
    /// EXECUTE, the upper state table: decides whether the tables of the current command are consulted.
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

/// Whether the command in the buffer is new. Only a new one is checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Asked {
    /// The command is not new: it continues.
    Before,
    /// The command is new.
    Now,
}

/// The result of ACCEPT in a process that does something else in the same tick as its command, such as watching or
/// calibrating.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Refusal {
    /// Report an error.
    Fail(Reason),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Work {
    /// The order is not done yet.
    Busy,
    /// The order is done, or there was none.
    Over,
}

/// A row that has given an order to a process below.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub struct LastOrder {
    pub table: u8,
    pub row: u8,
    pub variables: u64, // the state variables in that tick, as one number
}

pub trait Ending: Sized {
    const WAIT: Self;

    fn fail(reason: Reason) -> Self;

    fn ends(&self) -> bool;
}

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Execution {
    pub receiver: Receiver,
    pub outcome: Outcome,
    pub reason: Reason,
    pub unconfirmed: Unconfirmed, // at the end of the command
    pub rows: Rows,
    pub waiting: bool, // the command is neither accepted nor refused yet
    pub halt: Halt,
    pub last_order: Option<LastOrder>,
    pub claimed: u8, // ticks in which a row reported done and the sensors contradicted
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Report {
    pub outcome: Outcome,
    pub reason: Reason,
    pub unconfirmed: Unconfirmed,
}

const EXECUTE_NUMBER: u8 = 1; // in every process
const ACCEPT_NUMBER: u8 = 2; // in every process

impl Execution {
    /// Start a tick: read the number of the command in the buffer. Also returns whether the command is to be
    /// accepted or refused as soon as HALT permits it.
    pub fn observe(&mut self, tick: Tick, number: u32) -> (Arrival, Asked) {
        self.rows.begin(tick);
        let arrival = self.receiver.observe(number);
        let is_asked = self.waiting || arrival == Arrival::New;
        (arrival, if is_asked { Asked::Now } else { Asked::Before })
    }

    /// Call if the process was dormant in the previous tick. The next command number is adopted, not executed.
    pub fn wake(&mut self) {
        self.receiver = Receiver::default();
    }

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

    /// Record the result of ACCEPT, for a process that does more in the same tick. False if ACCEPT refused the
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

    /// True in the tick in which a command is accepted: `asked` is that of the tick, HALT has passed the command,
    /// and none of the tables that check it has refused it. `checks` are the numbers of these tables.
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

    pub fn pass_up(&mut self, lower: Lower, reason: Reason) {
        match lower {
            Lower::Joystick => (self.outcome, self.reason) = (Outcome::Joystick, Reason::JoystickOn),
            Lower::Lost => self.fail(Reason::NeighbourLost),
            Lower::Pending | Lower::Executing | Lower::Done | Lower::Error => self.fail(reason),
        }
    }

    /// A restarted process reports executing until its previous orders are at rest.
    ///
    /// `standing` is the reason from the process below during a PAUSE. A link failure does not fail a PAUSE; its reason
    /// accompanies `done` (docs/design/link.md).
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
    fn outcome_stays_until_a_new_number() {
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
    fn refusal_with_other_work_ends_the_command() {
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
    fn restarted_process_refuses_the_command_in_its_buffer() {
        let mut e = Execution::default();
        let arrival = e.receiver.observe(7);
        assert_eq!((e.execute(arrival), e.reason), (Course::Refuse, Reason::Restarted));
        assert_eq!(e.rows.decided, Some(Decided { table: EXECUTE_NUMBER, row: 2 }));
    }
}
