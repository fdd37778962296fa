//! Decision tables (II.2.2.2): step and state variables select one row, which names one action and the next step.
//!
//! [`decision_table!`](crate::decision_table!) turns a table into one exhaustive `match`. The compiler reports missing
//! cases and dead rows in the row itself. The same source gives the text for logs, `rcs-run tables` and documentation.
//!
//! The first matching row decides. A row names only the variables that it tests, or `otherwise`, and the next step
//! only where it changes. A group of rows belongs to one step, to several, or to `any`. A group with a doc comment
//! declares its step; a command begins in the first declared one.
//!
//! ```
//! # mod cell {
//! use rcs_core::{Actions, Plain, Variables, decision_table};
//!
//! /// The door of the cell.
//! #[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
//! pub enum Door {
//!     /// The doorway is free.
//!     Open,
//!     /// Both switches detect the door.
//!     Shut,
//!     /// The door is between its switches.
//!     Stuck,
//! }
//!
//! /// The state variables.
//! #[derive(Clone, Copy, Debug, Variables)]
//! pub struct Situation {
//!     /// The door.
//!     pub door: Door,
//! }
//!
//! /// Why a command failed.
//! #[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
//! pub enum Reason {
//!     /// The door did not shut.
//!     DoorStuck,
//! }
//!
//! /// Actions of the rows.
//! #[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
//! pub enum Action {
//!     /// No new output.
//!     Wait,
//!     /// Drive the door.
//!     Close,
//!     /// Report done.
//!     Finish,
//!     /// Report an error.
//!     Fail(Reason),
//! }
//!
//! decision_table! {
//!     /// CLOSE-DOOR: for the example.
//!     pub CLOSE_DOOR: fn close_door(enum CloseDoorStep, Situation) -> Action {
//!         any {
//!             1: door: Shut          => Finish;
//!         }
//!         /// The command has not started.
//!         Start {
//!             2: door: Open | Stuck  => Close  -> Closing;
//!         }
//!         /// The door is driven.
//!         Closing {
//!             3: door: Open          => Wait;
//!             4: door: Stuck         => Fail(DoorStuck);
//!         }
//!     }
//! }
//!
//! # }
//! # use cell::*;
//! let decision = close_door(CloseDoorStep::Start, &Situation { door: Door::Open });
//! assert_eq!((decision.row, decision.action, decision.next), (2, Action::Close, CloseDoorStep::Closing));
//! let row = CLOSE_DOOR.row(4).unwrap();
//! assert_eq!(row.to_string(), "Closing, door Stuck => Fail(DoorStuck)");
//! ```
//!
//! # Tables above
//!
//! Common rows of several tables form a table that is consulted first. Its head says `-> Action or Type`. A row with
//! `consult(Value)` passes a value of that type to the next table. The type is narrower than the tested variable, so
//! the next table needs no rows for decided cases. `-> Action or ()` and `consult` pass no value.
//!
//! # State variables of a table
//!
//! A process senses its state variables with methods of one type, in an `impl` block with `#[state_variables]`. A
//! table whose head says `struct of super::Senses` declares a struct with the variables that its rows name: GRASP-OBJ
//! declares `GraspObjSituation`. `commands!` with `enum Situation of Senses` makes an enum with a variant per entry,
//! and senses only what the tables of the command test.
//!
//! ```
//! # mod cell {
//! use rcs_core::{Actions, Plain, decision_table, state_variables};
//!
//! /// A switch.
//! #[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
//! pub enum Switch {
//!     /// It is off.
//!     Off,
//!     /// It is on.
//!     On,
//! }
//!
//! /// Actions of the rows.
//! #[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
//! pub enum Action {
//!     /// No new output.
//!     Wait,
//!     /// Report done.
//!     Finish,
//! }
//!
//! /// The inputs of a tick.
//! pub struct Senses<'a> {
//!     /// Bits of the switches.
//!     pub inputs: &'a u8,
//! }
//!
//! #[state_variables]
//! impl Senses<'_> {
//!     /// The last order, which the table above passes on.
//!     #[passed]
//!     pub const fn order(&self) -> Switch {
//!         Switch::Off
//!     }
//!
//!     /// The switch of the door.
//!     pub const fn door(&self) -> Switch {
//!         if *self.inputs & 1 == 0 { Switch::Off } else { Switch::On }
//!     }
//!
//!     /// The switch of the lamp. No row names it.
//!     pub fn lamp(&self) -> Switch {
//!         unreachable!("it is not sensed")
//!     }
//! }
//!
//! decision_table! {
//!     /// AWAIT-DOOR: for the example.
//!     pub AWAIT_DOOR: fn await_door(struct of Senses) -> Action {
//!         1: order: On  => Wait;
//!         2: door: Off  => Wait;
//!         3: door: On   => Finish;
//!     }
//! }
//! # }
//! # use cell::*;
//! let mut situation = AwaitDoorSituation::sense(&Senses { inputs: &1 });
//! assert_eq!(situation, AwaitDoorSituation { order: Switch::Off, door: Switch::On });
//! assert_eq!(await_door((), &situation).row, 3);
//! situation.pass(Switch::On);
//! assert_eq!(await_door((), &situation).row, 1);
//! assert_eq!(AWAIT_DOOR.variables[1].doc, "The switch of the door.");
//! ```
//!
//! # Looking back
//!
//! From the [`Values`] of a decision the table reports its variables, and the row that each other value would have
//! fired: [`Table::near_misses`].
//!
//! # Commands
//!
//! [`commands!`](crate::commands!) lists the tables of a process. It generates the enum of all steps, the list of all
//! tables, the numbers of tables that no command selects, and the function that consults the table of a command. An
//! entry is `Verb: GOAL => table;`; the goal is required. `a then b::c` consults two tables in turn.
//!
//! `others` lists the tables that no command selects, in the order of their numbers. `before` and `after` give the
//! tables before that of the command, and those about the row that fired. They generate the function `decide` and its
//! documentation.
//!
//! ```text
//! others: EXECUTE, accept::ACCEPT, HALT, EFFECT, ordered::ORDERED, CONFIRM;
//! before: EXECUTE, HALT, ACCEPT(request), ORDERED(subordinates -> situation.work);
//! after: EFFECT, CONFIRM;
//! ```
//!
//! | in `before` | meaning |
//! |---|---|
//! | `EXECUTE`, `HALT` | the tables of all processes, consulted by `Execution` |
//! | `JOYSTICK by joystick` | consulted by this method of the process's state, which can withhold the command |
//! | `ACCEPT(request)` | a row decides with the variables `seen.request`, or the next table is consulted |
//! | `LINK(situation in link)` | the same, with the step `state.link` instead of that of the command |
//! | `ORDERED(subordinates -> situation.work)` | the passed value becomes `seen.situation.work` |
//! | `ORDERED(subordinates -> situation)` | the same for each table with a `struct of` state variables |
//!
//! `after` may say `EFFECT(advance)`: `seen.advance` is true if the command has advanced since its last order.

mod values;

use core::fmt;

use crate::plain::EnumSchema;

pub use values::{Fired, NearMiss, Values};

/// A decision table as text, for logs, `rcs-run tables` and failure reports.
#[derive(Debug)]
pub struct Table {
    /// The command that it serves, in the manual's spelling: `GET-OBJECT`.
    pub name: &'static str,
    /// Lines of the doc comment.
    pub doc: &'static [&'static str],
    /// The state variables that a row may test.
    pub variables: &'static [Variable],
    /// The actions that a row may name.
    pub actions: &'static [ActionText],
    /// The steps, if the table has any.
    pub steps: Option<&'static EnumSchema>,
    /// The rows in order; row `n` is at `n - 1`.
    pub rows: &'static [Row],
    /// Source file.
    pub file: &'static str,
    /// Line of the table in the file.
    pub line: u32,
}

/// A state variable.
#[derive(Debug, PartialEq)]
pub struct Variable {
    /// Its name.
    pub name: &'static str,
    /// Meaning: the doc comment of the field.
    pub doc: &'static str,
    /// Its values.
    pub values: &'static EnumSchema,
}

/// An action.
#[derive(Debug, PartialEq)]
pub struct ActionText {
    /// Its name in the rows.
    pub name: &'static str,
    /// Effect: the doc comment.
    pub doc: &'static str,
    /// Values of the argument.
    pub argument: Option<&'static EnumSchema>,
}

/// The state variables of a table.
pub trait Variables {
    /// All values as digits of one number, the last variable lowest. Equal numbers mean equal situations.
    fn code(&self) -> u64;
}

/// A row as text.
#[derive(Debug, PartialEq, Eq)]
pub struct Row {
    /// Number in the source, from 1.
    pub number: u8,
    /// The steps in which it applies; empty for any.
    pub steps: &'static [&'static str],
    /// The conditions; all of them must hold.
    pub when: &'static [Condition],
    /// The action; `consult` if the next table decides.
    pub action: &'static str,
    /// The argument of the action.
    pub argument: Option<&'static str>,
    /// The next step, if it changes.
    pub next: Option<&'static str>,
}

/// The condition of a row for a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Condition {
    /// The variable.
    pub variable: &'static str,
    /// The matching values.
    pub values: &'static [&'static str],
}

/// The decision of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Decision<Action, Step> {
    /// Number of the row that fired.
    pub row: u8,
    /// The action: it sets outputs and computes nothing.
    pub action: Action,
    /// The next step, which is the new reference action.
    pub next: Step,
    /// The values with which the table was consulted.
    pub values: Values,
}

/// The decision of a table above others, or the value that it passes to the next table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict<Action, Step, Passed> {
    /// A row has decided.
    Decided(Decision<Action, Step>),
    /// The next table decides.
    Passed(Passed),
}

/// The decision of a process's tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Choice<Action, Step> {
    /// Number of the table in its process, from 1.
    pub table: u8,
    /// Number of the row that fired.
    pub row: u8,
    /// The action.
    pub action: Action,
    /// The next step.
    pub next: Step,
    /// The values with which the table was consulted.
    pub values: Values,
}

impl<Action, Step> Decision<Action, Step> {
    /// The same decision with the number of its table.
    pub fn of(self, table: u8) -> Choice<Action, Step> {
        Choice { table, row: self.row, action: self.action, next: self.next, values: self.values }
    }

    /// The decision of a table with its own steps, with the step of the command instead.
    pub fn in_step<Other>(self, step: Other) -> Decision<Action, Other> {
        Decision { row: self.row, action: self.action, next: step, values: self.values }
    }
}

impl Table {
    /// The row of a number.
    #[must_use]
    pub fn row(&self, number: u8) -> Option<&'static Row> {
        self.rows.iter().find(|row| row.number == number)
    }

    /// The variables that at least one row tests.
    pub fn asked(&self) -> impl Iterator<Item = &'static Variable> {
        let asks = |name: &str| {
            self.rows.iter().flat_map(|row| row.when).any(|condition| condition.variable == name)
        };
        self.variables.iter().filter(move |variable| asks(variable.name))
    }
}

impl Row {
    /// The step and the conditions as text: `Closing, door Stuck`, or `otherwise`.
    pub fn conditions(&self) -> impl fmt::Display {
        fmt::from_fn(move |f| conditions(f, self.steps, self.when.iter().copied()))
    }

    /// The action with its argument: `Fail(DoorStuck)`.
    pub fn call(&self) -> impl fmt::Display {
        fmt::from_fn(move |f| match self.argument {
            Some(argument) => write!(f, "{}({argument})", self.action),
            None => f.write_str(self.action),
        })
    }

    fn effect(&self) -> impl fmt::Display {
        fmt::from_fn(move |f| match self.next {
            Some(next) => write!(f, "{} -> {next}", self.call()),
            None => write!(f, "{}", self.call()),
        })
    }
}

fn conditions(
    f: &mut fmt::Formatter<'_>,
    steps: &[&str],
    when: impl Iterator<Item = Condition>,
) -> fmt::Result {
    join(f, steps, " or ")?;
    let mut is_first = steps.is_empty();
    for condition in when {
        f.write_str(if is_first { "" } else { ", " })?;
        write!(f, "{condition}")?;
        is_first = false;
    }
    if is_first { f.write_str("otherwise") } else { Ok(()) }
}

fn join(f: &mut fmt::Formatter<'_>, names: &[&str], word: &str) -> fmt::Result {
    for (position, name) in names.iter().enumerate() {
        if position > 0 {
            f.write_str(word)?;
        }
        f.write_str(name)?;
    }
    Ok(())
}

impl fmt::Display for Condition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ", self.variable)?;
        join(f, self.values, " or ")
    }
}

/// The row as text: `Closing, door Stuck => Fail(DoorStuck)`.
impl fmt::Display for Row {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} => {}", self.conditions(), self.effect())
    }
}
