//! The session of an operator with a run: sends requests, receives answers, and keeps the session alive.

use std::time::{Duration, Instant};

use executive::memory::{RunName, operator_socket};
use sessions::operator::{Client, ClientError, Name};

use crate::rcs_console::model::Operating;

/// Time between two status requests, which also keep the session alive.
const ASK: Duration = Duration::from_millis(100);

pub struct Hand {
    client: Client,
    asked: Option<Instant>,
    data: Option<u32>, // number of the request for the directory of the task data
}

impl Hand {
    pub fn reach(run: &RunName) -> Result<Self, ClientError> {
        let name = format!("console-{}", std::process::id());
        let name: Name = name.parse().map_err(sessions::operator::protocol::ProtocolError::from)?;
        Ok(Self { client: Client::connect(&operator_socket(run), &name)?, asked: None, data: None })
    }

    pub fn work(&mut self, operating: &mut Operating, is_over: bool) {
        if operating.lost.is_some() {
            return;
        }
        if let Err(error) = self.exchange(operating) {
            let ended = "the run has ended: it takes no more requests".to_owned();
            operating.lost = Some(if is_over { ended } else { error.to_string() });
            operating.outbox.clear();
        }
    }

    fn exchange(&mut self, operating: &mut Operating) -> Result<(), ClientError> {
        for line in std::mem::take(&mut operating.outbox) {
            match self.client.send(&line) {
                Ok(number) => operating.sent(number, line),
                Err(error @ ClientError::Line { .. }) => {
                    operating.sent(0, line);
                    operating.answered(0, Err(error.to_string()));
                }
                Err(error) => return Err(error),
            }
        }
        if self.data.is_none() {
            self.data = Some(self.client.send("data")?);
        }
        if self.asked.is_none_or(|asked| asked.elapsed() >= ASK) {
            self.client.send("status")?;
            self.asked = Some(Instant::now());
        }
        while let Some(answer) = self.client.poll()? {
            if Some(answer.number) == self.data {
                let said = answer.verdict.ok();
                operating.directory = said.and_then(|said| Some(said.split_once(": ")?.1.to_owned()));
            } else {
                operating.answered(answer.number, answer.verdict);
            }
        }
        Ok(())
    }
}
