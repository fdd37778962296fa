//! The client's side of a session: a console or a script.

use std::{
    io::{self, Read as _, Write as _},
    os::unix::net::UnixStream,
    path::Path,
    thread,
    time::{Duration, Instant},
};

use crate::operator::{
    clock::{Estimate, RunTime},
    protocol::{self, ANSWER_LIMIT, Answer, Lines, Name, ProtocolError, TEXT},
};

/// Time between two keep-alive lines, well below the time after which a run ends motion by hand.
pub const ALIVE: Duration = Duration::from_millis(100);

/// Time limit for the answer to a load. The run answers when all boards have checked the block.
const LOAD_WAIT_LIMIT: Duration = Duration::from_secs(15);

#[derive(Debug, thiserror::Error)]
pub enum ClientError {
    #[error(
        "no operator can connect to the run: {0}; it must run on the 40 ms grid, with --operator owner, as the same user"
    )]
    Unreachable(#[source] io::Error),
    #[error("the connection to the run is lost: {0}")]
    Lost(#[from] io::Error),
    #[error("the run has ended the session")]
    Ended,
    #[error("the run has ended the session: {0}")]
    Refused(String),
    #[error(transparent)]
    Protocol(#[from] ProtocolError),
    #[error(
        "the run has not answered within {} s (a load: {} s): the request is void, unless it is a stop",
        ANSWER_LIMIT.as_secs(),
        LOAD_WAIT_LIMIT.as_secs()
    )]
    Silent,
    #[error("a line of 1 to {TEXT} printable bytes was expected, found {found}")]
    Line {
        found: usize, // bytes
    },
}

#[derive(Debug)]
pub struct Client {
    stream: UnixStream,
    lines: Lines,
    number: u32,
    run: String,
    name: String, // name of the session; empty before the greeting
    clock: Estimate,
}

impl Client {
    pub fn connect(path: &Path, name: &Name) -> Result<Self, ClientError> {
        Self::over(UnixStream::connect(path).map_err(ClientError::Unreachable)?, name)
    }

    /// Begins a session over a stream that is connected to the run.
    pub fn over(stream: UnixStream, name: &Name) -> Result<Self, ClientError> {
        stream.set_write_timeout(Some(ANSWER_LIMIT))?;
        let mut client = Self {
            stream,
            lines: Lines::default(),
            number: 0,
            run: String::new(),
            name: String::new(),
            clock: Estimate::new(RunTime::default(), Instant::now()),
        };
        // A run that refuses at once may already have closed the connection. Its reason can still be read.
        let sent = client.write(&format!("hello {name}\n"));
        let said = client.wait_for_line(Instant::now() + ANSWER_LIMIT);
        let line = said.map_err(|error| sent.err().unwrap_or(error))?;
        let Some(greeting) = protocol::greeting(&line) else {
            let Answer { verdict, .. } = protocol::answer(&line)?;
            return Err(ClientError::Refused(verdict.err().unwrap_or(line)));
        };
        client.clock = Estimate::new(greeting.time, Instant::now());
        (client.run, client.name) = (greeting.run, greeting.name.to_string());
        Ok(client)
    }

    #[must_use]
    pub fn run(&self) -> &str {
        &self.run
    }

    /// Name of the session, unique in the run: the requested name, with a number if it was taken.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Sends a request. Returns its number, which the answer repeats. The run executes it within [`ANSWER_LIMIT`] or
    /// discards it.
    pub fn send(&mut self, line: &str) -> Result<u32, ClientError> {
        self.send_within(ANSWER_LIMIT, line)
    }

    /// Like [`Client::send`], for a request that is discarded unless the run executes it within the time `left`.
    pub fn send_within(&mut self, left: Duration, line: &str) -> Result<u32, ClientError> {
        let line = line.trim();
        if line.is_empty() || line.len() > TEXT || line.chars().any(char::is_control) {
            return Err(ClientError::Line { found: line.len() });
        }
        self.number = self.number.wrapping_add(1);
        let RunTime(limit) = self.clock.at(Instant::now()).after(left);
        self.write(&format!("{} @{limit} {line}\n", self.number))?;
        Ok(self.number)
    }

    /// Sends an empty line, which shows that the operator is present. A session that commands motion by hand must send
    /// a line at least every [`SILENCE`](protocol::SILENCE).
    pub fn keep_alive(&mut self) -> Result<(), ClientError> {
        self.write("\n")
    }

    /// Stays connected for a time, and sends keep-alive lines.
    pub fn stay(&mut self, time: Duration) -> Result<(), ClientError> {
        let end = Instant::now() + time;
        while Instant::now() < end {
            self.keep_alive()?;
            thread::sleep(ALIVE.min(end.saturating_duration_since(Instant::now())));
        }
        Ok(())
    }

    /// Returns an answer if one has arrived, without waiting.
    pub fn poll(&mut self) -> Result<Option<Answer>, ClientError> {
        self.stream.set_nonblocking(true)?;
        let read = self.read();
        self.stream.set_nonblocking(false)?;
        match (self.lines.next_line()?, read) {
            (Some(line), _) => self.answer(&line).map(Some),
            (None, Ok(true)) => Ok(None),
            (None, Ok(false)) => Err(ClientError::Ended),
            (None, Err(error)) if error.kind() == io::ErrorKind::WouldBlock => Ok(None),
            (None, Err(error)) => Err(error.into()),
        }
    }

    /// Sends a request and waits for its answer. A refusal by the run is the inner result.
    pub fn ask(&mut self, line: &str) -> Result<Result<String, String>, ClientError> {
        self.ask_within(ANSWER_LIMIT, line)
    }

    /// Like [`Client::ask`], for a request that is discarded unless the run executes it within the time `left`.
    pub fn ask_within(&mut self, left: Duration, line: &str) -> Result<Result<String, String>, ClientError> {
        let number = self.send_within(left, line)?;
        let patience = if line.trim_start().starts_with("load ") { LOAD_WAIT_LIMIT } else { ANSWER_LIMIT };
        let deadline = Instant::now() + patience;
        loop {
            let line = self.wait_for_line(deadline)?;
            let answer = self.answer(&line)?;
            if answer.number == number {
                return Ok(answer.verdict);
            }
        }
    }

    fn answer(&mut self, line: &str) -> Result<Answer, ClientError> {
        match protocol::answer(line)? {
            Answer { number: 0, verdict: Err(why), .. } => Err(ClientError::Refused(why)),
            answer => {
                self.clock.hear(answer.time, Instant::now());
                Ok(answer)
            }
        }
    }

    fn write(&mut self, line: &str) -> Result<(), ClientError> {
        Ok(self.stream.write_all(line.as_bytes())?)
    }

    /// Reads the arrived bytes. Returns false at the end of the session.
    fn read(&mut self) -> io::Result<bool> {
        let mut bytes = [0; 512];
        let count = self.stream.read(&mut bytes)?;
        self.lines.push(bytes.get(..count).unwrap_or_default());
        Ok(count > 0)
    }

    fn wait_for_line(&mut self, deadline: Instant) -> Result<String, ClientError> {
        loop {
            if let Some(line) = self.lines.next_line()? {
                return Ok(line);
            }
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Err(ClientError::Silent);
            }
            self.stream.set_read_timeout(Some(left.min(ALIVE)))?;
            match self.read() {
                Ok(true) => {}
                Ok(false) => return Err(ClientError::Ended),
                Err(error) if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut) => {
                    // Before the greeting nothing is sent, because the first line must contain the name.
                    if !self.name.is_empty() {
                        let _ = self.keep_alive();
                    }
                }
                Err(error) => return Err(error.into()),
            }
        }
    }
}
