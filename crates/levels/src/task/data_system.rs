//! Task and the Data System (IV.4.2, IX.2): commands, retries and pending updates.
//!
//! While no Data System is connected, Task sends no updates and does not wait. Once connected, it sends an update
//! after each completed move from or to the MBD, and after the release of an object that the database has as held by
//! the robot. An update that is not accepted is pending, also when its command is replaced or has ended. Task sends
//! pending updates before it moves the next object, at the end of a POSITION or RELEASE-TOOL, and at the end of the
//! next STARTUP. So the database is at most one command behind. With DB-DONE (Figure IV.1) each command is sent once
//! and assumed done, so the database may lack it.

use interfaces::{
    DataBaseCommand, DataBaseStatus, ExternalInputs, TaskOutputs,
    data_base::{Carried, Connection, DataBaseReport, DataBaseUpdates, DataBaseVerb, KEPT_UPDATES},
    emove::{Holding, PlacedObject},
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
        item::{Carrying, Notice, Released, Taken, Taking, TaskFollowing, follow, take},
        load::{Carry, EndedCommand, LoadEvent, NotedObject, PickUp, TakeOrder, carry, pick_up},
        pending::{Change, Event, Pending, QueueChange, Unsent, queue, update},
    },
};
use crate::held::Held;

/// Ticks for an answer: 10 s, for a factory network.
pub const ANSWER_LIMIT: u64 = 250;
/// After this many attempts the Data System is reported silent.
pub const MAX_TRIES: u8 = 3;
/// `STORAGE-POS` of an object that the robot holds, and the name of the client (IX.2).
pub const IN_HAND: &str = "H_ROBOT";

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct DataSystem {
    pub commander: Commander,
    pub request: DataBaseCommand, // the last command
    pub tries: u8,                // times that `request` was written
    pub updates: DataBaseUpdates, // an output, adopted again after a restart
}

impl DataSystem {
    /// Adopt the outputs from before a restart, and the last command.
    pub const fn adopt(&mut self, written: &TaskOutputs, tick: Tick) {
        (self.updates, self.request) = (written.updates, written.data_base);
        let number = written.data_base.number;
        self.commander = Commander { number, sent: tick, started: number != 0 };
    }

    /// With DB-DONE (Figure IV.1) the last command is always done.
    pub fn read(&mut self, external: &ExternalInputs) -> DataBaseStatus {
        self.commander.start(external.data_base.echo);
        if external.operator.db_done {
            DataBaseStatus { echo: self.commander.number, report: DataBaseReport::Done }
        } else {
            external.data_base
        }
    }

    /// Call first in each tick. An accepted update leaves the queue.
    pub fn observe(&mut self, status: &DataBaseStatus, tick: Tick) {
        let [first, _] = self.updates.pending;
        let is_first_sent = first
            .is_some_and(|first| DataBaseCommand { number: self.request.number, ..first } == self.request);
        let is_accepted = is_first_sent && self.status(status, tick) == DataBase::Done;
        self.change(if is_accepted { Event::Accepted } else { Event::None }, None);
    }

    /// Consult QUEUE. `new` is the update of [`Event::New`].
    fn change(&mut self, event: Event, new: Option<DataBaseCommand>) {
        let [first, second] = self.updates.pending;
        self.updates.pending = match queue((), &Change { event, pending: self.pending() }).action {
            QueueChange::Keep => [first, second],
            QueueChange::RemoveFirst => [second, None],
            QueueChange::StoreFirst => [new, None],
            QueueChange::StoreSecond => [first, new],
            QueueChange::Clear => [None; KEPT_UPDATES],
        };
    }

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

    /// `executing` is the current command.
    #[must_use]
    pub const fn connection(&self, executing: Option<TaskVerb>) -> Connection {
        match (self.updates.connected, self.updates.connecting, executing) {
            (true, _, _) => Connection::Open,
            (false, true, Some(TaskVerb::Startup)) => Connection::Opening,
            (false, true, _) => Connection::Interrupted,
            (false, false, _) => Connection::Closed,
        }
    }

    const fn pending(&self) -> Pending {
        match self.updates.pending {
            [None, _] => Pending::None,
            [Some(_), None] => Pending::One,
            [Some(_), Some(_)] => Pending::Two,
        }
    }

    #[must_use]
    pub fn update(&self, plan: &Plan) -> Update {
        let unsent = Unsent {
            pending: self.pending(),
            connection: self.connection(Some(plan.verb)),
            due: if plan.update_due { Notice::Send } else { Notice::Omit },
        };
        update((), &unsent).action
    }

    /// Compare the object carried last with `object`.
    #[must_use]
    pub fn carrying(&self, object: Name16) -> Carrying {
        match self.updates.carried {
            Some(carried) if carried.item == object && carried.followed => Carrying::Followed,
            Some(carried) if carried.item == object => Carrying::Known,
            Some(_) | None => Carrying::Other,
        }
    }

    fn send(&mut self, request: DataBaseCommand, tick: Tick, outputs: &mut TaskOutputs) {
        self.tries = 0;
        self.request = request;
        self.send_again(tick, outputs);
    }

    pub fn send_again(&mut self, tick: Tick, outputs: &mut TaskOutputs) {
        self.tries = self.tries.saturating_add(1);
        self.request.number = self.commander.send(tick);
        outputs.data_base = self.request;
    }

    pub fn reconfigure(&mut self, command: DataBaseVerb, tick: Tick, outputs: &mut TaskOutputs) {
        (self.updates.connected, self.updates.connecting) = (false, true);
        self.send(DataBaseCommand { command, ..DataBaseCommand::default() }, tick, outputs);
    }

    pub const fn connect(&mut self) {
        (self.updates.connected, self.updates.connecting) = (true, false);
    }
    pub fn accept(&mut self, plan: &Plan, below: &SubtaskStatus) {
        self.updates.taking = None;
        let Some(item) = plan.object else { return };
        let following = TaskFollowing {
            connection: self.connection(None),
            origin: plan.origin(),
            due: if plan.update_due { Notice::Send } else { Notice::Omit },
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
                if let Some(carried) = self.updates.carried.as_mut().filter(|carried| carried.item == item) {
                    carried.followed = true;
                }
            }
            Taking::Drop | Taking::Replace => {
                self.updates.carried = self.updates.carried.filter(|carried| carried.item != item);
            }
        }
        if matches!(action, Taking::Note | Taking::Replace) {
            let site = plan.source.site().unwrap_or_default();
            let (serial, location, sector) = (plan.serial, site.location, site.sector);
            self.updates.taking = Some(Carried { item, serial, location, sector, followed: true });
        }
    }
    pub fn observe_grasp(&mut self, held: Holding, ledger: Option<&Ledger>) {
        let noted = NotedObject {
            order: match ledger.map(|ledger| ledger.last) {
                None | Some(SubtaskVerb::None | SubtaskVerb::GetEndeff) => TakeOrder::Before,
                Some(_) => TakeOrder::Given,
            },
            held: Held::of(held, self.updates.taking.map(|taking| taking.item)),
        };
        match pick_up((), &noted).action {
            PickUp::Keep => {}
            PickUp::Carry => self.updates.carried = self.updates.taking.take(),
        }
    }

    /// Consult CARRY about the object of a command that ends or sends its update.
    pub fn carry(&mut self, occasion: LoadEvent, plan: &Plan, held: Held) {
        let load = EndedCommand {
            occasion,
            verb: plan.verb,
            held,
            origin: plan.origin(),
            carrying: plan.object.map_or(Carrying::Other, |object| self.carrying(object)),
        };
        let (item, serial) = (plan.object.unwrap_or_default(), plan.serial);
        let site = plan.destination.site().or(plan.source.site()).unwrap_or_default();
        let here = Carried { item, serial, location: site.location, sector: site.sector, followed: false };
        let before = self.updates.carried.filter(|carried| carried.item == item);
        let there = before.unwrap_or_default();
        self.updates.carried = match carry((), &load).action {
            Carry::Keep => return,
            Carry::Drop => self.updates.carried.filter(|_| before.is_none()),
            Carry::Note => Some(here),
            Carry::Follow => Some(Carried { followed: true, ..here }),
            Carry::KeepSerial => Some(Carried { serial: there.serial, followed: true, ..here }),
            Carry::KeepPlace => Some(Carried { location: there.location, sector: there.sector, ..here }),
        };
    }

    /// REPORT-ITEM (IX.2): send the place of a command's object. The update is pending until it is accepted.
    pub fn report_item(&mut self, plan: &Plan, held: Held, tick: Tick, outputs: &mut TaskOutputs) {
        self.carry(LoadEvent::Update, plan, held);
        let (position, sector) = match plan.destination.site() {
            Some(site) if held != Held::Right => (site.location, site.sector),
            _ => (Name10::clipped(IN_HAND), None),
        };
        self.append(plan.object.unwrap_or_default(), plan.serial, position, sector);
        self.send_pending(tick, outputs);
    }

    /// Append an update (REPORT-ITEM) about the object that the robot has carried and released.
    pub fn append_released(&mut self, placed: &PlacedObject) {
        if let Some(Carried { item, serial, .. }) = self.updates.carried.take() {
            self.append(item, serial, placed.site.location, placed.site.sector);
        }
    }

    fn append(&mut self, item: Name16, serial: Name16, position: Name10, sector: Option<i32>) {
        let command = DataBaseVerb::Update;
        self.change(Event::New, Some(DataBaseCommand { number: 0, command, item, serial, position, sector }));
    }

    pub fn send_pending(&mut self, tick: Tick, outputs: &mut TaskOutputs) {
        let [first, _] = self.updates.pending;
        if let Some(update) = first {
            self.send(update, tick, outputs);
        }
    }

    pub fn disconnect(&mut self, tick: Tick, outputs: &mut TaskOutputs) {
        self.change(Event::Discard, None);
        (self.updates.taking, self.updates.carried) = (None, None);
        self.reconfigure(DataBaseVerb::Abort, tick, outputs);
        self.updates.connecting = false;
    }
}
