//! The controller's side of a Data System in another process.
//!
//! It runs on a separate thread, which may wait for the disk and the network. Updates are kept on the disk until they
//! are answered ([`Outbox`]). Pending updates of an earlier run follow the next STARTUP, before Task receives its
//! status, so that the database receives all updates in order.
//!
//! The agent numbers the commands itself, because updates sent after STARTUP have no number of Task:
//!
//! | command sent                             | command-id#     | status that answers it                              |
//! |------------------------------------------|-----------------|-----------------------------------------------------|
//! | another command                          | the next number | one with this number, written afterwards            |
//! | the same, because it has no answer yet   | the same        | one to any of its repetitions: they are one command |
//! | the same, because Task commands it again | the next number | one with this number: repeated answers are ignored  |
//!
//! A server without a valid status within the time limit is treated as silent: Task receives no answer, and repeats the
//! command (V.4.1).

use std::{
    fmt, thread,
    time::{Duration, Instant},
};

use neighbours::{
    data_system::{
        Answer,
        command::{self, DML, Transaction},
        status::{Refusal, ServerStatus, Status, StatusError, Summary},
    },
    fields::successor,
    mailbox::{DATA_SYSTEM_COMMAND, DATA_SYSTEM_STATUS, MailboxError},
};

use super::outbox::Outbox;
use crate::network::{Endpoint, NetEvent, Presence, StopHandle, clock::answer_limit};

const PAUSE: Duration = Duration::from_millis(5); // time between two checks for the server's answer

/// A remark about the Data System for the log.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Remark {
    Network(NetEvent),
    /// Its status cannot be read. This is reported once per sent command.
    Garbled(StatusError),
    /// It is connected, but does not answer.
    Silent {
        command_id: u16,
        patience: Duration,
    },
}

impl Remark {
    #[must_use]
    pub const fn code(&self) -> &'static str {
        match self {
            Self::Network(event) => event.code(),
            Self::Garbled(_) => "data-system.garbled",
            Self::Silent { .. } => "data-system.silent",
        }
    }
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Network(event) => event.fmt(f),
            Self::Garbled(why) => {
                write!(
                    f,
                    "{DATA_SYSTEM_STATUS} cannot be read, the Data System is treated as not answering: {why}"
                )
            }
            Self::Silent { command_id, patience } => write!(
                f,
                "the Data System has not answered command {command_id} for {} s",
                patience.as_secs_f64()
            ),
        }
    }
}

pub struct Agent {
    endpoint: Endpoint,
    outbox: Outbox,
    patience: Duration,
    exchanges: u64,
    command_id: u16, // command-id# of the last sent command; 0 before the first
    open: bool,      // true while the last command has no answer
    /// Number of the status in the mailbox when the command was first sent. It answers an earlier command.
    before: u16,
    remarks: Vec<Remark>,
}

impl Agent {
    /// An agent at an endpoint, with its outbox. It waits 10 s for an answer on the 40 ms grid, 60 s in fast clock.
    #[must_use]
    pub fn new(endpoint: Endpoint, outbox: Outbox) -> Self {
        let patience = answer_limit(endpoint.clock());
        Self {
            endpoint,
            outbox,
            patience,
            exchanges: 0,
            command_id: 0,
            open: false,
            before: 0,
            remarks: Vec::new(),
        }
    }

    #[must_use]
    pub const fn with_reply_limit(mut self, patience: Duration) -> Self {
        self.patience = patience;
        self
    }

    /// A handle with which another thread ends all waiting for the rest of the run. No answers follow.
    #[must_use]
    pub fn stop_handle(&self) -> StopHandle {
        self.endpoint.stop_handle()
    }

    pub fn remarks(&mut self) -> Vec<Remark> {
        std::mem::take(&mut self.remarks)
    }

    /// Checks whether a server is connected. Call it between commands.
    pub fn idle(&mut self) {
        self.exchange();
    }

    /// Execute a command; `None` if it is not answered. The answer has Task's number of the command.
    pub fn execute(&mut self, bytes: &[u8]) -> Option<Answer> {
        let (command_id, transaction) = match command::decode(bytes) {
            Ok(received) => (received.command_id, received.transaction),
            Err(error) => return Some(refused(error.to_string())),
        };
        let answer = match transaction {
            Transaction::Abort | Transaction::Initiate => self.ask(bytes)?,
            Transaction::Startup => self.start_up(bytes)?,
            Transaction::Dml => self.update(bytes)?,
        };
        Some(Answer { status: Status { command_id, ..answer.status }, ..answer })
    }

    fn start_up(&mut self, bytes: &[u8]) -> Option<Answer> {
        let answer = self.ask(bytes)?;
        if answer.status.summary != Summary::Done {
            return Some(answer);
        }
        // A refused update of an earlier run is reported, but does not prevent the start of this run.
        let told = self.send_all_updates()?;
        let why =
            told.filter(|told| told.status.summary != Summary::Done).map_or(String::new(), |told| told.why);
        Some(Answer { why, ..answer })
    }

    fn update(&mut self, bytes: &[u8]) -> Option<Answer> {
        let kept = bytes.try_into().map_err(|_| format!("{DML} bytes were expected, found {}", bytes.len()));
        let kept: Result<_, String> =
            kept.and_then(|bytes: &[u8; DML]| self.outbox.keep(bytes).map_err(|error| error.to_string()));
        match kept {
            Ok(_) => self.send_all_updates()?,
            Err(why) => Some(refused(why)),
        }
    }

    /// Send all stored updates, the oldest first; the last answer, if there were updates; `None` if one is not
    /// answered.
    #[expect(clippy::option_option, reason = "no answer differs from nothing to tell")]
    fn send_all_updates(&mut self) -> Option<Option<Answer>> {
        let pending = match self.outbox.pending() {
            Ok(pending) => pending,
            Err(error) => return Some(Some(refused(error.to_string()))),
        };
        let mut last = None;
        for kept in pending {
            let mut bytes = kept.command;
            command::number(&mut bytes, kept.number);
            let answer = self.ask(&bytes)?;
            match answer.status.summary {
                Summary::None | Summary::Refused(Refusal::Sequence | Refusal::Store) => {
                    return Some(Some(answer));
                }
                Summary::Done | Summary::Refused(_) => {
                    if let Err(error) = self.outbox.strike_out(kept.number) {
                        return Some(Some(refused(error.to_string())));
                    }
                }
            }
            last = Some(answer);
        }
        Some(last)
    }

    fn exchange(&mut self) -> Presence {
        self.exchanges += 1;
        let presence = self.endpoint.exchange(self.exchanges);
        if presence.new {
            // Another server numbers its mailgrams from the beginning.
            self.before = 0;
        }
        self.remarks.extend(std::iter::from_fn(|| self.endpoint.event()).map(Remark::Network));
        presence
    }

    /// Send a command and wait for its status. `None` without a Data System or an answer, or if the run is to end.
    fn ask(&mut self, bytes: &[u8]) -> Option<Answer> {
        if let Err(error) = self.send(bytes) {
            return Some(refused(error.to_string()));
        }
        let (sent, mut garbled) = (Instant::now(), false);
        loop {
            if !self.exchange().connected {
                return None;
            }
            match self.written() {
                Some(Ok(status))
                    if status.command_id == self.command_id && status.summary != Summary::None =>
                {
                    self.open = false;
                    return Some(Answer { status, why: String::new() });
                }
                Some(Err(why)) if !garbled => {
                    garbled = true;
                    self.remarks.push(Remark::Garbled(why));
                }
                _ => {}
            }
            if self.endpoint.is_interrupted() {
                return None;
            }
            if sent.elapsed() >= self.patience {
                let (command_id, patience) = (self.command_id, self.patience);
                self.remarks.push(Remark::Silent { command_id, patience });
                return None;
            }
            thread::sleep(PAUSE);
        }
    }

    /// Write a command to the mailbox, with the next number. A repetition of an unanswered command keeps its number.
    fn send(&mut self, bytes: &[u8]) -> Result<(), MailboxError> {
        let mut bytes = bytes.to_vec();
        command::identify(&mut bytes, self.command_id);
        if !self.open || self.endpoint.outgoing(DATA_SYSTEM_COMMAND).data() != bytes {
            self.command_id = successor(self.command_id);
            command::identify(&mut bytes, self.command_id);
            self.before = self.endpoint.incoming(DATA_SYSTEM_STATUS).mailgram();
        }
        self.endpoint.outgoing(DATA_SYSTEM_COMMAND).write(&bytes)?;
        self.open = true;
        Ok(())
    }

    /// The status written since the command was sent.
    fn written(&self) -> Option<Result<Status, StatusError>> {
        let mailbox = self.endpoint.incoming(DATA_SYSTEM_STATUS);
        let fresh = mailbox.mailgram() != 0 && mailbox.mailgram() != self.before;
        fresh.then(|| Status::decode(mailbox.data()))
    }
}

fn refused(why: String) -> Answer {
    let summary = Summary::Refused(Refusal::Store);
    Answer { status: Status { command_id: 0, server: ServerStatus::Idle, summary }, why }
}

#[cfg(test)]
mod tests;
