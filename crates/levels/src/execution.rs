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
//! A process consults in turn, until a row decides: [`EXECUTE`], its table ACCEPT with what a new command needs, its
//! table of what all commands have in common, if it has one, and the table of the command. A process with others below
//! it consults [`HALT`](crate::halt::HALT) before ACCEPT; Subtask and E-move consult [`EFFECT`](crate::halt::EFFECT)
//! after the table of the command. [`CONFIRM`](crate::confirm::CONFIRM) is consulted about a row that reports done. See `docs/design/tables.md`.

use interfaces::{Header, Reason, StatusReport, Unconfirmed};
use rcs_core::{
    Actions, Plain, Variables, decision_table,
    handshake::{Arrival, Lower, Receiver},
    table::{Choice, Decision, Verdict},
    tick::Tick,
};

use crate::{
    confirm::Proof,
    goal::Goal,
    halt::{Fired, Futile, Halt, Halting, Intake, Order, Replaced, effect, halt},
    rows::Rows,
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
    /// The state variables at that time, as one number.
    pub variables: u64,
}

/// The actions with which a command ends, for [`CONFIRM`](crate::confirm::CONFIRM).
pub trait Ending: Sized {
    /// Nothing new.
    const WAIT: Self;

    /// Report an error.
    fn fail(reason: Reason) -> Self;

    /// The action reports the command as done.
    fn ends(&self) -> bool;
}

/// The actions of a process that commands others.
pub trait Orders: Ending {
    /// A pause to the processes below.
    const STOP: Self;

    /// The action orders something of a process below that changes a state variable when it is carried out.
    fn is_order(&self) -> bool;

    /// The action of HALT.
    #[must_use]
    fn of_halt(halting: Halting) -> Self {
        match halting {
            Halting::Stop | Halting::Abandon(_) => Self::STOP,
            Halting::Wait => Self::WAIT,
        }
    }

    /// The action of EFFECT.
    #[must_use]
    fn of_effect(Futile::Fail(reason): Futile) -> Self {
        Self::fail(reason)
    }
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

/// Number of [`EXECUTE`] in every process.
const EXECUTE_NUMBER: u8 = 1;
/// Number of the table ACCEPT in every process.
const ACCEPT_NUMBER: u8 = 2;
/// Number of [`HALT`](crate::halt::HALT) in the processes that have it.
const HALT_NUMBER: u8 = 3;
/// Number of [`EFFECT`](crate::halt::EFFECT) in the processes that have it.
const EFFECT_NUMBER: u8 = 4;

impl Execution {
    /// A tick begins: read the number of the command in the buffer.
    pub fn observe(&mut self, tick: Tick, number: u32) -> Arrival {
        self.rows.begin(tick);
        self.receiver.observe(number)
    }

    /// Consult [`EXECUTE`].
    pub fn course(&mut self, arrival: Arrival) -> Course {
        let decision = execute(self.outcome, &Buffer { arrival });
        self.outcome = decision.next;
        match decision.action {
            Course::Refuse => {
                self.reason = Reason::Restarted;
                self.rows.decide(EXECUTE_NUMBER, decision.row, decision.values);
            }
            Course::Begin => {
                (self.reason, self.unconfirmed, self.claimed) = (Reason::None, Unconfirmed::None, 0);
            }
            Course::Rest | Course::Continue => {}
        }
        decision.action
    }

    /// Consult [`EXECUTE`], and the tables of the process if it says so: from the step `first` if the command
    /// is new, else from `step`. Gives the action of the row that decided; none if no table of the process
    /// was consulted.
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

    /// Consult [`HALT`](crate::halt::HALT) about what [`EXECUTE`] has said. What is to be done with the
    /// tables: `Begin` in the tick in which a command is accepted or refused.
    ///
    /// # Errors
    /// What HALT asks for: no other table is to be consulted.
    pub fn admit(&mut self, course: Course, replaced: &Replaced) -> Result<Course, Halting> {
        self.waiting |= course == Course::Begin;
        let intake = match course {
            Course::Refuse => Intake::Adopted,
            _ if self.waiting => Intake::Asked,
            Course::Rest | Course::Begin | Course::Continue => Intake::Taken,
        };
        match halt(self.halt, &Replaced { intake, ..*replaced }) {
            Verdict::Passed(()) if self.waiting => {
                // A command can come into the middle of a stop that the joystick box has ended.
                (self.waiting, self.halt, self.last_order) = (false, Halt::Clear, None);
                Ok(Course::Begin)
            }
            Verdict::Passed(()) => Ok(course),
            Verdict::Decided(decision) => {
                self.halt = decision.next;
                if let Halting::Abandon(reason) = decision.action {
                    self.fail(reason);
                }
                // The header of a restarted process says that it was restarted.
                if intake == Intake::Asked {
                    self.note(&decision.of(HALT_NUMBER));
                } else {
                    self.rows.beside(&decision.of(HALT_NUMBER));
                }
                Err(decision.action)
            }
        }
    }

    /// As [`Self::decide`], for a process that commands others: HALT is consulted before the tables, EFFECT and
    /// CONFIRM after them. `variables` are those of the command's table, as one number; `goal` is its goal, compared
    /// with the sensors, and `confirm` the number of CONFIRM.
    pub fn command<Action: Orders, Step: Copy>(
        &mut self,
        (arrival, replaced, variables): (Arrival, &Replaced, u64),
        (confirm, goal): (u8, (&Goal, Proof)),
        first: Step,
        step: &mut Step,
        tables: impl FnOnce(Step) -> Choice<Action, Step>,
    ) -> Option<Action> {
        let course = self.course(arrival);
        match self.admit(course, replaced) {
            Err(halting) => return Some(Action::of_halt(halting)),
            Ok(Course::Rest | Course::Refuse) => return None,
            Ok(Course::Begin) => *step = first,
            Ok(Course::Continue) => {}
        }
        let choice = self.effective(tables(*step), variables);
        let choice = self.confirm(confirm, *step, choice, goal);
        self.note(&choice);
        *step = choice.next;
        Some(choice.action)
    }

    /// Consult [`EFFECT`](crate::halt::EFFECT) about a row that fired: the row, or that of EFFECT.
    pub fn effective<Action: Orders, Step>(
        &mut self,
        choice: Choice<Action, Step>,
        variables: u64,
    ) -> Choice<Action, Step> {
        let this = LastOrder { table: choice.table, row: choice.row, variables };
        let order = match choice.action.is_order() {
            false => Order::None,
            true if self.last_order == Some(this) => Order::Repeated,
            true => Order::New,
        };
        match effect((), &Fired { order }) {
            Verdict::Passed(()) => {
                self.last_order = if order == Order::New { Some(this) } else { self.last_order };
                choice
            }
            Verdict::Decided(Decision { row, action, values, .. }) => {
                let action = Action::of_effect(action);
                Choice { table: EFFECT_NUMBER, row, action, next: choice.next, values }
            }
        }
    }

    /// Note what a table ACCEPT has decided whose process does more in the same tick. False if it refused the
    /// command.
    pub fn accepts<Step>(&mut self, verdict: &Verdict<Refusal, Step, ()>) -> bool {
        match *verdict {
            Verdict::Passed(()) => true,
            Verdict::Decided(Decision { row, action: Refusal::Fail(reason), values, .. }) => {
                self.rows.decide(ACCEPT_NUMBER, row, values);
                self.fail(reason);
                false
            }
        }
    }

    /// Note which row of which table fired.
    pub fn note<Action, Step>(&mut self, choice: &Choice<Action, Step>) {
        self.rows.decide(choice.table, choice.row, choice.values);
    }

    /// Is the command in the buffer to be accepted or refused, as soon as HALT allows it?
    #[must_use]
    pub fn asked(&self, arrival: Arrival) -> Asked {
        if self.waiting { Asked::Now } else { Asked::of(arrival) }
    }

    /// True in the tick in which a command was accepted: `arrival` is that of the tick, and no row of ACCEPT
    /// has refused it.
    #[must_use]
    pub fn begins(&self, arrival: Arrival) -> bool {
        self.accepted(Asked::of(arrival))
    }

    /// As [`Self::begins`], for a process that has HALT: `asked` is that of the tick.
    #[must_use]
    pub fn accepted(&self, asked: Asked) -> bool {
        asked == Asked::Now && !self.waiting && !self.is_refused()
    }

    /// True if a row of ACCEPT decided last: the command was refused.
    #[must_use]
    pub fn is_refused(&self) -> bool {
        self.rows.decided.is_some_and(|decided| decided.table == ACCEPT_NUMBER)
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

    /// Part of the goal that no sensor has confirmed, for a command that is done.
    #[must_use]
    pub const fn unconfirmed(&self) -> Unconfirmed {
        match self.outcome {
            Outcome::Done => self.unconfirmed,
            Outcome::Idle | Outcome::Executing | Outcome::Error | Outcome::Joystick => Unconfirmed::None,
        }
    }

    /// The outcome and its reason, as the process above is to see them: a process that was restarted executes until
    /// what it had commanded is at rest.
    #[must_use]
    pub const fn end(&self) -> (Outcome, Reason) {
        match (self.outcome, self.halt) {
            (Outcome::Error, Halt::Stopping) => (Outcome::Executing, Reason::None),
            (outcome, _) => (outcome, self.reason),
        }
    }

    /// The same as `status-report` (V.2.2, V.3.2).
    #[must_use]
    pub const fn report(&self) -> (StatusReport, Reason) {
        let (outcome, reason) = self.end();
        let report = match outcome {
            Outcome::Idle => StatusReport::Idle,
            Outcome::Executing => StatusReport::Executing,
            Outcome::Done => StatusReport::Done,
            Outcome::Error => StatusReport::Error,
            Outcome::Joystick => StatusReport::JoystickOn,
        };
        (report, reason)
    }

    /// The header of the outputs of this tick; `step` is the text of the command's step.
    #[must_use]
    pub fn header(&self, tick: Tick, step: &str) -> Header {
        self.rows.header(tick, step)
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
            let course = e.course(arrival);
            end(&mut e);
            (course, e.report().0, e.reason)
        };
        assert_eq!(course(0, |_| {}), (Course::Rest, StatusReport::Idle, Reason::None));
        assert_eq!(course(1, |_| {}), (Course::Begin, StatusReport::Executing, Reason::None));
        assert_eq!(course(1, Execution::finish), (Course::Continue, StatusReport::Done, Reason::None));
        assert_eq!(course(1, |_| {}), (Course::Rest, StatusReport::Done, Reason::None));
        let refuse = |e: &mut Execution| e.fail(Reason::UnknownObject);
        assert_eq!(course(2, refuse), (Course::Begin, StatusReport::Error, Reason::UnknownObject));
        assert_eq!(course(2, |_| {}), (Course::Rest, StatusReport::Error, Reason::UnknownObject));
        assert_eq!(course(3, |_| {}), (Course::Begin, StatusReport::Executing, Reason::None));
    }

    #[test]
    fn a_refusal_beside_something_else_ends_the_command() {
        let mut e = Execution::default();
        e.course(Arrival::New);
        assert!(e.accepts(&Verdict::<Refusal, (), ()>::Passed(())));
        assert_eq!((e.report().0, e.rows.decided), (StatusReport::Executing, None));
        let action = Refusal::Fail(Reason::UnknownCommand);
        let refusal = Decision { row: 2, action, next: (), values: Values::default() };
        assert!(!e.accepts(&Verdict::Decided(refusal)));
        assert_eq!(e.report(), (StatusReport::Error, Reason::UnknownCommand));
        assert_eq!(e.rows.decided, Some(Decided { table: ACCEPT_NUMBER, row: 2 }));
        assert!(!e.begins(Arrival::New));
    }

    #[test]
    fn a_restarted_process_refuses_what_stands_in_its_buffer() {
        let mut e = Execution::default();
        let arrival = e.receiver.observe(7);
        assert_eq!((e.course(arrival), e.reason), (Course::Refuse, Reason::Restarted));
        assert_eq!(e.rows.decided, Some(Decided { table: EXECUTE_NUMBER, row: 2 }));
    }
}
