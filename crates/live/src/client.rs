//! The thread of a client: reads its messages, and sends the queued ones.

use std::{
    io::{self, ErrorKind, Read, Write},
    net::TcpStream,
    sync::Arc,
    thread,
    time::{Duration, Instant},
};

use operator::{ALIVE, Client as Operator, ClientError, Name};
use tungstenite::{
    Error, Message, WebSocket,
    error::CapacityError,
    protocol::{CloseFrame, frame::coding::CloseCode},
};

use crate::{
    commands::Access,
    feed::{Feed, Item, Queue},
    protocol::{self, StatusLevel},
    server::Options,
    session::{Action, Rights, Session},
};

/// Sleep of a thread with nothing to do: a quarter of a tick.
const IDLE: Duration = Duration::from_millis(10);
/// Interval between pings. The answer shows how old the next messages of the client can be.
const PING: Duration = Duration::from_millis(500);
/// Interval between pings of a client that operates the run: its answers are the operator's signs of life.
const PING_OPERATOR: Duration = ALIVE;
/// Greatest age of a request: its sender then no longer waits, or its way is stalled.
const REQUEST_AGE: Duration = Duration::from_secs(2);
/// Time limit for closing a connection.
const CLOSING_LIMIT: Duration = Duration::from_millis(500);
/// Interval between reports of the number of dropped messages.
const COUNT: Duration = Duration::from_secs(5);
/// Greatest number of a client's messages read before messages are written.
const READS: usize = 16;
/// Greatest number of items written before messages of the client are read.
const WRITES: usize = 512;

/// A connection. During the handshake, reads wait up to a time limit and then fail; afterwards they never wait.
pub struct Connection {
    stream: TcpStream,
    until: Option<Instant>,
}

impl Connection {
    /// A connection with a time limit for its handshake.
    pub fn new(stream: TcpStream, handshake: Duration) -> io::Result<Self> {
        stream.set_nodelay(true)?;
        stream.set_write_timeout(Some(handshake))?;
        Ok(Self { stream, until: Some(Instant::now() + handshake) })
    }

    fn never_wait(&mut self) -> io::Result<()> {
        self.until = None;
        self.stream.set_nonblocking(true)
    }
}

impl Read for Connection {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if let Some(until) = self.until {
            let left = until.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Err(ErrorKind::TimedOut.into());
            }
            self.stream.set_read_timeout(Some(left))?;
        }
        self.stream.read(buffer)
    }
}

impl Write for Connection {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.stream.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.stream.flush()
    }
}

/// Why a session ends.
#[derive(Debug)]
enum End {
    /// The client has disconnected, or it reads nothing.
    Gone,
    /// The server closes the session with a code and a reason.
    Told(CloseCode, String),
}

impl From<io::Error> for End {
    fn from(_: io::Error) -> Self {
        Self::Gone
    }
}

impl From<Error> for End {
    fn from(error: Error) -> Self {
        let code = match &error {
            Error::Capacity(CapacityError::MessageTooLong { .. }) => CloseCode::Size,
            Error::Utf8(_) => CloseCode::Invalid,
            Error::Protocol(_) => CloseCode::Protocol,
            _ => return Self::Gone,
        };
        Self::Told(code, error.to_string())
    }
}

/// A client after its handshake.
pub struct Client {
    socket: WebSocket<Connection>,
    feed: Feed,
    queue: Arc<Queue>,
    session: Session,
    /// Access to the run for requests.
    access: Option<Access>,
    /// The operator session with the run; `None` before the first request.
    operator: Option<Operator>,
    /// Name of the operator session.
    name: Name,
    /// Time after which a client that reads nothing is disconnected.
    patience: Duration,
    /// Time at which the session began.
    began: Instant,
    /// Number and time of the last ping. The number is the time of the ping, ms since the session began.
    ping: (u64, Instant),
    /// Number of the last answered ping, and the time of its answer.
    pong: (u64, Instant),
    /// Number of dropped messages that was last sent to the client, and the time of sending.
    dropped: (u64, Instant),
}

impl Client {
    pub fn new(
        socket: WebSocket<Connection>,
        feed: Feed,
        queue: Arc<Queue>,
        options: &Options,
        name: Name,
    ) -> Self {
        let now = Instant::now();
        let Options { knob, access, patience, .. } = options;
        let token = access.as_ref().map(|access| access.token.clone());
        Self {
            socket,
            feed,
            queue,
            session: Session::new(Rights { knob: knob.clone(), token }),
            access: access.clone(),
            operator: None,
            name,
            patience: *patience,
            began: now,
            ping: (0, now),
            pong: (0, now),
            dropped: (0, now),
        }
    }

    /// Serves the client until it disconnects or the feed is over. `first` holds the first messages to send.
    pub fn run(mut self, mut first: Vec<String>) {
        first.extend(self.session.services());
        if let Err(End::Told(code, reason)) = self.serve(first) {
            self.close(code, reason);
        }
    }

    fn serve(&mut self, first: Vec<String>) -> Result<(), End> {
        self.socket.get_mut().never_wait()?;
        for text in first {
            self.write(Message::text(text))?;
        }
        loop {
            let is_busy = self.flush()? && (self.listen()? | self.speak()?);
            self.look_after()?;
            if self.queue.is_over() && self.flush()? {
                return Err(End::Told(CloseCode::Away, "there are no more messages".to_owned()));
            }
            if !is_busy {
                thread::sleep(IDLE);
            }
        }
    }

    /// Reads messages of the client; returns true if more may be waiting.
    fn listen(&mut self) -> Result<bool, End> {
        for _ in 0..READS {
            let actions = match self.socket.read() {
                Ok(Message::Text(text)) => self.session.text(&text, |channel| self.feed.has(channel)),
                Ok(Message::Binary(bytes)) => self.session.binary(&bytes),
                Ok(Message::Pong(number)) => {
                    self.answered(&number);
                    continue;
                }
                Ok(_) => continue,
                Err(Error::Io(error)) if error.kind() == ErrorKind::WouldBlock => return Ok(false),
                Err(error) => return Err(error.into()),
            };
            for action in actions {
                self.act(action)?;
            }
        }
        // Send the answers before more requests are read, so that they do not accumulate.
        self.flush()
    }

    fn act(&mut self, action: Action) -> Result<(), End> {
        match action {
            Action::Text(text) => {
                self.write(Message::text(text))?;
            }
            Action::Subscribe { channel, subscription } => {
                self.feed.subscribe(&self.queue, channel, subscription);
            }
            Action::Unsubscribe { channel } => self.queue.unsubscribe(channel),
            Action::Bytes(bytes) => {
                self.write(Message::binary(bytes))?;
            }
            Action::Ask { line, reply } => {
                let verdict = self.ask(&line);
                for action in self.session.answered(reply, verdict) {
                    self.act(action)?;
                }
            }
            Action::Close(reason) => return Err(End::Told(CloseCode::Policy, reason)),
        }
        Ok(())
    }

    /// Sends a request to the run as an operator, and waits for the answer, which the run gives between two ticks. The
    /// client has sent the request after the last ping that it has answered: so old can it be.
    fn ask(&mut self, line: &str) -> Result<String, String> {
        let access = self.access.as_ref().ok_or("this run accepts no requests")?;
        let mut operator = match self.operator.take() {
            Some(operator) => operator,
            None => Operator::connect(&access.socket, &self.name).map_err(|error| error.to_string())?,
        };
        let answered = Duration::from_millis(self.pong.0);
        let age = self.began.elapsed().saturating_sub(answered);
        let answer = operator.ask_within(REQUEST_AGE.saturating_sub(age), line);
        // After any other error the session has ended: the next request begins a new one.
        if matches!(answer, Ok(_) | Err(ClientError::Line { .. } | ClientError::Silent)) {
            self.operator = Some(operator);
        }
        answer.map_err(|error| error.to_string())?
    }

    /// Sends queued items to the client; returns true if more may be waiting.
    fn speak(&mut self) -> Result<bool, End> {
        for _ in 0..WRITES {
            let Some(item) = self.queue.pop() else {
                self.flush()?;
                return Ok(false);
            };
            let message = match item {
                Item::Text(text) => Message::text(text.as_ref()),
                Item::Time(time) => Message::binary(protocol::time(time)),
                Item::Message { subscription, time, data } => {
                    Message::binary(protocol::message(subscription, time, &data))
                }
            };
            if !self.write(message)? {
                return Ok(false);
            }
        }
        self.flush()
    }

    /// Checks that the client still answers pings, and sends it the number of dropped messages.
    fn look_after(&mut self) -> Result<(), End> {
        if self.pong.1.elapsed() > self.patience {
            return Err(End::Gone);
        }
        let interval = if self.operator.is_some() { PING_OPERATOR } else { PING.min(self.patience / 4) };
        if self.ping.1.elapsed() > interval && self.flush()? {
            let number = u64::try_from(self.began.elapsed().as_millis()).unwrap_or(u64::MAX);
            self.ping = (number, Instant::now());
            self.write(Message::Ping(self.ping.0.to_le_bytes().to_vec().into()))?;
        }
        if let Some(text) = self.session.knob() {
            self.write(Message::text(text))?;
        }
        let dropped = self.queue.dropped();
        if dropped > self.dropped.0 && self.dropped.1.elapsed() > COUNT && self.flush()? {
            let text = format!("{dropped} messages are left out so far: the viewer reads them too slowly");
            self.dropped = (dropped, Instant::now());
            self.write(Message::text(protocol::status(StatusLevel::Warning, &text, Some("left-out"))))?;
        }
        Ok(())
    }

    /// Records the answer to a ping: the client has read everything up to it.
    fn answered(&mut self, number: &[u8]) {
        let number = number.try_into().map_or(0, u64::from_le_bytes);
        if (self.pong.0..=self.ping.0).contains(&number) && number != self.pong.0 {
            self.pong = (number, Instant::now());
            if let Some(operator) = &mut self.operator {
                // The next request finds out if the session has ended.
                let _ = operator.keep_alive();
            }
        }
    }

    /// Writes a message; returns false if the client does not take it at once.
    fn write(&mut self, message: Message) -> Result<bool, End> {
        taken(self.socket.write(message))
    }

    /// Flushes; returns true if the client has taken everything.
    fn flush(&mut self) -> Result<bool, End> {
        taken(self.socket.flush())
    }

    /// Closes the session with a reason, and waits briefly until the client has read it.
    fn close(mut self, code: CloseCode, reason: String) {
        // A reason has at most 123 bytes (RFC 6455, 5.5).
        let mut reason = reason;
        while reason.len() > 123 {
            reason.pop();
        }
        let until = Instant::now() + CLOSING_LIMIT;
        let _ = self.socket.close(Some(CloseFrame { code, reason: reason.into() }));
        while Instant::now() < until {
            let _ = self.socket.flush();
            match self.socket.read() {
                Ok(_) => {}
                Err(Error::Io(error)) if error.kind() == ErrorKind::WouldBlock => thread::sleep(IDLE),
                Err(_) => return,
            }
        }
    }
}

impl Drop for Client {
    fn drop(&mut self) {
        self.feed.leave(&self.queue);
    }
}

/// Returns false if the write would block; the message is kept.
fn taken(written: tungstenite::Result<()>) -> Result<bool, End> {
    match written {
        Ok(()) => Ok(true),
        Err(Error::Io(error)) if error.kind() == ErrorKind::WouldBlock => Ok(false),
        Err(error) => Err(error.into()),
    }
}
