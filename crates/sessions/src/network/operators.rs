//! Operators at the socket of the network (IV), used by gateways of other machines. The hello has the role
//! [`Role::Operator`](super::Role); then the connection carries lines, as at the run's own socket for operators.

use std::{
    io,
    os::unix::net::UnixStream,
    sync::{Arc, OnceLock, mpsc::Sender},
};

use super::NetEvent;

/// Begins a session of the run over a stream. The bytes are those already received after the hello.
type Enter = Box<dyn Fn(UnixStream, Vec<u8>) -> io::Result<()> + Send + Sync>;

#[derive(Clone)]
pub struct Operators {
    enter: Arc<OnceLock<Enter>>,
    events: Sender<NetEvent>,
}

impl Operators {
    /// Creates the access. Operators are refused until the run is [open](Self::open).
    #[must_use]
    pub fn new(events: Sender<NetEvent>) -> Self {
        Self { enter: Arc::default(), events }
    }

    /// Admits operators from now on. Only the first call has an effect.
    pub fn open(&self, enter: impl Fn(UnixStream, Vec<u8>) -> io::Result<()> + Send + Sync + 'static) {
        let _ = self.enter.set(Box::new(enter));
    }

    /// Refuses operators before the run has begun. The error is the reason.
    pub(super) fn check_open(&self) -> Result<(), &'static str> {
        self.enter.get().map(|_| ()).ok_or("the run has not begun: connect again when it has")
    }

    pub(super) fn enter(&self, stream: UnixStream, unread: Vec<u8>) -> io::Result<()> {
        self.enter.get().map_or(Ok(()), |enter| enter(stream, unread))
    }

    /// Sends an event to the run.
    pub(super) fn tell(&self, event: NetEvent) {
        let _ = self.events.send(event);
    }
}
