//! Task and the Data System (IV.4.2, IX.2): commands, repetitions, and updates that are kept until they are accepted.
//!
//! While no Data System is connected, Task sends no updates and does not wait. Once connected, Task sends an update
//! after each completed move from or to the MBD, and after the release of an object that the data base has as held by
//! the robot. An update that is not accepted is kept, also when another command replaces the one that sent it. So is
//! one of an object whose release has outlived its command. What is kept is sent before the next object is moved, at
//! the end of a POSITION or RELEASE-TOOL, or at the end of the next STARTUP, so that the data base is never more than
//! one command behind. With DB-DONE (Figure IV.1) each command is sent once and taken as done: the data base may lack
//! it.

use interfaces::{
    DataBaseCommand, DataBaseStatus, ExternalInputs, TaskOutputs,
    data_base::{Carried, Connection, DataBaseBeliefs, DataBaseReport, DataBaseVerb, KEPT_UPDATES},
    emove::PlacedObject,
    hws::Ledger,
    subtask::{SubtaskStatus, SubtaskVerb},
};
use rcs_core::{
    Plain,
    handshake::Commander,
    name::{Name10, Name16},
    tick::Tick,
};

use super::{
    plan::{Plan, TaskVerb},
    tables::{
        DataBase, Update,
        item::{Carrying, Following, Notice, Released, Taken, Taking, follow, take},
    },
};
use crate::held::Held;

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
    /// What is believed of it: an output, adopted again after a restart.
    pub beliefs: DataBaseBeliefs,
}

impl DataSystem {
    /// In its first tick Task takes over what it believed before a restart, and the command that it wrote
    /// last.
    pub const fn adopt(&mut self, written: &TaskOutputs, tick: Tick) {
        (self.beliefs, self.request) = (written.beliefs, written.data_base);
        let number = written.data_base.number;
        self.commander = Commander { number, sent: tick, started: number != 0 };
    }

    /// What the Data System says. With DB-DONE (Figure IV.1) the last command is done, whatever it says.
    pub fn read(&mut self, external: &ExternalInputs) -> DataBaseStatus {
        self.commander.start(external.data_base.echo);
        if external.operator.db_done {
            DataBaseStatus { echo: self.commander.number, report: DataBaseReport::Done }
        } else {
            external.data_base
        }
    }

    /// First in each tick: an acknowledged update is no longer pending.
    pub fn observe(&mut self, status: &DataBaseStatus, tick: Tick) {
        let [first, second] = self.beliefs.owed;
        let told = self.request.command == DataBaseVerb::Update
            && first.is_some_and(|first| {
                DataBaseCommand { number: self.request.number, ..first } == self.request
            });
        if told && self.status(status, tick) == DataBase::Done {
            self.beliefs.owed = [second, None];
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

    /// Is the Data System told of moves? `executing` is the command that is.
    #[must_use]
    pub const fn connection(&self, executing: Option<TaskVerb>) -> Connection {
        match (self.beliefs.connected, self.beliefs.connecting, executing) {
            (true, _, _) => Connection::Open,
            (false, true, Some(TaskVerb::Startup)) => Connection::Opening,
            (false, true, _) => Connection::Interrupted,
            (false, false, _) => Connection::Closed,
        }
    }

    /// The pending update.
    #[must_use]
    pub fn update(&self, plan: &Plan) -> Update {
        let connecting = plan.verb == TaskVerb::Startup;
        let [owed, _] = self.beliefs.owed;
        if owed.is_some() && (self.beliefs.connected || connecting) {
            Update::Owed
        } else if self.beliefs.connected && plan.update_due {
            Update::Due
        } else {
            Update::None
        }
    }

    /// What the robot carried last, compared with an object.
    #[must_use]
    pub fn carrying(&self, object: Name16) -> Carrying {
        match self.beliefs.carried {
            Some(carried) if carried.item == object && carried.told => Carrying::Followed,
            Some(carried) if carried.item == object => Carrying::Known,
            Some(_) | None => Carrying::Other,
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
        (self.beliefs.connected, self.beliefs.connecting) = (false, true);
        self.ask(DataBaseCommand { command, ..DataBaseCommand::default() }, tick, outputs);
    }

    /// The Data System takes commands.
    pub const fn connect(&mut self) {
        (self.beliefs.connected, self.beliefs.connecting) = (true, false);
    }

    /// A command about an object or a tool is accepted: consult FOLLOW and TAKE.
    pub fn accept(&mut self, plan: &Plan, below: &SubtaskStatus) {
        self.beliefs.taking = None;
        let Some(item) = plan.object else { return };
        let following = Following {
            connection: self.connection(None),
            origin: plan.origin(),
            due: if plan.update_due { Notice::Tell } else { Notice::Omit },
            carrying: self.carrying(item),
        };
        let is_released = below.placed.is_some_and(|placed| placed.object == item);
        let taken = Taken {
            takes: plan.takes(),
            held: Held::of(below.held, Some(item)),
            released: if is_released { Released::Object } else { Released::Other },
            notice: follow((), &following).action,
        };
        let action = take((), &taken).action;
        match action {
            Taking::Keep | Taking::Note => {}
            Taking::Follow => {
                if let Some(carried) = self.beliefs.carried.as_mut().filter(|carried| carried.item == item) {
                    carried.told = true;
                }
            }
            Taking::Drop | Taking::Replace => {
                self.beliefs.carried = self.beliefs.carried.filter(|carried| carried.item != item);
            }
        }
        if matches!(action, Taking::Note | Taking::Replace) {
            let site = plan.source.site().unwrap_or_default();
            let (serial, location, sector) = (plan.serial, site.location, site.sector);
            self.beliefs.taking = Some(Carried { item, serial, location, sector, told: true });
        }
    }

    /// Once a tick: what the robot was sent to take is what it holds, from the order to get it on.
    pub fn hold(&mut self, held: Option<Name16>, ledger: Option<&Ledger>) {
        let is_sent =
            ledger.is_some_and(|ledger| !matches!(ledger.last, SubtaskVerb::None | SubtaskVerb::GetEndeff));
        if is_sent && held.is_some() && held == self.beliefs.taking.map(|taking| taking.item) {
            self.beliefs.carried = self.beliefs.taking.take();
        }
    }

    /// The robot holds the object of a MOVE or an ACQUIRE, of which the data base is `told`, or is not. An ACQUIRE that
    /// found it in the hand, taken elsewhere, leaves where that was; and without an update it keeps its serial number.
    pub fn carry(&mut self, plan: &Plan, told: bool) {
        let item = plan.object.unwrap_or_default();
        let before = self.beliefs.carried.filter(|carried| carried.item == item);
        let (location, sector) = if plan.from_elsewhere {
            before.map_or_else(Default::default, |carried| (carried.location, carried.sector))
        } else {
            let site = plan.destination.site().or(plan.source.site()).unwrap_or_default();
            (site.location, site.sector)
        };
        let known = before.filter(|carried| carried.told && !told);
        let serial = known.map_or(plan.serial, |carried| carried.serial);
        self.beliefs.carried =
            Some(Carried { item, serial, location, sector, told: told || known.is_some() });
    }

    /// REPORT-ITEM (IX.2): write where the object of a command now is, and keep it until it is taken.
    pub fn tell(&mut self, plan: &Plan, in_hand: bool, tick: Tick, outputs: &mut TaskOutputs) {
        let (position, sector) = match plan.destination.site() {
            Some(site) if !in_hand => (site.location, site.sector),
            _ => (Name10::clipped(IN_HAND), None),
        };
        if in_hand {
            self.carry(plan, true);
        } else {
            self.beliefs.carried = self.beliefs.carried.filter(|carried| Some(carried.item) != plan.object);
        }
        let item = plan.object.unwrap_or_default();
        self.owe(item, plan.serial, position, sector);
        self.tell_owed(tick, outputs);
    }

    /// REPORT-ITEM: keep the update of what the robot carried and has let go, until it is taken.
    pub fn owe_released(&mut self, placed: &PlacedObject) {
        if let Some(Carried { item, serial, .. }) = self.beliefs.carried.take() {
            self.owe(item, serial, placed.site.location, placed.site.sector);
        }
    }

    /// Keep an update. A full queue keeps the oldest and the newest.
    fn owe(&mut self, item: Name16, serial: Name16, position: Name10, sector: Option<i32>) {
        let command = DataBaseVerb::Update;
        let update = Some(DataBaseCommand { number: 0, command, item, serial, position, sector });
        self.beliefs.owed = match self.beliefs.owed {
            [None, _] => [update, None],
            [first, _] => [first, update],
        };
    }

    /// Write the oldest update that has not been taken.
    pub fn tell_owed(&mut self, tick: Tick, outputs: &mut TaskOutputs) {
        let [first, _] = self.beliefs.owed;
        if let Some(update) = first {
            self.ask(update, tick, outputs);
        }
    }

    /// The Data System is disconnected, and pending updates are dropped.
    pub fn disconnect(&mut self, tick: Tick, outputs: &mut TaskOutputs) {
        (self.beliefs.owed, self.beliefs.taking, self.beliefs.carried) = ([None; KEPT_UPDATES], None, None);
        self.reconfigure(DataBaseVerb::Abort, tick, outputs);
        self.beliefs.connecting = false;
    }
}
