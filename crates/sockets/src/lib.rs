//! Unix sockets of one user: a [`Line`] that does not block, and an [`Acceptor`] that accepts connections in a thread.
//!
//! Only processes of the same user can connect: the socket has mode 0600, and [`check_user`] asks the system for the
//! user at the other end.

#![forbid(unsafe_code)]

use std::{
    fs, io,
    io::{Read as _, Write as _},
    net::Shutdown,
    os::{
        fd::{AsFd as _, BorrowedFd},
        unix::{
            fs::{FileTypeExt as _, MetadataExt as _, PermissionsExt as _},
            net::{UnixListener, UnixStream},
        },
    },
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use rustix::{
    event::{PollFd, PollFlags, Timespec, poll},
    io::Errno,
    net::sockopt,
    process::geteuid,
};

const CHUNK: usize = 8192; // read at once
/// Pause after a failed accept, because the system may lack descriptors.
const PAUSE: Duration = Duration::from_millis(100);

/// Fails with [`io::ErrorKind::PermissionDenied`] if another user is at the other end.
pub fn check_user(stream: &UnixStream) -> io::Result<()> {
    let (expected, found) = (geteuid(), sockopt::socket_peercred(stream)?.uid);
    if expected == found {
        return Ok(());
    }
    let why = format!("user {} was expected, found user {}", expected.as_raw(), found.as_raw());
    Err(io::Error::new(io::ErrorKind::PermissionDenied, why))
}

/// A connected socket. Only [`Line::wait`], [`Line::finish`] and [`Line::drain`] block, with a limit.
#[derive(Debug)]
pub struct Line {
    stream: UnixStream,
    pending: Vec<u8>,
}

impl Line {
    pub fn new(stream: UnixStream) -> io::Result<Self> {
        stream.set_nonblocking(true)?;
        Ok(Self { stream, pending: Vec::new() })
    }

    /// As [`check_user`].
    pub fn check_user(&self) -> io::Result<()> {
        check_user(&self.stream)
    }

    /// Makes the stream blocking again.
    pub fn into_stream(self) -> io::Result<UnixStream> {
        self.stream.set_nonblocking(false)?;
        Ok(self.stream)
    }

    /// True if the system has accepted all bytes.
    #[must_use]
    pub const fn is_flushed(&self) -> bool {
        self.pending.is_empty()
    }

    /// Sends bytes and removes them from `bytes`. The rest waits for the next call.
    pub fn send(&mut self, bytes: &mut Vec<u8>) -> io::Result<()> {
        self.pending.append(bytes);
        while !self.pending.is_empty() {
            match (&self.stream).write(&self.pending) {
                Ok(0) => return Err(io::ErrorKind::WriteZero.into()),
                Ok(count) => drop(self.pending.drain(..count)),
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => return Ok(()),
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Returns false if the other side has closed the connection.
    pub fn receive(&mut self, take: impl FnOnce(&[u8])) -> io::Result<bool> {
        use io::ErrorKind::{ConnectionReset, Interrupted, WouldBlock};
        let mut buffer = [0; CHUNK];
        match (&self.stream).read(&mut buffer) {
            Ok(count) => {
                take(buffer.get(..count).unwrap_or_default());
                Ok(count > 0)
            }
            Err(error) if matches!(error.kind(), WouldBlock | Interrupted) => Ok(true),
            // The other side has closed the connection before reading everything.
            Err(error) if error.kind() == ConnectionReset => Ok(false),
            Err(error) => Err(error),
        }
    }

    /// Waits until bytes arrive (true), pending bytes can be sent, `wake` is readable, or `until` is reached.
    pub fn wait(&self, wake: Option<BorrowedFd<'_>>, until: Option<Instant>) -> io::Result<bool> {
        let write = if self.is_flushed() { PollFlags::empty() } else { PollFlags::OUT };
        let socket = self.stream.as_fd();
        let mut ready = [
            PollFd::from_borrowed_fd(socket, PollFlags::IN | write),
            PollFd::from_borrowed_fd(wake.unwrap_or(socket), PollFlags::IN),
        ];
        let count = if wake.is_some() { 2 } else { 1 };
        // The time is rounded up, because an early end would cause many short waits.
        let left =
            until.map(|until| until.saturating_duration_since(Instant::now()) + Duration::from_millis(1));
        let left = left.and_then(|left| Timespec::try_from(left).ok());
        match poll(&mut ready[..count], left.as_ref()) {
            Ok(_) => Ok(ready[0].revents().intersects(PollFlags::IN | PollFlags::HUP | PollFlags::ERR)),
            Err(Errno::INTR) => Ok(false),
            Err(error) => Err(error.into()),
        }
    }

    /// Sends the rest until `until`, then closes this direction.
    pub fn finish(&mut self, bytes: &mut Vec<u8>, until: Instant) {
        let mut sent = self.send(bytes);
        while sent.is_ok() && !self.is_flushed() && Instant::now() < until {
            sent = self.wait(None, Some(until)).and_then(|_| self.send(bytes));
        }
        // It may be closed already.
        let _ = self.stream.shutdown(Shutdown::Write);
    }

    /// Reads until the other side closes, or until `until`. Closing a socket with unread bytes can lose sent bytes.
    pub fn drain(&mut self, until: Instant) {
        let mut is_open = true;
        while is_open && Instant::now() < until {
            let ready = self.wait(None, Some(until));
            let received = ready.and_then(|ready| if ready { self.receive(|_| {}) } else { Ok(true) });
            is_open = received.unwrap_or(false);
        }
    }
}

/// The socket's file with its identity, because another program may replace it.
#[derive(Debug)]
struct SocketFile {
    path: PathBuf,
    identity: (u64, u64),
}

impl SocketFile {
    fn at(path: &Path) -> io::Result<Self> {
        let found = fs::symlink_metadata(path)?;
        Ok(Self { path: path.to_owned(), identity: (found.dev(), found.ino()) })
    }

    fn remove(&self) {
        if Self::at(&self.path).is_ok_and(|found| found.identity == self.identity) {
            // It may be removed already.
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// Accepts connections in a thread. Dropping it removes the socket's file.
#[derive(Debug)]
pub struct Acceptor {
    socket: Arc<UnixListener>,
    file: SocketFile,
    over: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Acceptor {
    /// Replaces the dead socket of a killed process. `name` is the thread's; `admit` receives each connection. Fails
    /// with [`io::ErrorKind::AddrInUse`] if another program listens there, [`io::ErrorKind::AlreadyExists`] if there is
    /// a file of another kind, or an error of the system.
    pub fn start(
        path: &Path,
        name: &str,
        mut admit: impl FnMut(UnixStream) + Send + 'static,
    ) -> io::Result<Self> {
        let socket = Arc::new(bind(path)?);
        let file = SocketFile::at(path)?;
        let over = Arc::new(AtomicBool::new(false));
        let (accepting, flag) = (Arc::clone(&socket), Arc::clone(&over));
        let accept = move || {
            while !flag.load(Ordering::Acquire) {
                match accepting.accept() {
                    _ if flag.load(Ordering::Acquire) => return,
                    Ok((stream, _)) => admit(stream),
                    Err(_) => thread::sleep(PAUSE),
                }
            }
        };
        let thread = Some(thread::Builder::new().name(name.to_owned()).spawn(accept)?);
        Ok(Self { socket, file, over, thread })
    }

    #[must_use]
    pub fn path(&self) -> &Path {
        &self.file.path
    }
}

impl Drop for Acceptor {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Release);
        // The shutdown wakes the thread, even if another program now uses the path.
        let woken = rustix::net::shutdown(&*self.socket, rustix::net::Shutdown::Both);
        if let Some(thread) = self.thread.take().filter(|_| woken.is_ok()) {
            // A panic in the thread was already reported.
            let _ = thread.join();
        }
        self.file.remove();
    }
}

fn bind(path: &Path) -> io::Result<UnixListener> {
    let listener = match UnixListener::bind(path) {
        Err(error) if error.kind() == io::ErrorKind::AddrInUse => {
            if UnixStream::connect(path).is_ok() {
                return Err(error);
            }
            if !fs::symlink_metadata(path)?.file_type().is_socket() {
                let why = "a socket, or no file, was expected, found a file of another kind";
                return Err(io::Error::new(io::ErrorKind::AlreadyExists, why));
            }
            fs::remove_file(path)?;
            UnixListener::bind(path)?
        }
        bound => bound?,
    };
    fs::set_permissions(path, fs::Permissions::from_mode(0o600))?;
    Ok(listener)
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel;

    use super::*;

    #[test]
    fn acceptor_replaces_an_abandoned_socket_and_no_other_file() {
        let place = tempfile::tempdir().unwrap();
        let (socket, file) = (place.path().join("a.sock"), place.path().join("notes"));
        drop(UnixListener::bind(&socket).unwrap());
        let first = Acceptor::start(&socket, "first", drop).unwrap();
        assert_eq!(fs::metadata(&socket).unwrap().permissions().mode() & 0o777, 0o600);
        let second = Acceptor::start(&socket, "second", drop);
        assert_eq!(second.unwrap_err().kind(), io::ErrorKind::AddrInUse);
        drop(first);
        assert!(!socket.exists());
        fs::write(&file, "keep").unwrap();
        let refused = Acceptor::start(&file, "third", drop);
        assert_eq!(refused.unwrap_err().kind(), io::ErrorKind::AlreadyExists);
        assert_eq!(fs::read_to_string(file).unwrap(), "keep");
    }

    #[test]
    fn acceptor_ends_and_leaves_the_socket_that_replaced_its_own() {
        let place = tempfile::tempdir().unwrap();
        let socket = place.path().join("a.sock");
        let first = Acceptor::start(&socket, "first", drop).unwrap();
        fs::remove_file(&socket).unwrap();
        let _second = UnixListener::bind(&socket).unwrap();
        drop(first);
        assert!(socket.exists());
    }

    #[test]
    fn line_delivers_pending_bytes_before_the_end() {
        let place = tempfile::tempdir().unwrap();
        let socket = place.path().join("a.sock");
        let (accepted, connections) = channel();
        let _acceptor =
            Acceptor::start(&socket, "lines", move |stream| accepted.send(stream).unwrap()).unwrap();
        let mut near = Line::new(UnixStream::connect(&socket).unwrap()).unwrap();
        near.check_user().unwrap();
        let mut far = Line::new(connections.recv().unwrap()).unwrap();
        let sent: Vec<u8> = (0..1 << 20).map(|at: u32| at.to_le_bytes()[0]).collect();
        let sending = thread::spawn({
            let mut bytes = sent.clone();
            let until = Instant::now() + Duration::from_secs(20);
            move || {
                near.send(&mut bytes).unwrap();
                assert!(!near.is_flushed(), "the system accepts a megabyte at once");
                near.finish(&mut bytes, until);
                near.drain(until);
            }
        });
        let mut received = Vec::new();
        while far.receive(|bytes| received.extend_from_slice(bytes)).unwrap() {
            far.wait(None, None).unwrap();
        }
        drop(far);
        sending.join().unwrap();
        assert!(received == sent, "{} of {} bytes", received.len(), sent.len());
    }
}
