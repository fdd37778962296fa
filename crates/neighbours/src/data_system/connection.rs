//! The Data System of a run: mailboxes at one end, a server on a separate thread at the other.
//!
//! The disk must not delay a tick. A run in fast clock waits for the server when an answer is due, so that its ticks
//! are the same in every run; a run on the 40 ms grid takes the answer when it has come. A run that has ended does not
//! wait for a server in another process, which may not answer for a long time.

use std::{
    sync::mpsc::{Receiver, RecvTimeoutError, Sender, TryRecvError, channel},
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use interfaces::{DataBaseCommand, DataBaseStatus, data_base::DataBaseReport};
use rcs_core::{
    handshake::{self, Arrival},
    tick::Tick,
};

use super::{
    agent::{Agent, Remark},
    command,
    server::{Answer, Server},
    status::{STATUS, Status, Summary},
    store::{Item, Store},
};
use crate::{
    mailbox::{DATA_SYSTEM_COMMAND, DATA_SYSTEM_STATUS, Mailbox, MailboxError},
    network::StopHandle,
};

/// Default number of ticks for an answer: 1 s.
pub const ANSWER_TICKS: u64 = 25;
/// A run that waits for the server considers it dead after this time, which is long for a disk. An agent has its own
/// time limit.
const PATIENCE: Duration = Duration::from_secs(30);

/// Time between two checks for a server while no command is in progress.
const IDLE: Duration = Duration::from_millis(500);

/// Whether a run waits for the server.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// The tick waits for an answer that is due: for runs in fast clock.
    Wait,
    /// The answer takes effect in the tick in which it has come: for runs on the grid.
    Poll,
}

/// A request to the server's thread.
enum Request {
    /// The command of this number.
    Execute(u16, Vec<u8>),
    Items,
}

/// A response of the server's thread.
enum Response {
    /// The answer to the command of this number.
    Executed(u16, Answer),
    /// The command of this number has no answer.
    Silent(u16),
    Items(rusqlite::Result<Vec<Item>>),
}

/// The server that keeps the items.
enum Keeper {
    /// In this process, on the thread.
    Here(Box<Server>),
    /// In another process.
    Elsewhere(Box<Agent>),
}

impl Keeper {
    fn respond(&mut self, request: Request) -> Response {
        match (self, request) {
            (Self::Here(server), Request::Execute(id, bytes)) => {
                Response::Executed(id, server.execute(&bytes))
            }
            (Self::Here(server), Request::Items) => Response::Items(server.store().items()),
            (Self::Elsewhere(agent), Request::Execute(id, bytes)) => {
                agent.execute(&bytes).map_or(Response::Silent(id), |answer| Response::Executed(id, answer))
            }
            // The items are available only in the process that keeps them.
            (Self::Elsewhere(_), Request::Items) => Response::Items(Ok(Vec::new())),
        }
    }

    /// Work to do while there are no requests.
    fn idle(&mut self) {
        if let Self::Elsewhere(agent) = self {
            agent.idle();
        }
    }

    /// The remarks since the last call.
    fn remarks(&mut self) -> Vec<Remark> {
        match self {
            Self::Here(_) => Vec::new(),
            Self::Elsewhere(agent) => agent.remarks(),
        }
    }
}

/// The thread has ended and does not answer.
struct Dead;

/// The Data System's mailboxes, and the thread of its server.
#[derive(Debug)]
pub struct DataSystem {
    pace: Pace,
    answer_ticks: u64,
    receiver: handshake::Receiver,
    /// First tick in which the answer to the command in progress may take effect; `None` if no command is in progress.
    due: Option<Tick>,
    status: DataBaseStatus,
    command_box: Mailbox,
    status_box: Mailbox,
    refusals: Vec<String>,
    remarks: Receiver<Remark>,
    /// Ends the wait for a server in another process; `None` if the server is in this process.
    stop_handle: Option<StopHandle>,
    requests: Option<Sender<Request>>,
    responses: Receiver<Response>,
    thread: Option<JoinHandle<()>>,
}

impl DataSystem {
    /// A Data System that answers a command after `answer_ticks` ticks, or later.
    #[must_use]
    pub fn new(store: Store, answer_ticks: u64, pace: Pace) -> Self {
        Self::with(Keeper::Here(Box::new(Server::new(store))), answer_ticks, pace)
    }

    /// A Data System in another process. In a run that waits, its answers take effect after as many ticks as those of a
    /// server in this process, so that both runs are the same; on the grid they take effect when they come.
    #[must_use]
    pub fn elsewhere(agent: Agent, pace: Pace) -> Self {
        let ticks = if pace == Pace::Wait { ANSWER_TICKS } else { 0 };
        let stop_handle = Some(agent.stop_handle());
        let mut system = Self::with(Keeper::Elsewhere(Box::new(agent)), ticks, pace);
        system.stop_handle = stop_handle;
        system
    }

    fn with(mut keeper: Keeper, answer_ticks: u64, pace: Pace) -> Self {
        let (requests, incoming) = channel::<Request>();
        let (outgoing, responses) = channel();
        let (tell, remarks) = channel();
        let thread = thread::spawn(move || {
            loop {
                let response = match incoming.recv_timeout(IDLE) {
                    Ok(request) => Some(keeper.respond(request)),
                    Err(RecvTimeoutError::Timeout) => {
                        keeper.idle();
                        None
                    }
                    Err(RecvTimeoutError::Disconnected) => return,
                };
                // Before the answer, so that a tick that has waited for the answer has the remarks as well.
                let told = keeper.remarks().into_iter().all(|remark| tell.send(remark).is_ok());
                if !told || response.is_some_and(|response| outgoing.send(response).is_err()) {
                    return;
                }
            }
        });
        Self {
            pace,
            answer_ticks,
            receiver: handshake::Receiver::default(),
            due: None,
            status: DataBaseStatus::default(),
            command_box: Mailbox::initialized(DATA_SYSTEM_COMMAND),
            status_box: Mailbox::initialized(DATA_SYSTEM_STATUS),
            refusals: Vec::new(),
            remarks,
            stop_handle: None,
            requests: Some(requests),
            responses,
            thread: Some(thread),
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

    /// Remarks about a server in another process since the last call.
    pub fn remarks(&self) -> Vec<Remark> {
        self.remarks.try_iter().collect()
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
        let request = Request::Execute(self.asked(), self.command_box.data().to_vec());
        if self.requests.as_ref().is_some_and(|requests| requests.send(request).is_ok()) {
            self.due = Some(Tick(tick.0.saturating_add(self.answer_ticks)));
        } else {
            self.refuse("the Data System has ended".to_owned());
        }
    }

    /// Take the answer to the command in progress, if it has come; an answer to an earlier command is too late and is
    /// dropped.
    fn receive(&mut self) {
        loop {
            match self.response() {
                Ok(Some(Response::Executed(id, answer))) if id == self.asked() => {
                    self.due = None;
                    self.take(&answer);
                    return;
                }
                Ok(Some(Response::Silent(id))) if id == self.asked() => {
                    // Task counts the ticks and repeats the command.
                    self.due = None;
                    return;
                }
                Ok(Some(_)) => {}
                Ok(None) => return,
                Err(Dead) => {
                    self.due = None;
                    self.refuse("the Data System does not answer".to_owned());
                    return;
                }
            }
        }
    }

    /// The next response of the thread; `None` if there is none yet.
    fn response(&self) -> Result<Option<Response>, Dead> {
        match self.pace {
            Pace::Poll => match self.responses.try_recv() {
                Ok(response) => Ok(Some(response)),
                Err(TryRecvError::Empty) => Ok(None),
                Err(TryRecvError::Disconnected) => Err(Dead),
            },
            Pace::Wait if self.stop_handle.is_some() => self.responses.recv().map(Some).map_err(|_| Dead),
            Pace::Wait => self.responses.recv_timeout(PATIENCE).map(Some).map_err(|_| Dead),
        }
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
    /// A text that says why the data base cannot list them.
    pub fn items(&mut self) -> Result<Vec<Item>, String> {
        if self.stop_handle.is_some() {
            // The thread may be waiting for that process.
            return Ok(Vec::new());
        }
        let gone = || "the Data System has ended".to_owned();
        self.requests.as_ref().ok_or_else(gone)?.send(Request::Items).map_err(|_| gone())?;
        loop {
            match self.responses.recv_timeout(PATIENCE) {
                Ok(Response::Items(items)) => return items.map_err(|error| error.to_string()),
                Ok(Response::Executed(..) | Response::Silent(_)) => {}
                Err(_) => return Err("the Data System does not answer".to_owned()),
            }
        }
    }
}

impl Drop for DataSystem {
    fn drop(&mut self) {
        if let Some(stop_handle) = &self.stop_handle {
            // Updates that are not answered yet stay in the outbox.
            stop_handle.stop();
        }
        // Closing the channel of requests ends the thread, which closes the data base, so that no journal is left.
        self.requests = None;
        let Some(thread) = self.thread.take() else { return };
        let ended = Instant::now();
        // A disk could block the thread for ever; the end of a run must not depend on it.
        while !thread.is_finished() && ended.elapsed() < PATIENCE {
            thread::sleep(Duration::from_millis(1));
        }
        if thread.is_finished() {
            // The thread returns nothing, and a panic in it was reported.
            let _ = thread.join();
        }
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
                thread::yield_now();
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
}
