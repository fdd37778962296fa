//! The controller's end of the Data System: mailboxes, the handshake with Task, and a [`Keeper`] that executes.

use std::fmt::Debug;

use interfaces::{DataBaseCommand, DataBaseStatus, data_base::DataBaseReport};
use rcs_core::{
    handshake::{self, Arrival},
    tick::Tick,
};

use super::{
    agent::{Agent, Remark},
    books::Books,
    command,
    server::{Answer, Records as _, Server},
    status::{STATUS, Status, Summary},
    store::{Item, Store},
    thread::{Pace, Threaded},
};
use crate::mailbox::{DATA_SYSTEM_COMMAND, DATA_SYSTEM_STATUS, Mailbox, MailboxError};

/// Default number of ticks for an answer: 1 s.
pub const ANSWER_TICKS: u64 = 25;

/// Executes the commands of a Data System.
pub trait Keeper {
    /// Begin the command of this number; false if nobody executes it.
    fn execute(&mut self, id: u16, bytes: &[u8]) -> bool;

    /// The reply to the command of this number, which was begun last.
    fn reply(&mut self, id: u16) -> Reply;

    /// The reported items, sorted by name and number.
    ///
    /// # Errors
    /// A text that says why they cannot be listed.
    fn items(&mut self) -> Result<Vec<Item>, String>;
}

/// Reply to a command.
#[derive(Clone, Debug)]
pub enum Reply {
    /// It was executed or refused.
    Answer(Answer),
    /// It has no answer: Task counts the ticks and repeats the command.
    Silent,
    /// It is still being executed.
    Pending,
    /// The keeper has ended.
    Dead,
}

/// A keeper in memory, which executes a command at once.
#[derive(Clone, Debug, Default)]
pub struct InMemory {
    server: Server<Books>,
    answer: Option<Answer>,
}

impl Keeper for InMemory {
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

/// The Data System's mailboxes, and the keeper behind them. With [`InMemory`] it is a value: a copy continues from the same
/// state.
#[derive(Clone, Debug)]
pub struct DataSystem<K = Threaded> {
    answer_ticks: u64,
    receiver: handshake::Receiver,
    /// First tick in which the answer to the command in progress may take effect; `None` if no command is in progress.
    due: Option<Tick>,
    status: DataBaseStatus,
    command_box: Mailbox,
    status_box: Mailbox,
    refusals: Vec<String>,
    keeper: K,
}

impl DataSystem {
    /// A Data System with a database in this process, which answers a command after `answer_ticks` ticks, or later.
    #[must_use]
    pub fn new(store: Store, answer_ticks: u64, pace: Pace) -> Self {
        Self::with(Threaded::here(store, pace), answer_ticks)
    }

    /// A Data System in another process. In a run that waits, its answers take effect after as many ticks as those of a
    /// server in this process, so that both runs are the same; on the grid they take effect when they arrive.
    #[must_use]
    pub fn elsewhere(agent: Agent, pace: Pace) -> Self {
        let ticks = if pace == Pace::Wait { ANSWER_TICKS } else { 0 };
        Self::with(Threaded::elsewhere(agent, pace), ticks)
    }

    /// Call before the first tick: in a run that waits, [`Self::remarks`] then contains a server that has connected.
    pub fn begin(&self) {
        self.keeper.look();
    }

    /// Remarks about a server in another process since the last call.
    pub fn remarks(&self) -> Vec<Remark> {
        self.keeper.remarks()
    }
}

impl DataSystem<InMemory> {
    /// A Data System that keeps its items in memory and answers a command after `answer_ticks` ticks.
    #[must_use]
    pub fn in_memory(answer_ticks: u64) -> Self {
        Self::with(InMemory::default(), answer_ticks)
    }

    /// Everything on which the answers after `tick` depend, for comparison: items, clients, the command in progress and
    /// the ticks until its answer.
    pub fn state(&self, tick: Tick) -> impl Debug {
        (&self.keeper, self.status.report, self.due.map(|due| due.since(tick)))
    }
}

impl<K: Keeper> DataSystem<K> {
    fn with(keeper: K, answer_ticks: u64) -> Self {
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

    /// The status that Task reads in the next tick.
    #[must_use]
    pub const fn status(&self) -> DataBaseStatus {
        self.status
    }

    /// The mailbox from Task.
    #[must_use]
    pub const fn command_box(&self) -> &Mailbox {
        &self.command_box
    }

    /// The mailbox to Task.
    #[must_use]
    pub const fn status_box(&self) -> &Mailbox {
        &self.status_box
    }

    /// Why commands were refused, since the last call.
    pub fn refusals(&mut self) -> Vec<String> {
        std::mem::take(&mut self.refusals)
    }

    /// Call once per tick, after the controller: read the command that Task wrote in `tick`.
    pub fn step(&mut self, tick: Tick, command: &DataBaseCommand) {
        if self.receiver.observe(command.number) == Arrival::New {
            self.send(tick, command);
        }
        if self.due.is_some_and(|due| tick >= due) {
            self.receive();
        }
    }

    /// UPDATE-MAILGRAM->DAS-?: write the mailbox, which the network then sends.
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

    /// Take the answer to the command in progress, if it has arrived.
    fn receive(&mut self) {
        match self.keeper.reply(self.asked()) {
            Reply::Pending => return,
            Reply::Answer(answer) => self.take(&answer),
            Reply::Silent => {}
            Reply::Dead => self.refuse("the Data System does not answer".to_owned()),
        }
        self.due = None;
    }

    /// command-id# of the command in progress.
    fn asked(&self) -> u16 {
        command::low_word(self.receiver.echo)
    }

    /// Process an answer: write its status to the mailbox, and read it (Parse-das-status).
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

    /// The reported items, sorted by name and number. Empty if the server is in another process: only that process can
    /// list them.
    ///
    /// # Errors
    /// A text that says why the database cannot list them.
    pub fn items(&mut self) -> Result<Vec<Item>, String> {
        self.keeper.items()
    }
}

#[cfg(test)]
mod tests {
    use interfaces::data_base::DataBaseVerb;
    use rcs_core::name::{Name10, Name16};

    use super::*;

    /// A client with its command buffer.
    struct Client {
        system: DataSystem,
        command: DataBaseCommand,
        tick: Tick,
    }

    impl Client {
        fn new(answer_ticks: u64, pace: Pace) -> Self {
            let mut client = Self {
                system: DataSystem::new(Store::in_memory().unwrap(), answer_ticks, pace),
                command: DataBaseCommand::default(),
                tick: Tick::BEFORE_START,
            };
            client.step();
            client
        }

        fn step(&mut self) -> DataBaseStatus {
            self.tick = self.tick.next();
            self.system.step(self.tick, &self.command);
            self.system.status()
        }

        fn write(&mut self, command: DataBaseVerb) {
            self.command = DataBaseCommand { number: self.command.number + 1, command, ..self.command };
        }

        /// Write a command and step until it is answered; returns the report.
        fn ask(&mut self, command: DataBaseVerb) -> DataBaseReport {
            self.write(command);
            loop {
                let status = self.step();
                assert_eq!(status.echo, self.command.number);
                if status.report != DataBaseReport::Executing {
                    return status.report;
                }
                std::thread::yield_now();
            }
        }

        fn connect(&mut self) {
            for verb in [DataBaseVerb::Abort, DataBaseVerb::Initiate, DataBaseVerb::Startup] {
                assert_eq!(self.ask(verb), DataBaseReport::Done, "{verb}");
            }
        }
    }

    #[test]
    fn an_answer_takes_its_time_and_is_given_once() {
        let mut client = Client::new(10, Pace::Wait);
        client.write(DataBaseVerb::Abort);
        let busy = (0..10).filter(|_| client.step().report == DataBaseReport::Executing).count();
        assert_eq!((busy, client.step().report), (10, DataBaseReport::Done));
        let before = client.system.status();
        (0..50).for_each(|_| assert_eq!(client.step(), before));
    }

    #[test]
    fn a_command_that_stands_there_at_the_start_is_not_executed() {
        let mut system = DataSystem::new(Store::in_memory().unwrap(), 0, Pace::Wait);
        let command =
            DataBaseCommand { number: 9, command: DataBaseVerb::Abort, ..DataBaseCommand::default() };
        for tick in 1..10 {
            system.step(Tick(tick), &command);
            assert_eq!(system.status(), DataBaseStatus::default());
        }
    }

    #[test]
    fn what_is_told_goes_through_the_mailboxes_into_the_data_base() {
        for pace in [Pace::Wait, Pace::Poll] {
            let mut client = Client::new(2, pace);
            client.connect();
            client.command.item = Name16::new("LINKBAR1").unwrap();
            client.command.serial = Name16::new("17").unwrap();
            client.command.position = Name10::new("UNIT_1").unwrap();
            client.command.sector = Some(4);
            assert_eq!(client.ask(DataBaseVerb::Update), DataBaseReport::Done);
            assert_eq!(client.system.command_box().mailgram(), 4);
            assert_eq!(client.system.command_box().data().len(), command::DML);
            assert_eq!(client.system.status_box().data().len(), STATUS);
            let items = client.system.items().unwrap();
            assert_eq!((items.len(), items[0].number.as_str(), items[0].sector), (1, "17", 4));
            assert!(client.system.refusals().is_empty());
        }
    }

    #[test]
    fn a_refusal_says_why() {
        let mut client = Client::new(0, Pace::Wait);
        assert_eq!(client.ask(DataBaseVerb::Startup), DataBaseReport::Refused);
        assert_eq!(client.ask(DataBaseVerb::None), DataBaseReport::Refused);
        assert_eq!(
            client.system.refusals(),
            [
                "the connection is not in the state for this command: Startup from a client that is Closed",
                "no command"
            ]
        );
    }

    #[test]
    fn a_command_that_overtakes_another_gets_its_own_answer() {
        let mut client = Client::new(5, Pace::Wait);
        client.write(DataBaseVerb::Startup);
        client.step();
        assert_eq!(client.ask(DataBaseVerb::Abort), DataBaseReport::Done);
        assert_eq!(client.ask(DataBaseVerb::Initiate), DataBaseReport::Done);
    }

    #[test]
    fn a_data_system_in_memory_answers_like_one_with_a_thread_and_so_does_its_copy() {
        let mut threaded = DataSystem::new(Store::in_memory().unwrap(), 3, Pace::Wait);
        let mut in_memory = DataSystem::in_memory(3);
        let mut command = DataBaseCommand {
            item: Name16::new("LINKBAR1").unwrap(),
            position: Name10::new("UNIT_1").unwrap(),
            sector: Some(4),
            ..DataBaseCommand::default()
        };
        use DataBaseVerb::{Abort, Initiate, Startup, Update};
        for (tick, verb) in (1..).zip([Update, Abort, Initiate, Startup, Update, Update]) {
            command = DataBaseCommand { number: tick, command: verb, ..command };
            for within in 0..5 {
                let tick = Tick(u64::from(tick) * 5 + within);
                threaded.step(tick, &command);
                in_memory = in_memory.clone();
                in_memory.step(tick, &command);
                assert_eq!(in_memory.status(), threaded.status(), "{tick}, {verb}");
            }
        }
        assert_eq!(in_memory.refusals(), threaded.refusals());
        assert_eq!(in_memory.items(), threaded.items());
        assert_eq!(in_memory.items().unwrap().len(), 1);
    }
}
