//! The controller's side of a Data System in another process.
//!
//! A thread of its own, which may wait: for the disk, and for the network. A command goes into the mailbox, and the status that
//! answers it comes back with the pulse of the same exchange, or of a later one. Updates are kept on the disk until they are answered
//! ([`Outbox`]). Those that an earlier run could not tell follow the next STARTUP, before Task learns that it is done: the data
//! base hears everything in the order in which it happened.

use std::{thread, time::Duration};

use super::{
    command::{self, DML, Transaction},
    outbox::Outbox,
    server::Answer,
    status::{Refusal, ServerStatus, Status, Summary},
};
use crate::{
    mailbox::{DATA_SYSTEM_COMMAND, DATA_SYSTEM_STATUS},
    network::{Desk, News, office::Presence},
};

/// Between two looks at a server that has not answered yet.
const PAUSE: Duration = Duration::from_millis(5);

/// The controller's side.
pub struct Agent {
    desk: Desk,
    outbox: Outbox,
    exchanges: u64,
}

impl Agent {
    /// Speaks at a desk, and keeps updates in an outbox.
    #[must_use]
    pub const fn new(desk: Desk, outbox: Outbox) -> Self {
        Self { desk, outbox, exchanges: 0 }
    }

    /// Between commands: see who is there. What there is to tell of it.
    pub fn idle(&mut self) -> Vec<News> {
        self.exchange();
        std::iter::from_fn(|| self.desk.news()).collect()
    }

    /// Have a command carried out; `None` if nobody answers.
    pub fn execute(&mut self, bytes: &[u8]) -> Option<Answer> {
        let command_id =
            command::decode(bytes).ok().map(|received| (received.command_id, received.transaction));
        let Some((id, transaction)) = command_id else { return self.ask(bytes) };
        match transaction {
            Transaction::Abort | Transaction::Initiate => self.ask(bytes),
            Transaction::Startup => {
                let answer = self.ask(bytes)?;
                if answer.status.summary != Summary::Done {
                    return Some(answer);
                }
                // What the server refuses of an earlier run is told, and does not keep this one from beginning.
                let told = self.tell_all(id)?;
                Some(Answer {
                    why: told
                        .filter(|told| told.status.summary != Summary::Done)
                        .map_or(String::new(), |told| told.why),
                    ..answer
                })
            }
            Transaction::Dml => {
                let kept = bytes.try_into().map_err(|_| "not 240 bytes".to_owned());
                let kept: Result<_, String> = kept
                    .and_then(|bytes: &[u8; DML]| self.outbox.keep(bytes).map_err(|error| error.to_string()));
                match kept {
                    Ok(_) => self.tell_all(id)?,
                    Err(why) => Some(refused(id, format!("the update cannot be kept: {why}"))),
                }
            }
        }
    }

    /// Tell all that is kept, the oldest first, each as an answer to the command `id`; the last answer, if there was anything to
    /// tell, or `None` if nobody answers.
    #[expect(clippy::option_option, reason = "nobody there is not nothing to tell")]
    fn tell_all(&mut self, id: u16) -> Option<Option<Answer>> {
        let pending = match self.outbox.pending() {
            Ok(pending) => pending,
            Err(error) => return Some(Some(refused(id, error.to_string()))),
        };
        let mut last = None;
        for kept in pending {
            let mut bytes = kept.command;
            command::number(&mut bytes, id, kept.number);
            let answer = self.ask(&bytes)?;
            match answer.status.summary {
                // It may be taken later.
                Summary::None | Summary::Refused(Refusal::Sequence | Refusal::Store) => {
                    return Some(Some(answer));
                }
                Summary::Done | Summary::Refused(_) => {
                    if let Err(error) = self.outbox.strike_out(kept.number) {
                        return Some(Some(refused(id, error.to_string())));
                    }
                }
            }
            last = Some(answer);
        }
        Some(last)
    }

    fn exchange(&mut self) -> Presence {
        self.exchanges += 1;
        self.desk.exchange(self.exchanges)
    }

    /// Write a command into the mailbox and wait for its status; `None` if nobody is there, or no longer.
    fn ask(&mut self, bytes: &[u8]) -> Option<Answer> {
        let id = u16::from_le_bytes([*bytes.get(6)?, *bytes.get(7)?]);
        self.desk.outgoing(DATA_SYSTEM_COMMAND).write(bytes).ok()?;
        let mut before = self.desk.incoming(DATA_SYSTEM_STATUS).mailgram();
        loop {
            let presence = self.exchange();
            if !presence.here {
                return None;
            }
            if presence.new {
                // Another server counts its mailgrams from the beginning.
                before = 0;
            }
            let mailbox = self.desk.incoming(DATA_SYSTEM_STATUS);
            if mailbox.mailgram() != before && mailbox.mailgram() != 0 {
                match Status::decode(mailbox.data()) {
                    Ok(status) if status.command_id == id && status.summary != Summary::None => {
                        return Some(Answer { status, why: String::new() });
                    }
                    Ok(_) => {}
                    Err(error) => return Some(refused(id, error.to_string())),
                }
            }
            thread::sleep(PAUSE);
        }
    }
}

/// What the controller itself cannot do for a command.
fn refused(command_id: u16, why: String) -> Answer {
    let summary = Summary::Refused(Refusal::Store);
    Answer { status: Status { command_id, server: ServerStatus::Idle, summary }, why }
}
