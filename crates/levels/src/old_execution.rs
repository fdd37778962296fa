//! What Task, Subtask and E-move have in common: the upper of the two state tables (II.2.2.2).
//!
//! The lower table belongs to a command; this one decides whether it is consulted at all. An outcome, once reached, stays
//! until a new command number comes .
//!
//! ```text
//!            New, Good            table says Finish
//!   Idle ----------------> Executing ----------------> Done
//!     |                     ^   |  \
//!     | New, Faulty         |   |   `-- table says JoystickOn --> Joystick
//!     v                     |   | table says Fail
//!   Error <-----------------|---'
//!     |______ New, Good ____|
//! ```

use rcs_core::{
    Plain,
    handshake::{Arrival, Lower, Receiver},
    interface::{Header, Reason, Report},
    old_table,
    table::{Decision, Table},
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

/// Whether the current command can be executed at all: its names are known, its records exist.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Check {
    /// It can.
    Good,
    /// It cannot; there is a reason.
    Faulty,
}

/// What to do with the table of the current command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Course {
    /// Leave everything as it is.
    Rest,
    /// Refuse the command with the reason found.
    Refuse,
    /// Consult the table, from its first step.
    Begin,
    /// Consult the table.
    Continue,
}

old_table! {
    /// Upper state table: is the table of the current command consulted?
    pub EXECUTE: fn execute(arrival: Arrival, check: Check, outcome: Outcome) -> (Course, Outcome) {
        //    arrival     check    outcome       course     outcome
        1: ( Nothing   , _      , _         ) => Rest     , Idle      ;
        2: ( Restarted , _      , _         ) => Refuse   , Error     ;
        3: ( New       , Faulty , _         ) => Refuse   , Error     ;
        4: ( New       , Good   , _         ) => Begin    , Executing ;
        5: ( Same      , _      , Executing ) => Continue , Executing ;
        6: ( Same      , _      , Idle      ) => Rest     , Idle      ;
        7: ( Same      , _      , Done      ) => Rest     , Done      ;
        8: ( Same      , _      , Error     ) => Rest     , Error     ;
        9: ( Same      , _      , Joystick  ) => Rest     , Joystick  ;
    }
}

/// The current command of a process and how far it has come.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Execution {
    /// Echo and adoption.
    pub receiver: Receiver,
    /// How far it has come.
    pub outcome: Outcome,
    /// The reference action (V.1.1): code of the step of the command's table.
    pub step: u8,
    /// Why it failed.
    pub reason: Reason,
    /// Table that was used last, from 1; 0 for none.
    pub table: u8,
    /// Row of it.
    pub row: u8,
}

/// What the table of the current command decided; `Action` is what the rows of a process can ask for.
#[derive(Clone, Copy, Debug)]
pub struct Choice<Action> {
    /// The table.
    pub table: &'static Table,
    /// The row that fired.
    pub row: u8,
    /// What to do.
    pub action: Action,
    /// Code of the next step.
    pub step: u8,
}

impl Execution {
    /// Consult the upper table; `fault` is why the command cannot be executed, if so.
    pub fn consult(&mut self, number: u32, fault: impl FnOnce() -> Option<Reason>) -> Course {
        let arrival = self.receiver.observe(number);
        let fault = match arrival {
            Arrival::New => fault(),
            Arrival::Restarted => Some(Reason::Restarted),
            Arrival::Nothing | Arrival::Same => None,
        };
        let check = if fault.is_some() { Check::Faulty } else { Check::Good };
        let Decision { row, action, next } = execute(arrival, check, self.outcome);
        self.outcome = next;
        match action {
            Course::Refuse => {
                self.reason = fault.unwrap_or_default();
                (self.table, self.row) = (1, row);
            }
            Course::Begin => {
                self.step = 0;
                self.reason = Reason::None;
            }
            Course::Rest | Course::Continue => {}
        }
        action
    }

    /// The process was dormant in the tick before: the next command number it reads is adopted, not executed (DESIGN 16
    /// "Handshake" e).
    pub fn wake(&mut self) {
        self.receiver = Receiver::default();
    }

    /// Note which row of which table fired.
    pub fn note(&mut self, tables: &[&'static Table], table: &'static Table, row: u8, step: u8) {
        let position = tables.iter().position(|t| core::ptr::eq(*t, table));
        self.table = position.and_then(|p| u8::try_from(p).ok()).and_then(|p| p.checked_add(1)).unwrap_or(0);
        self.row = row;
        self.step = step;
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

    /// The header of the outputs of this tick.
    #[must_use]
    pub const fn header(&self, tick: Tick) -> Header {
        Header {
            stamp: tick,
            republished: false,
            table: self.table,
            row: self.row,
            step: rcs_core::name::Name16::EMPTY,
        }
    }
}
