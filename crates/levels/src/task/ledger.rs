//! Task and the Data System (IV.4.2, IX.2): what is asked, asked again, and kept until it is taken.
//!
//! While no Data System is connected nothing is told and nothing waited for, as with DB-DONE (Figure IV.1).
//! Once connected, the move of a command from or to the MBD is told when it has been made. An update that is
//! not taken is kept: before the next object is moved, or at the end of the next STARTUP, it is told again,
//! so that the data base is never more than one move behind.

use rcs_core::{
    interface::{
        DataBaseCommand, DataBaseStatus, TaskOutputs,
        data_base::{DataBaseReport, DataBaseVerb},
    },
    name::Name10,
    tick::Tick,
};

use super::{
    plan::{Plan, TaskVerb},
    state::Ledger,
    tables::{Books, DataBase},
};

/// Ticks in which the Data System is expected to finish a command: 10 s, on a factory network.
pub const ANSWER_LIMIT: u64 = 250;
/// How often a command is written before the Data System counts as silent.
pub const MAX_TRIES: u8 = 3;
/// `STORAGE-POS` of what the robot holds, which is also the name of the client (IX.2).
pub const IN_HAND: &str = "H_ROBOT";

impl Ledger {
    /// Once a tick, before anything else: an update that is taken is owed no longer.
    pub fn observe(&mut self, status: &DataBaseStatus, tick: Tick) {
        self.commander.start(status.echo);
        if self.request.command == DataBaseVerb::Update && self.status(status, tick) == DataBase::Done {
            self.owed = false;
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

    /// What is to be told.
    #[must_use]
    pub const fn books(&self, plan: &Plan) -> Books {
        let connecting = matches!(plan.verb, TaskVerb::Startup);
        if self.owed && (self.connected || connecting) {
            Books::Owed
        } else if self.connected && plan.concerns_mbd && !self.told {
            Books::Open
        } else {
            Books::Closed
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

    /// REPORT-ITEM (IX.2): where the object of a command now is.
    pub fn tell(&mut self, plan: &Plan, in_hand: bool, tick: Tick, outputs: &mut TaskOutputs) {
        let (position, sector) = if in_hand {
            (Name10::clipped(IN_HAND), 0)
        } else {
            (plan.destination.location, plan.destination.sector)
        };
        self.update = DataBaseCommand {
            number: 0,
            command: DataBaseVerb::Update,
            item: plan.object,
            serial: plan.serial,
            position,
            sector,
        };
        self.told = true;
        self.tell_owed(tick, outputs);
    }

    /// Write the last update.
    pub fn tell_owed(&mut self, tick: Tick, outputs: &mut TaskOutputs) {
        self.owed = true;
        self.ask(self.update, tick, outputs);
    }

    /// The Data System is gone, and with it what was owed to it.
    pub fn disconnect(&mut self, tick: Tick, outputs: &mut TaskOutputs) {
        self.owed = false;
        self.reconfigure(DataBaseVerb::Abort, tick, outputs);
    }
}
