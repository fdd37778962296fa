//! Task and the Data System (IV.4.2, IX.2): requests and answers, independent of the transport.

use rcs_core::{
    Plain,
    handshake::Lower,
    name::{Name10, Name16},
};

/// What Task asks of the Data System.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
#[text(upper)]
pub enum DataBaseVerb {
    /// Nothing yet.
    #[text = ""]
    None,
    /// End whatever transaction is open (reconfiguration command).
    Abort,
    /// Make this client known (reconfiguration command).
    Initiate,
    /// Begin to take commands (reconfiguration command).
    Startup,
    /// UPDATE EQUIP_ITEM_ACTION: where an item now is.
    Update,
}

/// Command from Task to the Data System: the fields of the DML string that Task stuffs (IX.2).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct DataBaseCommand {
    /// Command number.
    pub number: u32,
    /// What to do.
    pub command: DataBaseVerb,
    /// `ITEM-NAME`: the object.
    pub item: Name16,
    /// `ITEM#`: its serial number.
    pub serial: Name16,
    /// `STORAGE-POS`: the location where the item now is; `H_ROBOT` while the robot has it.
    pub position: Name10,
    /// `SECTOR#`: sector there, if it has one.
    pub sector: Option<i32>,
}

/// What the Data System makes of the last command: server status and summary status (IX.2), read together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum DataBaseReport {
    /// Nothing was asked yet (extension).
    Idle,
    /// The command is executing.
    Executing,
    /// It is done.
    Done,
    /// It was refused.
    Refused,
}

/// Does the Data System receive updates (IV.4.2)?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Connection {
    /// No: there was no STARTUP, or a SHUTDOWN.
    Closed,
    /// Not yet: STARTUP is executing.
    Opening,
    /// Yes.
    Open,
    /// No: STARTUP was interrupted.
    Interrupted,
}

/// Updates that Task keeps until they are accepted: one about an object that is taken, and one about its release.
pub const KEPT_UPDATES: usize = 2;

/// An item that the robot holds or is to take: the content of the update when it is released.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Carried {
    /// The object.
    pub item: Name16,
    /// Its serial number.
    pub serial: Name16,
    /// Where it was taken, or to where it was brought.
    pub location: Name10,
    /// Sector there, if it has one.
    pub sector: Option<i32>,
    /// An update follows wherever it is released, and not only in the MBD.
    pub followed: bool,
}

/// The connection to the Data System, the pending updates and the carried object. They are an output, so that a
/// restarted Task has them (docs/design/recovery.md "Data base"; extension).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct DataBaseUpdates {
    /// A STARTUP has succeeded, and no SHUTDOWN came since.
    pub connected: bool,
    /// A STARTUP has begun, and neither succeeded nor was followed by a SHUTDOWN.
    pub connecting: bool,
    /// The updates that have not been accepted, the oldest first.
    pub pending: [Option<DataBaseCommand>; KEPT_UPDATES],
    /// The object that the command in the ledger takes, until it is held; none if no update follows at its release.
    pub taking: Option<Carried>,
    /// The object that the robot held last: by a command with an update, or after a MOVE or an ACQUIRE. It stays if the
    /// part is lost, until another one of that name is taken.
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
    /// Number of the command that is answered.
    pub echo: u32,
    /// What became of it.
    pub report: DataBaseReport,
}
