//! A new command number replaces every command in progress (docs/design/recovery.md "Replaced").
//!
//! ```text
//!              new command, something is under way below: Stop
//!   Clear -----------------------------------------------------> Stopping
//!     ^                                                              |
//!     |      the processes below are at rest, or a command is        |
//!     |      accepted while the operator has the robot               |
//!     '--------------------------------------------------------------'
//! ```
//!
//! [`HALT`] is consulted after EXECUTE and before ACCEPT, so that a refused command also stops the previous one,
//! and the refusal is reported only at rest. Without orders in progress, a command is accepted in the tick in which
//! it arrives.

use interfaces::{Header, Reason};
use rcs_core::{
    Actions, Plain, Variables, decision_table,
    handshake::Lower,
    table::{Choice, Decision, Verdict},
    tick::Tick,
};

use crate::execution::{Course, Ending, Execution, LastOrder};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Intake {
    /// The command has been accepted or refused, or the buffer has none.
    Taken,
    /// The command is new and neither accepted nor refused yet.
    Asked,
    /// The command was found at the start of the process and is not executed.
    Adopted,
}

/// Whether the new command itself stops the processes below.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Kind {
    /// The command does not stop the processes below.
    Other,
    /// The table of the command sends a pause down and waits for it.
    Pause,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum BoxState {
    /// The joystick box is off.
    Off,
    /// The joystick box is on: the operator controls the robot, and no command is sent.
    On,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Above {
    /// The process above wrote its buffers in the last tick, or is not watched.
    Live,
    /// The process above did not write its buffers: this process has no commander.
    Lost,
}

impl Above {
    #[must_use]
    pub fn of(header: &Header, tick: Tick) -> Self {
        if header.stamp == tick.previous() { Self::Live } else { Self::Lost }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Below {
    /// The last commands of the processes below have ended, or they do not answer.
    AtRest,
    /// The processes below were commanded to pause and are coming to rest.
    Pausing,
    /// The processes below execute another command.
    UnderWay,
}

impl Below {
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

#[derive(Clone, Copy, Debug, Variables)]
pub struct Replaced {
    /// The state of the command.
    pub intake: Intake,
    /// Whether the command itself stops the processes below.
    pub kind: Kind,
    /// The process that commands this one.
    pub above: Above,
    /// The joystick box.
    pub joystick: BoxState,
    /// The state of the processes below.
    pub below: Below,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Halting {
    /// A pause to the processes below.
    Stop,
    /// Wait: the processes below are coming to rest.
    Wait,
    /// A pause to the processes below, and the command fails.
    Abandon(Reason),
}

decision_table! {
    /// HALT: a new command replaces the previous one. It is accepted or refused when the processes below are at
    /// rest. Orders from before a restart of the process are stopped, too, and so are its orders when the process
    /// above is lost.
    pub HALT: fn halt(enum Halt, Replaced) -> Halting or () {
        any {
            1:  joystick: On                                                        => consult;
            2:  joystick: Off, intake: Taken, above: Live                           => consult;
            3:  joystick: Off, intake: Taken, above: Lost, below: AtRest | Pausing  => consult;
            4:  joystick: Off, intake: Taken, above: Lost, below: UnderWay          => Abandon(NeighbourLost);
        }
        /// No stop for a new command is in progress.
        Clear {
            5:  joystick: Off, intake: Asked, kind: Pause                           => consult;
            6:  joystick: Off, intake: Asked | Adopted, below: AtRest               => consult;
            7:  joystick: Off, intake: Adopted, below: Pausing                      => Wait  -> Stopping;
            8:  joystick: Off, intake: Asked, kind: Other, below: Pausing           => Wait  -> Stopping;
            9:  joystick: Off, intake: Asked | Adopted, below: UnderWay             => Stop  -> Stopping;
        }
        /// The processes below are coming to rest.
        Stopping {
            10: joystick: Off, intake: Asked | Adopted, below: Pausing | UnderWay   => Wait;
            11: joystick: Off, intake: Asked | Adopted, below: AtRest               => Wait  -> Clear;
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Order {
    /// The row that fired gives no order.
    None,
    /// The row gives an order, and is not the last row that gave one with the same state variables.
    New,
    /// The last row that gave an order fires again, with the same state variables.
    Repeated,
}

/// Progress of the command since its last order, apart from the state variables: points of a route, for example.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Advance {
    /// The command has not advanced since its last order.
    None,
    /// The command has advanced since its last order.
    Made,
}

#[derive(Clone, Copy, Debug, Variables)]
pub struct Fired {
    /// The order that the row gives.
    pub order: Order,
    /// Progress of the command since its last order.
    pub advance: Advance,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Effecting {
    /// Report an error.
    Fail(Reason),
}

decision_table! {
    /// EFFECT: the same row does not repeat an order that has changed no state variable of its table and has not
    /// advanced the command. The command fails.
    pub EFFECT: fn effect(Fired) -> Effecting or () {
        1: order: None | New               => consult;
        2: order: Repeated, advance: Made  => consult;
        3: order: Repeated, advance: None  => Fail(NoEffect);
    }
}

pub trait Stopping: Ending {
    const STOP: Self;

    #[must_use]
    fn of_halt(halting: Halting) -> Self {
        match halting {
            Halting::Stop | Halting::Abandon(_) => Self::STOP,
            Halting::Wait => Self::WAIT,
        }
    }
}

pub trait Commanding: Ending {
    /// True if the action gives a process below an order that changes a state variable when it is carried out.
    fn is_order(&self) -> bool;
}

impl Execution {
    /// Consult [`HALT`], the table with this number, after EXECUTE. Returns `Begin` in the tick in which a command is
    /// accepted or refused. The error is the action of HALT, if no other table is to be consulted.
    pub fn halt(&mut self, number: u8, course: Course, replaced: &Replaced) -> Result<Course, Halting> {
        self.waiting |= course == Course::Begin;
        let intake = match course {
            Course::Refuse => Intake::Adopted,
            _ if self.waiting => Intake::Asked,
            Course::Rest | Course::Begin | Course::Continue => Intake::Taken,
        };
        match halt(self.halt, &Replaced { intake, ..*replaced }) {
            Verdict::Passed(()) if self.waiting => {
                // A command may arrive during a stop that the joystick box has ended.
                (self.waiting, self.halt, self.last_order) = (false, Halt::Clear, None);
                Ok(Course::Begin)
            }
            Verdict::Passed(()) => Ok(course),
            Verdict::Decided(decision) => {
                self.halt = decision.next;
                if let Halting::Abandon(reason) = decision.action {
                    self.fail(reason);
                }
                // The header of a restarted process shows the restart.
                if intake == Intake::Asked {
                    self.rows.decide(&decision.of(number));
                } else {
                    self.rows.beside(&decision.of(number));
                }
                Err(decision.action)
            }
        }
    }

    /// Consult [`EFFECT`], the table with this number, about a row that fired. Returns that row or the row of
    /// EFFECT.
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
            Verdict::Decided(Decision { row, action: Effecting::Fail(reason), values, .. }) => {
                Choice { table: number, row, action: Action::fail(reason), next: choice.next, values }
            }
        }
    }
}
