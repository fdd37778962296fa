//! The connection to a coupler over TCP. Every close is a reset (`SO_LINGER` 0), so that the system discards old
//! outputs instead of delivering them late. See also [`neighbour`](super::neighbour).

use std::{
    io::{ErrorKind, Read, Write},
    net::{SocketAddr, TcpStream},
    time::Duration,
};

use couplers::{Fault, Link, link::FrameFault};
use modbus::{Client, Header, MOST_FRAME_BYTES, Request, Response, mbap};
use rustix::{
    event::{PollFd, PollFlags, Timespec, poll},
    io::Errno,
    net::sockopt::set_socket_linger,
};

use crate::clock::{Monotonic, Time};

/// Shortest time limit for a connection, even if the limit for answers is shorter.
const LEAST_CONNECT: Duration = Duration::from_millis(100);

#[derive(Debug)]
pub struct TcpLink {
    address: SocketAddr,
    timeout: Duration,
    client: Client,
    stream: Option<TcpStream>,
    is_unanswered: bool, // an earlier request whose answer is missing
    received: [u8; MOST_FRAME_BYTES],
    filled: usize,
}

impl TcpLink {
    /// A link that is not connected. An answer that takes longer than `timeout` is missing.
    #[must_use]
    pub const fn new(address: SocketAddr, unit: u8, timeout: Duration) -> Self {
        Self {
            address,
            timeout,
            client: Client::new(unit),
            stream: None,
            is_unanswered: false,
            received: [0; MOST_FRAME_BYTES],
            filled: 0,
        }
    }

    fn send(&mut self, frame: &[u8], until: Duration) -> Result<(), Fault> {
        let stream = self.stream.as_mut().ok_or(Fault::Disconnected)?;
        let mut rest = frame;
        while !rest.is_empty() {
            match stream.write(rest) {
                Ok(0) => return Err(Fault::Disconnected),
                Ok(sent) => rest = rest.get(sent..).unwrap_or_default(),
                Err(error) if error.kind() == ErrorKind::WouldBlock => {
                    if !wait(stream, PollFlags::OUT, until)? {
                        // The coupler has not read earlier requests, so a part of this one may already be sent.
                        return Err(Fault::Disconnected);
                    }
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(_) => return Err(Fault::Disconnected),
            }
        }
        Ok(())
    }

    fn receive(&mut self, until: Duration) -> Result<Option<usize>, Fault> {
        let stream = self.stream.as_mut().ok_or(Fault::Disconnected)?;
        loop {
            let frame = mbap::first_frame(self.received.get(..self.filled).unwrap_or_default())?;
            if let Some(length) = frame.map(<[u8]>::len) {
                if length < self.filled {
                    // More than one answer: it is unknown which one belongs to the request.
                    return Err(Fault::Frame(FrameFault::Length));
                }
                return Ok(Some(length));
            }
            match stream.read(self.received.get_mut(self.filled..).unwrap_or_default()) {
                Ok(0) => return Err(Fault::Disconnected),
                Ok(read) => self.filled += read,
                Err(error) if error.kind() == ErrorKind::WouldBlock => {
                    if !wait(stream, PollFlags::IN, until)? {
                        return Ok(None);
                    }
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(_) => return Err(Fault::Disconnected),
            }
        }
    }
}

/// Waits until the socket is ready, or until a time; false if it is not ready in time.
fn wait(stream: &TcpStream, events: PollFlags, until: Duration) -> Result<bool, Fault> {
    let rest = until.saturating_sub(Monotonic.now());
    if rest.is_zero() {
        return Ok(false);
    }
    let rest = Timespec::try_from(rest).map_err(|_| Fault::Disconnected)?;
    match poll(&mut [PollFd::new(stream, events)], Some(&rest)) {
        // After a signal the caller tries the socket and the time again.
        Ok(_) | Err(Errno::INTR) => Ok(true),
        Err(_) => Err(Fault::Disconnected),
    }
}

impl Link for TcpLink {
    fn now(&mut self) -> u64 {
        u64::try_from(Monotonic.now().as_nanos()).unwrap_or(u64::MAX)
    }

    fn connect(&mut self) -> Result<(), Fault> {
        self.reset();
        let limit = self.timeout.max(LEAST_CONNECT);
        let stream = TcpStream::connect_timeout(&self.address, limit).map_err(|_| Fault::NoConnection)?;
        let prepared = set_socket_linger(&stream, Some(Duration::ZERO))
            .map_err(Into::into)
            .and_then(|()| stream.set_nodelay(true))
            .and_then(|()| stream.set_nonblocking(true));
        prepared.map_err(|_| Fault::NoConnection)?;
        self.stream = Some(stream);
        Ok(())
    }

    fn exchange<'a>(
        &mut self,
        request: &Request<'_>,
        buffer: &'a mut [u8; MOST_FRAME_BYTES],
    ) -> Result<Response<'a>, Fault> {
        let until = Monotonic.now() + self.timeout;
        if self.is_unanswered {
            let length = self.receive(until)?.ok_or(Fault::Unanswered)?;
            // This must be the answer to the earlier request, whose values are too old.
            let (header, _) = Header::split(self.received.get(..length).unwrap_or_default())?;
            if header.transaction != self.client.transaction() {
                return Err(Fault::Frame(FrameFault::Transaction));
            }
            (self.is_unanswered, self.filled) = (false, 0);
        }
        let mut frame = [0; MOST_FRAME_BYTES];
        let length = self.client.request(request, &mut frame)?;
        self.send(frame.get(..length).unwrap_or_default(), until)?;
        self.is_unanswered = true;
        let length = self.receive(until)?.ok_or(Fault::NoAnswer)?;
        *buffer = self.received;
        (self.is_unanswered, self.filled) = (false, 0);
        Ok(self.client.answer(request, buffer.get(..length).unwrap_or_default())?)
    }

    fn reset(&mut self) {
        self.stream = None;
        (self.is_unanswered, self.filled) = (false, 0);
    }
}
