//! A TLS connection that never blocks, except in calls with a time limit. TLS 1.3 only; clients have no certificates.

use std::{
    io::{self, ErrorKind, Read as _, Write as _},
    net::{Shutdown, TcpStream},
    os::fd::{AsFd as _, BorrowedFd},
    sync::Arc,
    time::Instant,
};

use rustix::{
    event::{PollFd, PollFlags, Timespec, poll},
    io::Errno,
    net::sockopt,
};
use rustls::{
    ServerConfig, ServerConnection,
    crypto::ring,
    pki_types::{CertificateDer, PrivateKeyDer, pem::PemObject as _},
    version::TLS13,
};

use crate::{error::Error, keys::Keys};

/// Bytes that the system may keep for a client that reads slowly. More would only delay the page.
const KEPT: usize = 128 * 1024;

/// A configuration with a cell's certificate. Fails if the certificate or the key cannot be used.
pub fn config(keys: &Keys) -> Result<Arc<ServerConfig>, Error> {
    let failed = |reason: String| Error::Tls { certificate: keys.certificate.clone(), reason };
    let chain = CertificateDer::pem_file_iter(&keys.certificate).and_then(Iterator::collect);
    let chain: Vec<_> = chain.map_err(|error| failed(error.to_string()))?;
    let key = PrivateKeyDer::from_pem_file(&keys.key).map_err(|error| failed(error.to_string()))?;
    let builder = ServerConfig::builder_with_provider(Arc::new(ring::default_provider()));
    let builder = builder.with_protocol_versions(&[&TLS13]).map_err(|error| failed(error.to_string()))?;
    let config = builder.with_no_client_auth().with_single_cert(chain, key);
    let mut config = config.map_err(|error| failed(error.to_string()))?;
    config.alpn_protocols = vec![b"http/1.1".to_vec()];
    Ok(Arc::new(config))
}

pub struct Tls {
    socket: TcpStream,
    session: ServerConnection,
    is_ended: bool, // the other side sends nothing more
    sent: u64,      // bytes that the system has accepted
}

impl Tls {
    pub fn new(socket: TcpStream, config: Arc<ServerConfig>) -> io::Result<Self> {
        socket.set_nonblocking(true)?;
        socket.set_nodelay(true)?;
        sockopt::set_socket_send_buffer_size(&socket, KEPT)?;
        let session = ServerConnection::new(config).map_err(io::Error::other)?;
        Ok(Self { socket, session, is_ended: false, sent: 0 })
    }

    /// Sends pending bytes and receives arrived ones, without waiting. Fails after a violation of TLS.
    pub fn turn(&mut self) -> io::Result<()> {
        self.flush()?;
        while !self.is_ended && self.session.wants_read() {
            match self.session.read_tls(&mut self.socket) {
                Ok(0) => self.is_ended = true,
                Ok(_) => self.process()?,
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        self.flush()
    }

    fn process(&mut self) -> io::Result<()> {
        let Err(error) = self.session.process_new_packets() else { return Ok(()) };
        // This sends the alert, which a disconnected client does not read.
        let _ = self.flush();
        Err(io::Error::new(ErrorKind::InvalidData, error))
    }

    fn flush(&mut self) -> io::Result<()> {
        while self.session.wants_write() {
            match self.session.write_tls(&mut self.socket) {
                Ok(0) => return Err(ErrorKind::WriteZero.into()),
                Ok(count) => self.sent = self.sent.saturating_add(count.try_into().unwrap_or(u64::MAX)),
                Err(error) if error.kind() == ErrorKind::WouldBlock => return Ok(()),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Takes received bytes: their number, 0 at the end, `None` if none have arrived.
    pub fn receive(&mut self, bytes: &mut [u8]) -> io::Result<Option<usize>> {
        match self.session.reader().read(bytes) {
            Ok(count) => Ok(Some(count)),
            Err(error) if error.kind() == ErrorKind::WouldBlock && !self.is_ended => Ok(None),
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::UnexpectedEof) => {
                Ok(Some(0))
            }
            Err(error) => Err(error),
        }
    }

    /// Sends bytes; those that the system does not accept wait for the next [`Tls::turn`].
    pub fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.session.writer().write_all(bytes)?;
        self.flush()
    }

    #[must_use]
    pub fn is_flushed(&self) -> bool {
        !self.session.wants_write()
    }

    #[must_use]
    pub const fn sent(&self) -> u64 {
        self.sent
    }

    /// The socket, and the events for which [`Tls::turn`] waits. With `reads` it waits for bytes, too.
    #[must_use]
    pub fn interest(&self, reads: bool) -> PollFd<'_> {
        let read = if reads && !self.is_ended { PollFlags::IN } else { PollFlags::empty() };
        let write = if self.is_flushed() { PollFlags::empty() } else { PollFlags::OUT };
        PollFd::from_borrowed_fd(self.fd(), read | write)
    }

    fn fd(&self) -> BorrowedFd<'_> {
        self.socket.as_fd()
    }

    /// Waits for received bytes, at most until a time. Fails with [`ErrorKind::TimedOut`], or like [`Tls::turn`].
    pub fn receive_until(&mut self, bytes: &mut [u8], until: Instant) -> io::Result<usize> {
        loop {
            self.turn()?;
            if let Some(count) = self.receive(bytes)? {
                return Ok(count);
            }
            if !wait(&mut [self.interest(true)], until)? {
                return Err(ErrorKind::TimedOut.into());
            }
        }
    }

    /// Sends the last bytes and the end, and waits at most until a time for the client to close.
    pub fn finish(mut self, bytes: &[u8], until: Instant) -> io::Result<()> {
        self.send(bytes)?;
        self.session.send_close_notify();
        self.flush()?;
        while !self.is_flushed() {
            if !wait(&mut [self.interest(false)], until)? {
                return Err(ErrorKind::TimedOut.into());
            }
            self.flush()?;
        }
        // If a socket is closed with unread bytes, the system may discard those that it has sent.
        self.socket.shutdown(Shutdown::Write)?;
        let mut rest = [0; 4096];
        loop {
            match self.socket.read(&mut rest) {
                Ok(0) => return Ok(()),
                Ok(_) => {}
                Err(error) if error.kind() == ErrorKind::WouldBlock => {
                    let mut end = [PollFd::from_borrowed_fd(self.fd(), PollFlags::IN)];
                    if !wait(&mut end, until)? {
                        return Ok(());
                    }
                }
                Err(error) => return Err(error),
            }
            if Instant::now() >= until {
                return Ok(());
            }
        }
    }
}

/// Waits until a socket is ready; false if the time is over.
pub fn wait(sockets: &mut [PollFd<'_>], until: Instant) -> io::Result<bool> {
    let left = until.saturating_duration_since(Instant::now());
    if left.is_zero() {
        return Ok(false);
    }
    match poll(sockets, Timespec::try_from(left).ok().as_ref()) {
        Ok(ready) => Ok(ready > 0),
        Err(Errno::INTR) => Ok(true),
        Err(error) => Err(error.into()),
    }
}
