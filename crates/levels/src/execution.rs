//! What the processes have in common: the upper of the two state tables (II.2.2.2).
//!
//! The lower tables belong to commands; this one decides whether they are consulted at all. An outcome, once reached, stays until a new
//! command number comes.
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
//! A process consults in turn, until a row decides: [`EXECUTE`], its table ACCEPT with what a new command needs, its table of what all
//! commands have in common, if it has one, and the table of the command. `docs/design/tables.md` tells more.

use rcs_core::{
    Actions, Plain, Variables, decision_table,
    handshake::{Arrival, Lower, Receiver},
    interface::{Decided, Header, Reason, Report},
    name::Name16,
    table::{Choice, Decision, Verdict},
    tick::Tick,
};

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
            1: arrival: Nothing     => Rest      -> Idle;
            2: arrival: Restarted   => Refuse    -> Error;
            3: arrival: New         => Begin     -> Executing;
        }
        Executing {
            4: arrival: Same        => Continue;
        }
        Idle | Done | Error | Joystick {
            5: arrival: Same        => Rest;
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

impl Asked {
    /// What [`Receiver::observe`] says, for a table ACCEPT.
    #[must_use]
    pub fn of(arrival: Arrival) -> Self {
        if arrival == Arrival::New { Self::Now } else { Self::Before }
    }
}

/// What a table ACCEPT decides in a process that does something beside its command in the same tick: it watches or calibrates.
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

/// The current command of a process and how far it has come.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Execution {
    /// Echo and adoption.
    pub receiver: Receiver,
    /// How far it has come.
    pub outcome: Outcome,
    /// Why it failed.
    pub reason: Reason,
    /// The row that decided last, if any has.
    pub decided: Option<Decided>,
}

/// Number of [`EXECUTE`] in every process.
const EXECUTE_NUMBER: u8 = 1;
/// Number of the table ACCEPT in every process.
const ACCEPT_NUMBER: u8 = 2;

impl Execution {
    /// Consult [`EXECUTE`].
    pub fn course(&mut self, arrival: Arrival) -> Course {
        let decision = execute(self.outcome, &Buffer { arrival });
        self.outcome = decision.next;
        match decision.action {
            Course::Refuse => {
                self.reason = Reason::Restarted;
                self.decided = Some(Decided { table: EXECUTE_NUMBER, row: decision.row });
            }
            Course::Begin => self.reason = Reason::None,
            Course::Rest | Course::Continue => {}
        }
        decision.action
    }

    /// Consult [`EXECUTE`], and the tables of the process if it says so: from the step `first` if the command is new, else from `step`.
    /// Gives the action of the row that decided; none if no table of the process was consulted.
    pub fn decide<Action, Step: Copy>(
        &mut self,
        arrival: Arrival,
        first: Step,
        step: &mut Step,
        tables: impl FnOnce(Step) -> Choice<Action, Step>,
    ) -> Option<Action> {
        match self.course(arrival) {
            Course::Rest | Course::Refuse => return None,
            Course::Begin => *step = first,
            Course::Continue => {}
        }
        let choice = tables(*step);
        self.note(&choice);
        *step = choice.next;
        Some(choice.action)
    }

    /// Note what a table ACCEPT has decided whose process does more in the same tick. False if it refused the command.
    pub fn accepts<Step>(&mut self, verdict: &Verdict<Refusal, Step, ()>) -> bool {
        match *verdict {
            Verdict::Passed(()) => true,
            Verdict::Decided(Decision { row, action: Refusal::Fail(reason), .. }) => {
                self.decided = Some(Decided { table: ACCEPT_NUMBER, row });
                self.fail(reason);
                false
            }
        }
    }

    /// Note which row of which table fired.
    pub fn note<Action, Step>(&mut self, choice: &Choice<Action, Step>) {
        self.decided = Some(Decided { table: choice.table, row: choice.row });
    }

    /// True in the tick in which a command was accepted: `arrival` is that of the tick, and no row of ACCEPT has refused it.
    #[must_use]
    pub fn begins(&self, arrival: Arrival) -> bool {
        arrival == Arrival::New && self.decided.is_none_or(|decided| decided.table != ACCEPT_NUMBER)
    }

    /// The process was dormant in the tick before: the next command number it reads is adopted, not executed.
    pub fn wake(&mut self) {
        self.receiver = Receiver::default();
    }

    /// The command is finished.
    pub fn finish(&mut self) {
        self.outcome = Outcome::Done;
    }

    /// The command failed.
    pub fn fail(&mut self, reason: Reason) {
        self.outcome = Outcome::Error;
        self.reason = reason;
    }

    /// The process below ended with something other than done: pass it up.
    pub fn pass_up(&mut self, lower: Lower, reason: Reason) {
        match lower {
            Lower::Joystick => {
                self.outcome = Outcome::Joystick;
                self.reason = Reason::JoystickOn;
            }
            Lower::Lost => self.fail(Reason::NeighbourLost),
            Lower::Pending | Lower::Executing | Lower::Done | Lower::Error => self.fail(reason),
        }
    }

    /// The outcome as `status-report` (V.2.2, V.3.2).
    #[must_use]
    pub const fn report(&self) -> Report {
        match self.outcome {
            Outcome::Idle => Report::Idle,
            Outcome::Executing => Report::Executing,
            Outcome::Done => Report::Done,
            Outcome::Error => Report::Error,
            Outcome::Joystick => Report::JoystickOn,
        }
    }

    /// The header of the outputs of this tick; `step` is the text of the command's step.
    #[must_use]
    pub fn header(&self, tick: Tick, step: &str) -> Header {
        Header {
            stamp: tick,
            republished: false,
            decided: self.decided,
            step: Some(Name16::clipped(step)).filter(|step| !step.is_empty()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_outcome_stays_until_a_new_number_comes() {
        let mut e = Execution::default();
        let mut course = |number, end: fn(&mut Execution)| {
            let arrival = e.receiver.observe(number);
            let course = e.course(arrival);
            end(&mut e);
            (course, e.report(), e.reason)
        };
        assert_eq!(course(0, |_| {}), (Course::Rest, Report::Idle, Reason::None));
        assert_eq!(course(1, |_| {}), (Course::Begin, Report::Executing, Reason::None));
        assert_eq!(course(1, Execution::finish), (Course::Continue, Report::Done, Reason::None));
        assert_eq!(course(1, |_| {}), (Course::Rest, Report::Done, Reason::None));
        let refuse = |e: &mut Execution| e.fail(Reason::UnknownObject);
        assert_eq!(course(2, refuse), (Course::Begin, Report::Error, Reason::UnknownObject));
        assert_eq!(course(2, |_| {}), (Course::Rest, Report::Error, Reason::UnknownObject));
        assert_eq!(course(3, |_| {}), (Course::Begin, Report::Executing, Reason::None));
    }

    #[test]
    fn a_refusal_beside_something_else_ends_the_command() {
        let mut e = Execution::default();
        e.course(Arrival::New);
        assert!(e.accepts(&Verdict::<Refusal, (), ()>::Passed(())));
        assert_eq!((e.report(), e.decided), (Report::Executing, None));
        let refusal = Decision { row: 2, action: Refusal::Fail(Reason::UnknownCommand), next: () };
        assert!(!e.accepts(&Verdict::Decided(refusal)));
        assert_eq!((e.report(), e.reason), (Report::Error, Reason::UnknownCommand));
        assert_eq!(e.decided, Some(Decided { table: ACCEPT_NUMBER, row: 2 }));
        assert!(!e.begins(Arrival::New));
    }

    #[test]
    fn a_restarted_process_refuses_what_stands_in_its_buffer() {
        let mut e = Execution::default();
        let arrival = e.receiver.observe(7);
        assert_eq!((e.course(arrival), e.reason), (Course::Refuse, Reason::Restarted));
        assert_eq!(e.decided, Some(Decided { table: EXECUTE_NUMBER, row: 2 }));
    }
}
