//! Passes bytes between a browser and the run unchanged. The run's pings pass, too, so the run detects a lost browser
//! as it does at its own port.

use std::{
    fmt,
    io::{self, ErrorKind, Read as _, Write as _},
    os::{fd::AsFd as _, unix::net::UnixStream},
    time::{Duration, Instant},
};

use rustix::event::{PollFd, PollFlags};

use crate::{
    end::CLOSING,
    page::{
        logins::Login,
        tls::{Tls, wait},
    },
};

const CHUNK: usize = 16 * 1024; // bytes that are read at once, and most bytes that wait for the run
/// A browser that reads nothing for this time is disconnected.
const STALL: Duration = Duration::from_secs(10);
const LOOK: Duration = Duration::from_millis(200); // time after which the end of a login is seen

#[derive(Debug)]
pub enum Ended {
    ByBrowser,
    ByRun,
    ByLogin, // the login has ended: logged out, removed, expired, or the gateway ends
    Stalled, // the browser has read nothing for too long
    Failed(io::Error),
}

impl From<io::Error> for Ended {
    fn from(error: io::Error) -> Self {
        Self::Failed(error)
    }
}

impl fmt::Display for Ended {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ByBrowser => f.write_str("the browser has closed the connection"),
            Self::ByRun => f.write_str("the run has closed the connection"),
            Self::ByLogin => f.write_str("the login has ended"),
            Self::Stalled => write!(f, "the browser has read nothing for {} s", STALL.as_secs()),
            Self::Failed(error) => error.fmt(f),
        }
    }
}

pub enum Upward {
    Nothing,      // nothing: a page follows
    All(Vec<u8>), // all bytes, and first those that are received already
}

pub fn pump(mut tls: Tls, run: &UnixStream, upward: Upward, login: &Login) -> Ended {
    let ended = match upward {
        Upward::Nothing => pass(&mut tls, run, Vec::new(), false, login),
        Upward::All(first) => pass(&mut tls, run, first, true, login),
    };
    let Err(ended) = ended;
    if matches!(ended, Ended::ByRun | Ended::ByLogin) {
        // A disconnected browser does not read the end.
        let _ = tls.finish(&[], Instant::now() + CLOSING);
    }
    ended
}

fn pass(
    tls: &mut Tls,
    mut run: &UnixStream,
    mut up: Vec<u8>,
    passes_up: bool,
    login: &Login,
) -> Result<std::convert::Infallible, Ended> {
    run.set_nonblocking(true)?;
    let mut chunk = [0; CHUNK];
    let (mut sent, mut moved) = (tls.sent(), Instant::now());
    loop {
        let now = Instant::now();
        if login.is_over(now) {
            return Err(Ended::ByLogin);
        }
        tls.turn()?;
        let mut is_busy = false;
        if up.len() < CHUNK {
            match tls.receive(&mut chunk)? {
                Some(0) => return Err(Ended::ByBrowser),
                Some(count) => {
                    is_busy = true;
                    if passes_up {
                        up.extend_from_slice(chunk.get(..count).unwrap_or_default());
                    }
                }
                None => {}
            }
        }
        if !up.is_empty() {
            match run.write(&up) {
                Ok(count) => drop(up.drain(..count)),
                Err(error) if is_later(&error) => {}
                // The data that the run has sent before its end can still be read.
                Err(_) => up.clear(),
            }
        }
        if tls.is_flushed() {
            match run.read(&mut chunk) {
                Ok(0) => return Err(Ended::ByRun),
                Ok(count) => {
                    is_busy = true;
                    tls.send(chunk.get(..count).unwrap_or_default())?;
                }
                Err(error) if is_later(&error) => {}
                Err(error) if error.kind() == ErrorKind::ConnectionReset => return Err(Ended::ByRun),
                Err(error) => return Err(error.into()),
            }
        }
        if tls.is_flushed() || tls.sent() != sent {
            (sent, moved) = (tls.sent(), now);
        } else if now.saturating_duration_since(moved) > STALL {
            return Err(Ended::Stalled);
        }
        if is_busy {
            continue;
        }
        let (reads, writes) = (tls.is_flushed(), !up.is_empty());
        let read = if reads { PollFlags::IN } else { PollFlags::empty() };
        let write = if writes { PollFlags::OUT } else { PollFlags::empty() };
        let mut sockets =
            [tls.interest(up.len() < CHUNK), PollFd::from_borrowed_fd(run.as_fd(), read | write)];
        // A socket that the run has closed is always ready, so it is polled only when the browser has read everything.
        let count = if reads || writes { 2 } else { 1 };
        wait(sockets.get_mut(..count).unwrap_or_default(), now + LOOK)?;
    }
}

fn is_later(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted)
}
