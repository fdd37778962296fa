//! Decision tables of Quick Change: what a new command needs, and one file per command.

pub mod accept;
pub mod qc_lock;
pub mod qc_pause;
pub mod qc_unlock;

pub use crate::variables::Clock;
use interfaces::{
    Reason,
    device::GroupHealth,
    quick_change::{QuickChangeReport, QuickChangeVerb, RingPosition},
};
use rcs_core::{Actions, Plain, Variables, commands, handshake::Arrival};

use super::goals;
use crate::execution::{Asked, EXECUTE};

/// Step of all commands. It outlasts the command, so that a failure is reported until the next one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// The ring is to turn, or no command has arrived yet.
    Start,
    /// The command has ended: the sensors are watched.
    Watch,
    /// The ring did not arrive in time.
    Stuck,
    /// The sensors failed while the ring turned.
    Faulty,
}

/// The id pins of the mated gripper.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Id {
    /// The id of a gripper, or 0.
    Legal,
    /// An id that no gripper has.
    Illegal,
}

#[derive(Clone, Copy, Debug, Variables)]
pub struct Request {
    /// Whether the command is new.
    pub asked: Asked,
    /// The command.
    pub verb: QuickChangeVerb,
}

/// The state variables of a tick, for the tables of the commands.
#[derive(Clone, Copy, Debug, Variables)]
pub struct Situation {
    /// The position of the ring.
    pub ring: RingPosition,
    /// Whether the id is legal.
    pub id: Id,
    /// Time of the command.
    pub clock: Clock,
    /// The connection with the quick change.
    pub connection: GroupHealth,
}

#[derive(Clone, Copy, Debug)]
pub struct StateVariables {
    pub arrival: Arrival,
    pub request: Request,
    pub situation: Situation,
}

/// Why the ring fails a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Failure {
    /// The ring did not arrive in time: `qc-stuck`.
    Stuck,
    /// The ring sensors or the id pins failed: `qc-sens-malf`.
    SensorMalfunction,
    /// The device does not answer.
    Silent,
    /// The device keeps its outputs safe until an operator releases them.
    Tripped,
}

impl Failure {
    /// `status-report`.
    #[must_use]
    pub const fn report(self) -> QuickChangeReport {
        match self {
            Self::Stuck => QuickChangeReport::Stuck,
            Self::SensorMalfunction | Self::Silent | Self::Tripped => QuickChangeReport::SensorMalfunction,
        }
    }

    /// `status-para-out`.
    #[must_use]
    pub const fn reason(self) -> Reason {
        match self {
            Self::Stuck => Reason::QuickChangeStuck,
            Self::SensorMalfunction => Reason::QuickChangeFault,
            Self::Silent => Reason::DeviceSilent,
            Self::Tripped => Reason::DeviceTripped,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Action {
    /// Leave the ring as it is until a reading counts.
    Wait,
    /// Leave the ring as it is and report the sensor readings; a current command is done.
    Report(QuickChangeReport),
    /// Enable the port and turn the ring towards locked.
    Lock,
    /// Enable the port and turn the ring towards unlocked.
    Unlock,
    /// Disable the port; report an error.
    Fail(Failure),
}

commands! {
    /// Consult the table of a command, or QC-PAUSE once the command has ended.
    pub fn of_command(QuickChangeVerb, Step, Situation) -> Action {
        others: EXECUTE, accept::ACCEPT;
        Lock: goals::LOCKED         => qc_lock::qc_lock then qc_pause::qc_pause;
        Unlock: goals::UNLOCKED     => qc_unlock::qc_unlock then qc_pause::qc_pause;
        None | Pause: goals::REST   => qc_pause::qc_pause;
    }
}
