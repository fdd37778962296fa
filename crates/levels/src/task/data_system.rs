//! Task and the Data System (IV.4.2, IX.2): what is asked, asked again, and kept until it is taken.
//!
//! While no Data System is connected nothing is told and nothing waited for, as with DB-DONE (Figure IV.1).
//! Once connected, the move of a command from or to the MBD is told when it has been made. An update that is
//! not taken is kept: before the next object is moved, or at the end of the next STARTUP, it is told again,
//! so that the data base is never more than one move behind.

use rcs_core::{
    Plain,
    handshake::Commander,
    interface::{
        DataBaseCommand, DataBaseStatus, TaskOutputs,
        data_base::{DataBaseReport, DataBaseVerb},
    },
    name::Name10,
    tick::Tick,
};

use super::{
    plan::{Plan, TaskVerb},
    tables::{DataBase, Update},
};

/// Ticks in which the Data System is expected to finish a command: 10 s, on a factory network.
pub const ANSWER_LIMIT: u64 = 250;
/// How often a command is written before the Data System counts as silent.
pub const MAX_TRIES: u8 = 3;
/// `STORAGE-POS` of what the robot holds, which is also the name of the client (IX.2).
pub const IN_HAND: &str = "H_ROBOT";

/// What Task knows of the Data System.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct DataSystem {
    /// Numbers of the commands to it.
    pub commander: Commander,
    /// The command that was written last.
    pub request: DataBaseCommand,
    /// How often it was written.
    pub tries: u8,
    /// A STARTUP has succeeded, and no SHUTDOWN came since.
    pub connected: bool,
    /// The last update, until it is taken.
    pub owed: Option<DataBaseCommand>,
}

impl DataSystem {
    /// Once a tick, before anything else: an update that is taken is owed no longer.
    pub fn observe(&mut self, status: &DataBaseStatus, tick: Tick) {
        self.commander.start(status.echo);
        if self.request.command == DataBaseVerb::Update && self.status(status, tick) == DataBase::Done {
            self.owed = None;
        }
    }

    /// What the Data System makes of the last command.
    #[must_use]
    pub fn status(&self, status: &DataBaseStatus, tick: Tick) -> DataBase {
        let answered = self.commander.started && status.echo == self.commander.number;
        match status.report {
            DataBaseReport::Done if answered => DataBase::Done,
            DataBaseReport::Refused if answered => DataBase::Refused,
            _ if tick.since(self.commander.sent) <= ANSWER_LIMIT => DataBase::Executing,
            _ if self.tries < MAX_TRIES => DataBase::Overdue,
            _ => DataBase::Silent,
        }
    }

    /// The pending update.
    #[must_use]
    pub fn update(&self, plan: &Plan) -> Update {
        let connecting = plan.verb == TaskVerb::Startup;
        if self.owed.is_some() && (self.connected || connecting) {
            Update::Owed
        } else if self.connected && plan.update_due {
            Update::Due
        } else {
            Update::None
        }
    }

    /// Write a command for the first time.
    fn ask(&mut self, request: DataBaseCommand, tick: Tick, outputs: &mut TaskOutputs) {
        self.tries = 0;
        self.request = request;
        self.ask_again(tick, outputs);
    }

    /// Write the last command again, with a new number.
    pub fn ask_again(&mut self, tick: Tick, outputs: &mut TaskOutputs) {
        self.tries = self.tries.saturating_add(1);
        self.request.number = self.commander.send(tick);
        outputs.data_base = self.request;
    }

    /// Write a reconfiguration command: one without an item.
    pub fn reconfigure(&mut self, command: DataBaseVerb, tick: Tick, outputs: &mut TaskOutputs) {
        self.connected = false;
        self.ask(DataBaseCommand { command, ..DataBaseCommand::default() }, tick, outputs);
    }

    /// REPORT-ITEM (IX.2): write where the object of a command now is, and keep it until it is taken.
    pub fn tell(&mut self, plan: &Plan, in_hand: bool, tick: Tick, outputs: &mut TaskOutputs) {
        let (position, sector) = match &plan.destination.location {
            Some(location) if !in_hand => (location.name, location.sector),
            _ => (Name10::clipped(IN_HAND), 0),
        };
        self.owed = Some(DataBaseCommand {
            number: 0,
            command: DataBaseVerb::Update,
            item: plan.object.unwrap_or_default(),
            serial: plan.serial,
            position,
            sector,
        });
        self.tell_owed(tick, outputs);
    }

    /// Write the update that has not been taken.
    pub fn tell_owed(&mut self, tick: Tick, outputs: &mut TaskOutputs) {
        if let Some(update) = self.owed {
            self.ask(update, tick, outputs);
        }
    }

    /// The Data System is disconnected, and what was owed to it is dropped.
    pub fn disconnect(&mut self, tick: Tick, outputs: &mut TaskOutputs) {
        self.owed = None;
        self.reconfigure(DataBaseVerb::Abort, tick, outputs);
    }
}
