//! The controller accepts connections: one thread waits at a socket, and one thread serves each connection.
//!
//! It admits processes of the same user. All others are refused with a reason, which is also an event.

use std::{io, sync::Arc};

use sockets::Acceptor;

use super::{Address, ClockKind, Endpoint, Operators, server::Server};

#[derive(Debug, thiserror::Error)]
pub enum ListenError {
    #[error("{address}: {source}")]
    Address { address: Address, source: io::Error },
    #[error("{0}: another run waits for its neighbours there")]
    InUse(Address),
}

/// Accepts connections until it is dropped.
#[derive(Debug)]
pub struct Listener {
    _acceptor: Acceptor,
}

impl Listener {
    pub fn start<'a>(
        address: &Address,
        endpoints: impl IntoIterator<Item = &'a Endpoint>,
    ) -> Result<Self, ListenError> {
        Self::with_operators(address, endpoints, None)
    }

    /// Like [`Listener::start`], but also for operators.
    pub fn with_operators<'a>(
        address: &Address,
        endpoints: impl IntoIterator<Item = &'a Endpoint>,
        operators: Option<Operators>,
    ) -> Result<Self, ListenError> {
        let handles: Vec<_> = endpoints.into_iter().map(Endpoint::handle).collect();
        // Without endpoints there are only operators, which require the real clock.
        let clock = handles.first().map_or(ClockKind::Real, |handle| handle.clock());
        let server = Arc::new(Server::new(handles, operators, clock));
        let started = Acceptor::start(address.path(), "network", move |stream| server.enter(stream));
        let _acceptor = started.map_err(|source| match source.kind() {
            io::ErrorKind::AddrInUse => ListenError::InUse(address.clone()),
            _ => ListenError::Address { address: address.clone(), source },
        })?;
        Ok(Self { _acceptor })
    }
}

#[cfg(test)]
mod tests {
    use std::{fs, os::unix::net::UnixStream, time::Instant};

    use super::*;
    use crate::network::{
        NetEvent, Peer, Role,
        accept_queue::{SAFE, SLOTS},
        clock::{ClockKind, answer_limit},
    };

    fn endpoint(clock: ClockKind) -> Endpoint {
        Endpoint::new(Role::Workstation, clock).unwrap()
    }

    #[test]
    fn second_listener_at_a_socket_is_refused() {
        let place = tempfile::tempdir().unwrap();
        let (socket, file) = (place.path().join("rcs.sock"), place.path().join("notes"));
        let endpoint = endpoint(ClockKind::Real);
        let _listener = Listener::start(&Address::from(socket.clone()), [&endpoint]).unwrap();
        let second = Listener::start(&Address::from(socket), [&endpoint]);
        assert!(matches!(second, Err(ListenError::InUse(_))));
        fs::write(&file, "no socket").unwrap();
        let refused = Listener::start(&Address::from(file), [&endpoint]);
        assert!(matches!(refused, Err(ListenError::Address { .. })));
    }

    #[test]
    fn silent_clients_do_not_block_others() {
        let place = tempfile::tempdir().unwrap();
        let socket = place.path().join("rcs.sock");
        let address = Address::from(socket.clone());
        let endpoint = endpoint(ClockKind::Fast);
        let _listener = Listener::start(&address, [&endpoint]).unwrap();
        let _silent: Vec<_> = (0..SLOTS * 2).map(|_| UnixStream::connect(&socket).unwrap()).collect();
        Peer::connect_within(answer_limit(ClockKind::Fast) / 2, &address, Role::Workstation).unwrap();
    }

    /// All attempts are refused, the run receives a limited number of events, and another client is admitted soon.
    #[test]
    fn repeated_attempts_neither_fill_the_log_nor_block_others() {
        let place = tempfile::tempdir().unwrap();
        let address = Address::from(place.path().join("rcs.sock"));
        let endpoint = endpoint(ClockKind::Real);
        let _listener = Listener::start(&address, [&endpoint]).unwrap();
        let started = Instant::now();
        let mut tried = 0_u32;
        while started.elapsed() < SAFE * 3 {
            assert!(Peer::connect(&address, Role::DataSystem).is_err(), "none is expected");
            tried += 1;
        }
        Peer::connect_within(answer_limit(ClockKind::Fast), &address, Role::Workstation).unwrap();
        let events = std::iter::from_fn(|| endpoint.event());
        let told =
            u32::try_from(events.filter(|event| matches!(event, NetEvent::Refused(_))).count()).unwrap();
        // One event per slot and interval of `SAFE`, and one for the full queue. Time also passes after the loop.
        let most = (started.elapsed().as_secs_f64() / SAFE.as_secs_f64()).ceil() as u32 + 1;
        assert!(told <= most * (SLOTS as u32 + 1), "{told} of {tried} in {most} s");
    }
}
