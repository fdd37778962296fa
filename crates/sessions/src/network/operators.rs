//! Operators over the network (IV): a role of its own, whose connections carry lines in the place of mailboxes.
//!
//! ```text
//!   Peer -- stream -- carry -- TLS -- carry -- stream -- the run's sessions of operators
//! ```
//!
//! The hello and the certificate are those of a neighbour with the role [`Role::Operator`](super::Role). Behind the
//! welcome come the bytes of a session with the run, as they are: what they mean is the run's to say.

use std::{
    io::{self, Write as _},
    os::{fd::AsFd as _, unix::net::UnixStream},
    sync::{Arc, OnceLock, mpsc::Sender},
    thread::JoinHandle,
    time::{Duration, Instant},
};

use rustix::{
    io::Errno,
    net::{RecvFlags, recv},
};

use super::{Disconnect, NetEvent, channel::Channel};

/// Time limit of silence: an operator that sends nothing for this time is disconnected, so that another one can
/// command.
pub(super) const SILENCE: Duration = Duration::from_secs(10);
/// Time limit for a write to a stream whose reader does not read.
const UNREAD: Duration = Duration::from_secs(1);
/// Bytes that are read at once.
const CHUNK: usize = 4096;

/// Begins a session with the run and returns its other end.
type Enter = Box<dyn Fn() -> io::Result<UnixStream> + Send + Sync>;

/// How operators of a network reach a run.
#[derive(Clone)]
pub struct Operators {
    enter: Arc<OnceLock<Enter>>,
    events: Sender<NetEvent>,
}

impl Operators {
    /// Creates the access for operators, who are refused until the run is [open](Self::open).
    #[must_use]
    pub fn new(events: Sender<NetEvent>) -> Self {
        Self { enter: Arc::default(), events }
    }

    /// Admits operators from now on. Only the first call has an effect.
    pub fn open(&self, enter: impl Fn() -> io::Result<UnixStream> + Send + Sync + 'static) {
        // A run is opened once.
        let _ = self.enter.set(Box::new(enter));
    }

    /// Begin a session.
    pub(super) fn enter(&self) -> io::Result<UnixStream> {
        let enter = self.enter.get();
        enter.ok_or_else(|| io::Error::other("the run has not begun: connect again when it has"))?()
    }

    /// Sends an event to the run.
    pub(super) fn tell(&self, event: NetEvent) {
        // A run that has ended does not receive it.
        let _ = self.events.send(event);
    }
}

/// Carries the stream of an operator; dropping it waits until the last byte is sent.
#[derive(Debug)]
pub struct Carrier {
    thread: Option<JoinHandle<()>>,
}

impl Carrier {
    pub(super) const fn of(thread: JoinHandle<()>) -> Self {
        Self { thread: Some(thread) }
    }
}

impl Drop for Carrier {
    fn drop(&mut self) {
        if let Some(thread) = self.thread.take() {
            // The thread returns nothing, and a panic in it was reported.
            let _ = thread.join();
        }
    }
}

/// Carries bytes between a connection and a stream until one of them ends, and returns the reason. `unread` are bytes
/// already received. The connection also ends if it delivers nothing for the time `silence`.
pub(super) fn carry(
    channel: &mut Channel,
    stream: &UnixStream,
    unread: Vec<u8>,
    silence: Option<Duration>,
) -> Disconnect {
    match try_to_carry(channel, stream, unread, silence) {
        Ok(why) => why,
        Err(error) => Disconnect::Lost(error.to_string()),
    }
}

fn try_to_carry(
    channel: &mut Channel,
    mut stream: &UnixStream,
    mut inward: Vec<u8>,
    silence: Option<Duration>,
) -> io::Result<Disconnect> {
    stream.set_write_timeout(Some(UNREAD))?;
    let (mut outward, mut heard) = (Vec::new(), Instant::now());
    loop {
        stream.write_all(&inward)?;
        inward.clear();
        if channel.is_flushed() && !take(stream, &mut outward)? {
            return Ok(Disconnect::Closed);
        }
        channel.send_bytes(&mut outward)?;
        let wake = channel.is_flushed().then(|| stream.as_fd());
        let until = silence.map(|silence| heard + silence);
        if channel.wait(wake, until)? {
            let is_open = channel.receive_bytes(|bytes| inward.extend_from_slice(bytes))?;
            heard = Instant::now();
            if !is_open {
                stream.write_all(&inward)?;
                return Ok(Disconnect::Closed);
            }
        } else if let Some(limit) = silence.filter(|limit| heard.elapsed() >= *limit) {
            return Ok(Disconnect::Silent(limit));
        }
    }
}

/// Reads the available bytes of a stream; false at its end.
fn take(stream: &UnixStream, bytes: &mut Vec<u8>) -> io::Result<bool> {
    let mut buffer = [0; CHUNK];
    match recv(stream, &mut buffer[..], RecvFlags::DONTWAIT) {
        Ok((0, _)) => Ok(false),
        Ok((count, _)) => {
            bytes.extend_from_slice(&buffer[..count]);
            Ok(true)
        }
        Err(Errno::AGAIN | Errno::INTR) => Ok(true),
        Err(error) => Err(error.into()),
    }
}
