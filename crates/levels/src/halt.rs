//! A new command number replaces every command in progress (docs/design/recovery.md "Replaced").
//!
//! ```text
//!              new command, something is under way below: Stop
//!   Clear -----------------------------------------------------> Stopping
//!     ^                                                              |
//!     |      what is below has come to rest, or a command is         |
//!     |      accepted while the operator has the robot               |
//!     '--------------------------------------------------------------'
//! ```
//!
//! [`HALT`] is consulted after EXECUTE and before ACCEPT, so that a command that is refused stops what was
//! under way too, and its end is reported only when nothing moves any more. If nothing is under way, a
//! command is accepted in the tick in which it comes.

use interfaces::{Header, Reason};
use rcs_core::{
    Actions, Plain, Variables, decision_table,
    handshake::Lower,
    table::{Choice, Decision, Verdict},
    tick::Tick,
};

use crate::execution::{Course, Ending, Execution, LastOrder};

/// The command of a process, for [`HALT`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Intake {
    /// It has been accepted or refused, or there is none.
    Taken,
    /// It is new and neither accepted nor refused yet.
    Asked,
    /// It was found at the start of the process and is not executed.
    Adopted,
}

/// Does the new command stop what is below by itself?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Kind {
    /// No.
    Other,
    /// Yes: its own table sends a pause down and waits for it.
    Pause,
}

/// The joystick box.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum BoxState {
    /// It is off.
    Off,
    /// It is on: the operator has the robot, and nothing is sent.
    On,
}

/// The process that commands this one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Above {
    /// It wrote its buffers in the last tick, or is not watched.
    Live,
    /// It did not write them: nothing commands this process any more.
    Lost,
}

impl Above {
    /// By the header of its buffers, read in this tick.
    #[must_use]
    pub fn of(header: &Header, tick: Tick) -> Self {
        if header.stamp == tick.previous() { Self::Live } else { Self::Lost }
    }
}

/// What the processes below are doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Below {
    /// Nothing: what they were told last has ended, or they do not answer.
    AtRest,
    /// They were told to pause and are coming to rest.
    Pausing,
    /// Something else.
    UnderWay,
}

impl Below {
    /// By the status of one process below, and whether a pause was the last that it was told.
    #[must_use]
    pub const fn of(status: Lower, pausing: bool) -> Self {
        match (status, pausing) {
            (Lower::Pending | Lower::Executing, true) => Self::Pausing,
            (Lower::Pending | Lower::Executing, false) => Self::UnderWay,
            (Lower::Done | Lower::Error | Lower::Joystick | Lower::Lost, _) => Self::AtRest,
        }
    }

    #[must_use]
    pub const fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::UnderWay, _) | (_, Self::UnderWay) => Self::UnderWay,
            (Self::Pausing, _) | (_, Self::Pausing) => Self::Pausing,
            (Self::AtRest, Self::AtRest) => Self::AtRest,
        }
    }
}

/// What a new command may replace, for [`HALT`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct Replaced {
    /// The command.
    pub intake: Intake,
    /// Does it stop what is below by itself?
    pub kind: Kind,
    /// The process above.
    pub above: Above,
    /// The joystick box.
    pub joystick: BoxState,
    /// What the processes below are doing.
    pub below: Below,
}

/// What [`HALT`] can ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Halting {
    /// A pause to the processes below.
    Stop,
    /// Nothing new: they are coming to rest.
    Wait,
    /// A pause to the processes below, and the command fails.
    Abandon(Reason),
}

decision_table! {
    /// HALT: a new command replaces what is under way. It is accepted or refused when the processes below
    /// have come to rest. What a process had under way before it was restarted is stopped too, and so is what
    /// it has under way when the process above is lost.
    pub HALT: fn halt(enum Halt, Replaced) -> Halting or () {
        any {
            1:  joystick: On                                                        => consult;
            2:  joystick: Off, intake: Taken, above: Live                           => consult;
            3:  joystick: Off, intake: Taken, above: Lost, below: AtRest | Pausing  => consult;
            4:  joystick: Off, intake: Taken, above: Lost, below: UnderWay          => Abandon(NeighbourLost);
        }
        /// Nothing was told to stop for the sake of a new command.
        Clear {
            5:  joystick: Off, intake: Asked, kind: Pause                           => consult;
            6:  joystick: Off, intake: Asked | Adopted, below: AtRest               => consult;
            7:  joystick: Off, intake: Adopted, below: Pausing                      => Wait  -> Stopping;
            8:  joystick: Off, intake: Asked, kind: Other, below: Pausing           => Wait  -> Stopping;
            9:  joystick: Off, intake: Asked | Adopted, below: UnderWay             => Stop  -> Stopping;
        }
        /// What is below is coming to rest.
        Stopping {
            10: joystick: Off, intake: Asked | Adopted, below: Pausing | UnderWay   => Wait;
            11: joystick: Off, intake: Asked | Adopted, below: AtRest               => Wait  -> Clear;
        }
    }
}

/// An order to a process below, for [`EFFECT`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Order {
    /// The row that fired orders nothing.
    None,
    /// It orders something, and did not order it last with the same state variables.
    New,
    /// It was the last one that ordered something, and the state variables are those of that time.
    Repeated,
}

/// What the command has achieved since its last order, besides the state variables: points of a route, for example.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Advance {
    /// Nothing.
    None,
    /// It has advanced.
    Made,
}

/// The row that fired, for [`EFFECT`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct Fired {
    /// What it orders.
    pub order: Order,
    /// The advance of the command since its last order.
    pub advance: Advance,
}

/// What [`EFFECT`] can ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Futile {
    /// Report an error.
    Fail(Reason),
}

decision_table! {
    /// EFFECT: an order that has changed no state variable of its table, nor advanced the command, is not given again by
    /// the same row. The command fails.
    pub EFFECT: fn effect(Fired) -> Futile or () {
        1: order: None | New               => consult;
        2: order: Repeated, advance: Made  => consult;
        3: order: Repeated, advance: None  => Fail(NoEffect);
    }
}

/// The actions of a process that commands others, for [`HALT`].
pub trait Stopping: Ending {
    /// A pause to the processes below.
    const STOP: Self;

    #[must_use]
    fn of_halt(halting: Halting) -> Self {
        match halting {
            Halting::Stop | Halting::Abandon(_) => Self::STOP,
            Halting::Wait => Self::WAIT,
        }
    }
}

/// The actions of a process that commands others, for [`EFFECT`].
pub trait Commanding: Ending {
    /// The action orders something of a process below that changes a state variable when it is carried out.
    fn is_order(&self) -> bool;
}

impl Execution {
    /// Consult [`HALT`], the table with this number, about what EXECUTE has said. What is to be done with the
    /// tables: `Begin` in the tick in which a command is accepted or refused.
    ///
    /// # Errors
    /// What HALT asks for: no other table is to be consulted.
    pub fn halt(&mut self, number: u8, course: Course, replaced: &Replaced) -> Result<Course, Halting> {
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
                    self.rows.decide(&decision.of(number));
                } else {
                    self.rows.beside(&decision.of(number));
                }
                Err(decision.action)
            }
        }
    }

    /// Consult [`EFFECT`], the table with this number, about a row that fired: the row, or that of EFFECT.
    pub fn effect<Action: Commanding, Step>(
        &mut self,
        number: u8,
        choice: Choice<Action, Step>,
        advance: Advance,
    ) -> Choice<Action, Step> {
        let this = LastOrder { table: choice.table, row: choice.row, variables: choice.values.variables };
        let order = match choice.action.is_order() {
            false => Order::None,
            true if self.last_order == Some(this) => Order::Repeated,
            true => Order::New,
        };
        match effect((), &Fired { order, advance }) {
            Verdict::Passed(()) => {
                self.last_order = if order == Order::New { Some(this) } else { self.last_order };
                choice
            }
            Verdict::Decided(Decision { row, action: Futile::Fail(reason), values, .. }) => {
                Choice { table: number, row, action: Action::fail(reason), next: choice.next, values }
            }
        }
    }
}
