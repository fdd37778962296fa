//! The side of a console or a script.

use std::{
    any::Any,
    io::{self, Read as _, Write as _},
    os::unix::net::UnixStream,
    path::Path,
    time::{Duration, Instant},
};

use crate::protocol::{self, Answer, GREETING, LINE, Lines, Name, ProtocolError};

/// A run answers between two ticks; a second is 25 of them.
const PATIENCE: Duration = Duration::from_secs(1);

/// Why a run cannot be reached, or a request cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum ClientError {
    /// The run does not let operators connect.
    #[error(
        "no operator can connect to the run: {0}; it must run on the 40 ms grid, with --operator owner, as the same user"
    )]
    Unreachable(#[source] io::Error),
    /// The connection is lost.
    #[error("the connection to the run is lost: {0}")]
    Lost(#[from] io::Error),
    /// The run has ended the session.
    #[error("the run has ended the session")]
    Ended,
    /// The run has ended the session, and says why.
    #[error("the run has ended the session: {0}")]
    Refused(String),
    /// The answer is not from a run.
    #[error(transparent)]
    Protocol(#[from] ProtocolError),
    /// The run does not answer.
    #[error("the run has not answered within {} s", PATIENCE.as_secs())]
    Silent,
    /// A line that cannot be sent.
    #[error("a line of 1 to {} printable bytes was expected, found {found}", LINE - 11)]
    Line {
        /// Bytes of the line.
        found: usize,
    },
}

/// A session with a run.
#[derive(Debug)]
pub struct Client {
    stream: UnixStream,
    lines: Lines,
    number: u32,
    run: String,
    /// What carries the stream to another machine: it ends after it.
    _carrier: Option<Box<dyn Any + Send>>,
}

impl Client {
    /// Begin a session under a name.
    ///
    /// # Errors
    /// [`ClientError`].
    pub fn connect(path: &Path, name: &Name) -> Result<Self, ClientError> {
        Self::begin(UnixStream::connect(path).map_err(ClientError::Unreachable)?, None, name)
    }

    /// Begin a session over a stream to a run elsewhere, and keep what carries it until the session is over.
    ///
    /// # Errors
    /// [`ClientError`].
    pub fn over(stream: UnixStream, carrier: impl Any + Send, name: &Name) -> Result<Self, ClientError> {
        Self::begin(stream, Some(Box::new(carrier)), name)
    }

    fn begin(
        stream: UnixStream,
        carrier: Option<Box<dyn Any + Send>>,
        name: &Name,
    ) -> Result<Self, ClientError> {
        stream.set_write_timeout(Some(PATIENCE))?;
        let mut client =
            Self { stream, lines: Lines::default(), number: 0, run: String::new(), _carrier: carrier };
        // A run that refuses at once may have closed the connection by now; what it has said can still be read.
        let sent = client.write(&format!("hello {name}\n"));
        let said = client.wait_for_line(Instant::now() + PATIENCE);
        let greeting = said.map_err(|error| sent.err().unwrap_or(error))?;
        match greeting.strip_prefix(GREETING) {
            Some(run) => client.run = run.trim().to_owned(),
            None => {
                let Answer { verdict, .. } = protocol::answer(&greeting)?;
                return Err(ClientError::Refused(verdict.err().unwrap_or(greeting)));
            }
        }
        Ok(client)
    }

    /// Name of the run.
    #[must_use]
    pub fn run(&self) -> &str {
        &self.run
    }

    /// Send a request; its number comes back with the answer.
    ///
    /// # Errors
    /// [`ClientError`].
    pub fn send(&mut self, line: &str) -> Result<u32, ClientError> {
        let line = line.trim();
        // Ten digits and a blank stand before it.
        if line.is_empty() || line.len() > LINE - 11 || line.chars().any(char::is_control) {
            return Err(ClientError::Line { found: line.len() });
        }
        self.number = self.number.wrapping_add(1);
        self.write(&format!("{} {line}\n", self.number))?;
        Ok(self.number)
    }

    /// Say that the operator is still there.
    ///
    /// # Errors
    /// [`ClientError`].
    pub fn keep_alive(&mut self) -> Result<(), ClientError> {
        self.write("\n")
    }

    /// An answer, if one has come.
    ///
    /// # Errors
    /// [`ClientError`]; a run that has ended is one.
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

    /// Send a request and wait for its answer.
    ///
    /// # Errors
    /// [`ClientError`]. That the run refuses the request is no error here.
    pub fn ask(&mut self, line: &str) -> Result<Result<String, String>, ClientError> {
        let number = self.send(line)?;
        let deadline = Instant::now() + PATIENCE;
        loop {
            let line = self.wait_for_line(deadline)?;
            let answer = self.answer(&line)?;
            if answer.number == number {
                return Ok(answer.verdict);
            }
        }
    }

    fn answer(&self, line: &str) -> Result<Answer, ClientError> {
        match protocol::answer(line)? {
            // Requests are counted from 1.
            Answer { number: 0, verdict: Err(why) } => Err(ClientError::Refused(why)),
            answer => Ok(answer),
        }
    }

    fn write(&mut self, line: &str) -> Result<(), ClientError> {
        Ok(self.stream.write_all(line.as_bytes())?)
    }

    /// Read what has arrived; false at the end of the session.
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
            self.stream.set_read_timeout(Some(left))?;
            match self.read() {
                Ok(true) => {}
                Ok(false) => return Err(ClientError::Ended),
                Err(error) if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut) => {
                }
                Err(error) => return Err(error.into()),
            }
        }
    }
}
