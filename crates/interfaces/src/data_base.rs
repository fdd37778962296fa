//! Task and the Data System (IV.4.2, IX.2): requests and answers, independent of the transport.

use rcs_core::{
    Plain,
    handshake::Lower,
    name::{Name10, Name16},
};

/// Requests of Task to the Data System.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
#[text(upper)]
pub enum DataBaseVerb {
    /// No command yet.
    #[text = ""]
    None,
    /// End any open transaction (reconfiguration command).
    Abort,
    /// Register this client (reconfiguration command).
    Initiate,
    /// Start accepting commands (reconfiguration command).
    Startup,
    /// UPDATE EQUIP_ITEM_ACTION: the present place of an item.
    Update,
}

/// Command from Task to the Data System: the fields that Task puts into the DML string (IX.2).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct DataBaseCommand {
    /// Command number.
    pub number: u32,
    /// The verb.
    pub command: DataBaseVerb,
    /// `ITEM-NAME`.
    pub item: Name16,
    /// `ITEM#`: serial number of the item.
    pub serial: Name16,
    /// `STORAGE-POS`: present location of the item; `H_ROBOT` while the robot holds it.
    pub position: Name10,
    /// `SECTOR#`: sector of the location, if it has one.
    pub sector: Option<i32>,
}

/// Answer of the Data System to the last command: its server status and summary status combined (IX.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum DataBaseReport {
    /// No command yet (extension).
    Idle,
    /// The command is executing.
    Executing,
    /// The command is complete.
    Done,
    /// The command was refused.
    Refused,
}

/// State of the connection on which the Data System receives updates (IV.4.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Connection {
    /// Closed: no STARTUP since the start, or since the last SHUTDOWN.
    Closed,
    /// STARTUP is executing.
    Opening,
    /// Updates can be sent.
    Open,
    /// Closed: STARTUP was interrupted.
    Interrupted,
}

/// Updates that Task keeps until they are accepted: the acquisition of an object and its release.
pub const KEPT_UPDATES: usize = 2;

/// An item that the robot holds or is about to take: the content of the update at its release.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Carried {
    /// The object.
    pub item: Name16,
    /// Its serial number.
    pub serial: Name16,
    /// Its source location, or its destination.
    pub location: Name10,
    /// Sector of the location, if it has one.
    pub sector: Option<i32>,
    /// Its release is reported at every location, not only in the MBD.
    pub followed: bool,
}

/// The connection to the Data System, the pending updates and the carried object. As an output it survives a restart
/// of Task (docs/design/recovery.md "Database"; extension).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct DataBaseUpdates {
    /// STARTUP has succeeded, without a later SHUTDOWN.
    pub connected: bool,
    /// STARTUP has begun and has not succeeded, without a later SHUTDOWN.
    pub connecting: bool,
    /// Pending updates, the oldest first.
    pub pending: [Option<DataBaseCommand>; KEPT_UPDATES],
    /// The object that the command in the ledger takes, until it is held. None if its release needs no update.
    pub taking: Option<Carried>,
    /// The object held last, taken by a command with an update or by MOVE or ACQUIRE. It is kept after a loss, until
    /// an object of this name is taken again.
    pub carried: Option<Carried>,
}

impl DataBaseReport {
    /// The report as a state variable of Task.
    #[must_use]
    pub const fn lower(self) -> Lower {
        match self {
            Self::Idle | Self::Done => Lower::Done,
            Self::Executing => Lower::Executing,
            Self::Refused => Lower::Error,
        }
    }
}

/// Status from the Data System to Task.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct DataBaseStatus {
    /// Number of the answered command.
    pub echo: u32,
    /// State of that command.
    pub report: DataBaseReport,
}
