//! The controller's end of the Data System: mailboxes, the handshake with Task, and a [`ItemStore`] for the commands.

use std::fmt::Debug;

use interfaces::{DataBaseCommand, DataBaseStatus, data_base::DataBaseReport};
use rcs_core::{
    handshake::{self, Arrival},
    tick::Tick,
};

use super::{
    books::Books,
    command,
    records::{Item, Records as _},
    server::{Answer, Server},
    status::{STATUS, Status, Summary},
};
use crate::mailbox::{DATA_SYSTEM_COMMAND, DATA_SYSTEM_STATUS, Mailbox, MailboxError};

pub const ANSWER_TICKS: u64 = 25; // 1 s

pub trait ItemStore {
    fn execute(&mut self, id: u16, bytes: &[u8]) -> bool;

    fn reply(&mut self, id: u16) -> Reply;

    fn items(&mut self) -> Result<Vec<Item>, String>;
}

#[derive(Clone, Debug)]
pub enum Reply {
    Answer(Answer),
    Silent, // no answer: Task repeats the command after a time
    Pending,
    Dead,
}

#[derive(Clone, Debug, Default)]
pub struct InMemory {
    server: Server<Books>,
    answer: Option<Answer>,
}

impl ItemStore for InMemory {
    fn execute(&mut self, _: u16, bytes: &[u8]) -> bool {
        self.answer = Some(self.server.execute(bytes));
        true
    }

    fn reply(&mut self, _: u16) -> Reply {
        self.answer.take().map_or(Reply::Silent, Reply::Answer)
    }

    fn items(&mut self) -> Result<Vec<Item>, String> {
        self.server.records().items().map_err(|never| match never {})
    }
}

/// The mailboxes and the keeper. With [`InMemory`] a copy continues from the same state.
#[derive(Clone, Debug)]
pub struct DataSystem<K = InMemory> {
    answer_ticks: u64,
    receiver: handshake::Receiver,
    due: Option<Tick>, // first tick in which the answer may take effect; `None` without a command in progress
    status: DataBaseStatus,
    command_box: Mailbox,
    status_box: Mailbox,
    refusals: Vec<String>,
    keeper: K,
}

impl DataSystem {
    #[must_use]
    pub fn in_memory(answer_ticks: u64) -> Self {
        Self::new(InMemory::default(), answer_ticks)
    }

    /// A Data System whose items are lost and that still knows the connected controller.
    #[must_use]
    pub fn reconnected(answer_ticks: u64) -> Self {
        let keeper = InMemory { server: Server::started(command::CLIENT), answer: None };
        Self::new(keeper, answer_ticks)
    }

    /// All state on which later answers depend: items, clients, the command in progress, ticks until its answer.
    pub fn state(&self, tick: Tick) -> impl Debug {
        (&self.keeper, self.status.report, self.due.map(|due| due.since(tick)))
    }
}

impl<K: ItemStore> DataSystem<K> {
    #[must_use]
    pub fn new(keeper: K, answer_ticks: u64) -> Self {
        Self {
            answer_ticks,
            receiver: handshake::Receiver::default(),
            due: None,
            status: DataBaseStatus::default(),
            command_box: Mailbox::initialized(DATA_SYSTEM_COMMAND),
            status_box: Mailbox::initialized(DATA_SYSTEM_STATUS),
            refusals: Vec::new(),
            keeper,
        }
    }

    #[must_use]
    pub const fn keeper(&self) -> &K {
        &self.keeper
    }

    #[must_use]
    pub const fn status(&self) -> DataBaseStatus {
        self.status
    }

    #[must_use]
    pub const fn command_box(&self) -> &Mailbox {
        &self.command_box
    }

    #[must_use]
    pub const fn status_box(&self) -> &Mailbox {
        &self.status_box
    }

    pub fn refusals(&mut self) -> Vec<String> {
        std::mem::take(&mut self.refusals)
    }

    /// Call once per tick, after the controller. Reads the command of `tick`.
    pub fn step(&mut self, tick: Tick, command: &DataBaseCommand) {
        if self.receiver.observe(command.number) == Arrival::New {
            self.send(tick, command);
        }
        if self.due.is_some_and(|due| tick >= due) {
            self.receive();
        }
    }

    /// UPDATE-MAILGRAM->DAS-?: the network sends the mailbox.
    fn send(&mut self, tick: Tick, command: &DataBaseCommand) {
        self.due = None;
        self.status = DataBaseStatus { echo: self.receiver.echo, report: DataBaseReport::Executing };
        let written =
            command::encode(command).map_err(|error| error.to_string()).and_then(|(bytes, length)| {
                self.command_box.write(&bytes[..length]).map_err(|error: MailboxError| error.to_string())
            });
        if let Err(why) = written {
            self.refuse(why);
            return;
        }
        if self.keeper.execute(self.asked(), self.command_box.data()) {
            self.due = Some(Tick(tick.0.saturating_add(self.answer_ticks)));
        } else {
            self.refuse("the Data System has ended".to_owned());
        }
    }

    fn receive(&mut self) {
        match self.keeper.reply(self.asked()) {
            Reply::Pending => return,
            Reply::Answer(answer) => self.take(&answer),
            Reply::Silent => {}
            Reply::Dead => self.refuse("the Data System does not answer".to_owned()),
        }
        self.due = None;
    }

    fn asked(&self) -> u16 {
        command::low_word(self.receiver.echo)
    }

    fn take(&mut self, answer: &Answer) {
        let bytes: [u8; STATUS] = answer.status.encode();
        let status = self
            .status_box
            .write(&bytes)
            .map_err(|error| error.to_string())
            .and_then(|()| Status::decode(self.status_box.data()).map_err(|error| error.to_string()));
        match status {
            Ok(Status { summary: Summary::Done, .. }) => {
                self.status.report = DataBaseReport::Done;
                if !answer.why.is_empty() {
                    self.refusals.push(answer.why.clone());
                }
            }
            Ok(Status { summary: Summary::Refused(refusal), .. }) => {
                self.refuse(format!("{refusal}: {}", answer.why));
            }
            Ok(status) => self.refuse(format!("an answer without a summary: {status:?}")),
            Err(why) => self.refuse(why),
        }
    }

    fn refuse(&mut self, why: String) {
        self.status.report = DataBaseReport::Refused;
        self.refusals.push(why);
    }

    /// Items by name and number. Empty if the server is in another process, which does not send them.
    pub fn items(&mut self) -> Result<Vec<Item>, String> {
        self.keeper.items()
    }
}
