//! The thread of a client: reads its messages, and sends the queued ones.
//!
//! A client stays connected as long as it reads, however slowly. Evidence of reading is an answer to a ping,
//! any other message, or a successful write after a blocked one.

use std::{
    io::{self, ErrorKind},
    sync::Arc,
    thread,
    time::{Duration, Instant},
};

use crate::operator::{ALIVE, Client as Operator, ClientError, Name};
use tungstenite::{
    Error, Message, WebSocket,
    error::CapacityError,
    protocol::{CloseFrame, frame::coding::CloseCode},
};

use crate::live::{
    commands::Access,
    connection::Connection,
    feed::{Feed, Queue},
    options::{Notices, Options},
    outgoing::Outgoing,
    protocol::{self, StatusLevel},
    session::{Action, Requests, Rights, Session},
    silence::Silence,
};

const IDLE: Duration = Duration::from_millis(10); // sleep of an idle thread: a quarter of a tick
/// Interval between pings. The answer limits the age of the client's next messages.
const PING: Duration = Duration::from_millis(500);
/// Interval between pings of a client that operates the run. Its answers show that the operator is present.
const PING_OPERATOR: Duration = ALIVE;
/// Greatest age of a request. The sender of an older request no longer waits, or its connection is stalled.
const REQUEST_AGE: Duration = Duration::from_secs(2);
const CLOSING_LIMIT: Duration = Duration::from_millis(500);
/// Time after a disconnection during which the client can still read its reason, while the feed continues.
const LATE_READER: Duration = Duration::from_secs(30);
/// Interval between reports of the number of dropped messages.
const COUNT: Duration = Duration::from_secs(5);
const READS: usize = 16; // greatest number of a client's messages read before messages are written
const WRITES: usize = 512; // greatest number of items written before messages of the client are read

#[derive(Debug)]
enum End {
    Gone,
    Silent(Duration),        // the client has not read for this time
    Told(CloseCode, String), // the server closes the session with a code and a reason
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

pub struct Client {
    socket: WebSocket<Connection>,
    feed: Feed,
    queue: Arc<Queue>,
    outgoing: Outgoing,
    session: Session,
    access: Option<Access>,
    operator: Option<Operator>, // the operator session with the run; `None` before the first request
    name: Name,
    /// Limit of the time without reading, after which the client is disconnected, and the present time without reading.
    patience: Duration,
    silence: Silence,
    notices: Option<Notices>, // receives the reason when the server disconnects the client
    began: Instant,
    /// Number and time of the last ping. The number is the time of the ping, ms since the session began.
    ping: (u64, Instant),
    pong: (u64, Instant), // number of the last answered ping, and the time of its answer
    dropped: (u64, Instant), // number of dropped messages last sent to the client, and the time of sending
}

impl Client {
    pub fn new(
        socket: WebSocket<Connection>,
        feed: Feed,
        queue: Arc<Queue>,
        options: &Options,
        name: Name,
        requests: Requests,
    ) -> Self {
        let now = Instant::now();
        let Options { knob, access, patience, notices, .. } = options;
        let access = access.as_ref().filter(|_| requests.are_offered());
        Self {
            socket,
            feed,
            queue,
            outgoing: Outgoing::default(),
            session: Session::new(Rights { knob: knob.clone(), requests, name: name.to_string() }),
            access: access.cloned(),
            operator: None,
            name,
            patience: *patience,
            silence: Silence::new(now),
            notices: notices.clone(),
            began: now,
            ping: (0, now),
            pong: (0, now),
            dropped: (0, now),
        }
    }

    /// Serves the client until it disconnects or the feed is over. `first` holds its first messages.
    pub fn run(mut self, mut first: Vec<String>) {
        first.extend(self.session.services());
        let (code, reason, limit) = match self.serve(first) {
            Ok(()) | Err(End::Gone) => return,
            Err(End::Told(code, reason)) => (code, reason, CLOSING_LIMIT),
            Err(End::Silent(time)) => {
                let reason = format!("the viewer has read nothing for {:.1} s", time.as_secs_f32());
                (CloseCode::Policy, reason, LATE_READER)
            }
        };
        if code != CloseCode::Away
            && let Some(notices) = &self.notices
        {
            // Without a receiver the notices are not needed.
            let _ = notices.send(format!("{} is disconnected: {reason}", self.name));
        }
        self.close(code, reason, limit);
    }

    fn serve(&mut self, first: Vec<String>) -> Result<(), End> {
        self.socket.get_mut().never_wait()?;
        first.into_iter().for_each(|text| self.outgoing.reply(Message::text(text)));
        loop {
            // A client with blocked output may still have answered a ping.
            let has_read = self.outgoing.takes_replies() && self.listen()?;
            let is_busy = self.flush()? && self.speak()?;
            self.look_after()?;
            if self.queue.is_over() && self.outgoing.is_empty() && self.flush()? {
                return Err(End::Told(CloseCode::Away, "there are no more messages".to_owned()));
            }
            if !has_read && !is_busy {
                thread::sleep(IDLE);
            }
        }
    }

    /// Reads messages of the client; returns true if more may be waiting.
    fn listen(&mut self) -> Result<bool, End> {
        for _ in 0..READS {
            let message = match self.socket.read() {
                Ok(message) => message,
                Err(Error::Io(error)) if error.kind() == ErrorKind::WouldBlock => return Ok(false),
                Err(error) => return Err(error.into()),
            };
            self.silence.end();
            let actions = match message {
                Message::Text(text) => self.session.text(&text, |channel| self.feed.has(channel)),
                Message::Binary(bytes) => self.session.binary(&bytes),
                Message::Pong(number) => {
                    self.answered(&number);
                    continue;
                }
                _ => continue,
            };
            for action in actions {
                self.act(action)?;
            }
            // Send the answers before reading more requests, so that they do not accumulate.
            if !self.outgoing.takes_replies() {
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn act(&mut self, action: Action) -> Result<(), End> {
        match action {
            Action::Text(text) => self.outgoing.reply(Message::text(text)),
            Action::Subscribe { channel, subscription, past_s } => {
                self.feed.subscribe(&self.queue, channel, subscription, past_s);
            }
            Action::Unsubscribe { channel } => self.queue.unsubscribe(channel),
            Action::Bytes(bytes) => self.outgoing.reply(Message::binary(bytes)),
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

    /// The run answers between two ticks. The request is at most as old as the last ping that the client has answered.
    fn ask(&mut self, line: &str) -> Result<String, String> {
        let access = self.access.as_ref().ok_or("this run accepts no requests")?;
        let mut operator = match self.operator.take() {
            Some(operator) => operator,
            None => Operator::connect(&access.socket, &self.name).map_err(|error| error.to_string())?,
        };
        let answered = Duration::from_millis(self.pong.0);
        let age = self.began.elapsed().saturating_sub(answered);
        let answer = operator.ask_within(REQUEST_AGE.saturating_sub(age), line);
        // After any other error the session has ended, and the next request begins a new one.
        if matches!(answer, Ok(_) | Err(ClientError::Line { .. } | ClientError::Silent)) {
            self.operator = Some(operator);
        }
        answer.map_err(|error| error.to_string())?
    }

    /// Sends replies and queued items to the client; returns true if more may be waiting.
    fn speak(&mut self) -> Result<bool, End> {
        for _ in 0..WRITES {
            if self.outgoing.is_ping_due() && !self.check_reading()? {
                return Ok(false);
            }
            let Some(message) = self.outgoing.next(&self.queue) else {
                self.flush()?;
                return Ok(false);
            };
            if !self.write(message)? {
                return Ok(false);
            }
        }
        self.flush()
    }

    /// Sends a ping. Returns false if the write would block.
    fn check_reading(&mut self) -> Result<bool, End> {
        self.outgoing.pinged();
        let number = u64::try_from(self.began.elapsed().as_millis()).unwrap_or(u64::MAX);
        self.ping = (number, Instant::now());
        self.write(Message::Ping(number.to_le_bytes().to_vec().into()))
    }

    /// Checks that the client still reads, and sends it the number of dropped messages.
    fn look_after(&mut self) -> Result<(), End> {
        if self.socket.get_mut().has_drained() {
            self.silence.end();
        }
        let silent = self.silence.length(Instant::now());
        if silent > self.patience {
            return Err(End::Silent(silent));
        }
        let interval = if self.operator.is_some() { PING_OPERATOR } else { PING.min(self.patience / 4) };
        if self.ping.1.elapsed() > interval && self.flush()? {
            self.check_reading()?;
        }
        if !self.outgoing.takes_replies() {
            return Ok(());
        }
        if let Some(text) = self.session.knob() {
            self.outgoing.reply(Message::text(text));
        }
        let dropped = self.queue.dropped();
        if dropped > self.dropped.0 && self.dropped.1.elapsed() > COUNT {
            let text = format!("messages left out so far: {dropped}; the viewer reads them too slowly");
            self.dropped = (dropped, Instant::now());
            self.outgoing.reply(Message::text(protocol::status(
                StatusLevel::Warning,
                &text,
                Some("left-out"),
            )));
        }
        Ok(())
    }

    /// Records the answer to a ping, which shows that the client has read everything before it.
    fn answered(&mut self, number: &[u8]) {
        let number = number.try_into().map_or(0, u64::from_le_bytes);
        if (self.pong.0..=self.ping.0).contains(&number) && number != self.pong.0 {
            self.pong = (number, Instant::now());
            if let Some(operator) = &mut self.operator {
                // The next request detects the end of the session.
                let _ = operator.keep_alive();
            }
        }
    }

    /// Writes a message. Returns false if the write would block.
    fn write(&mut self, message: Message) -> Result<bool, End> {
        taken(self.socket.write(message))
    }

    fn flush(&mut self) -> Result<bool, End> {
        taken(self.socket.flush())
    }

    /// Closes the session with a reason, and waits for at most `limit` until the client has read it.
    fn close(mut self, code: CloseCode, reason: String, limit: Duration) {
        // A reason has at most 123 bytes (RFC 6455, 5.5).
        let mut reason = reason;
        while reason.len() > 123 {
            reason.pop();
        }
        // It receives no more messages.
        self.feed.leave(&self.queue);
        let (now, soon) = (Instant::now(), Instant::now() + CLOSING_LIMIT);
        let until = now + limit;
        let _ = self.socket.close(Some(CloseFrame { code, reason: reason.into() }));
        while Instant::now() < if self.feed.is_over() { soon } else { until } {
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

/// Returns false if the write would block; the message is then kept.
fn taken(written: tungstenite::Result<()>) -> Result<bool, End> {
    match written {
        Ok(()) => Ok(true),
        Err(Error::Io(error)) if error.kind() == ErrorKind::WouldBlock => Ok(false),
        Err(error) => Err(error.into()),
    }
}
