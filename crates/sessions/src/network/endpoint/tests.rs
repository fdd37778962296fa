//! The test reads and writes the mailboxes of the other side.

use std::thread;

use rustix::event::{PollFd, PollFlags, Timespec, poll};

use super::*;
use crate::network::{
    Disconnect,
    shared::{AttachError, Link, OVER, Outgoing},
};
use neighbours::mailbox::{HWSC_COMMAND, HWSC_STATUS};

#[derive(Debug, PartialEq)]
pub(crate) enum Sent {
    Mailbox(Box<Mailbox>),
    Pulse(u64),
    Over,
}

pub(crate) struct TestSession {
    link: Link,
    unread: std::collections::VecDeque<Sent>,
}

impl Drop for TestSession {
    fn drop(&mut self) {
        // An endpoint with an open session waits until the disconnect reason is sent.
        if self.link.handle.is_connected() {
            self.link.handle.detach(Disconnect::Closed);
        }
    }
}

impl TestSession {
    pub fn begin(handle: &EndpointHandle) -> Self {
        Self { link: handle.attach().unwrap(), unread: Default::default() }
    }

    pub fn deliver(&self, mailbox: &Mailbox) {
        self.link.handle.deliver(mailbox.place(), mailbox.used()).unwrap();
    }

    pub fn answer(&self, tick: u64) {
        self.link.handle.answer(tick);
    }

    pub fn end(self, why: Disconnect) {
        self.link.handle.detach(why);
    }

    pub fn next(&mut self) -> Sent {
        loop {
            if let Some(sent) = self.unread.pop_front() {
                return sent;
            }
            if self.link.is_over() {
                self.link.handle.detach(Disconnect::Closed);
            }
            if !self.link.handle.is_connected() {
                return Sent::Over;
            }
            // A test may end the session through its handle, which wakes no thread.
            let look = Timespec { tv_sec: 0, tv_nsec: 10_000_000 };
            poll(&mut [PollFd::new(&self.link.wake(), PollFlags::IN)], Some(&look)).unwrap();
            let unread = &mut self.unread;
            self.link.collect(|outgoing| {
                unread.push_back(match outgoing {
                    Outgoing::Mailbox(mailbox) => Sent::Mailbox(Box::new(mailbox.clone())),
                    Outgoing::Pulse(tick) => Sent::Pulse(tick),
                });
            });
        }
    }

    pub fn pulse(&mut self) -> u64 {
        loop {
            match self.next() {
                Sent::Pulse(tick) => return tick,
                Sent::Mailbox(_) => {}
                Sent::Over => panic!("the session is over"),
            }
        }
    }
}

fn connected(role: Role, clock: ClockKind) -> (Endpoint, TestSession) {
    let endpoint = Endpoint::new(role, clock).unwrap();
    let session = TestSession::begin(&endpoint.handle());
    (endpoint, session)
}

fn written(place: Place, data: &[u8]) -> Mailbox {
    let mut mailbox = Mailbox::initialized(place);
    mailbox.write(data).unwrap();
    mailbox
}

fn lost() -> Disconnect {
    Disconnect::Lost("the cable was cut".to_owned())
}

#[test]
fn tick_in_fast_clock_waits_for_its_neighbours() {
    let (mut endpoint, mut session) = connected(Role::Workstation, ClockKind::Fast);
    let neighbour = thread::spawn(move || {
        // Answers each pulse with a command that contains its number.
        for tick in 1..=100_u64 {
            assert_eq!(session.pulse(), tick);
            session.deliver(&written(HWSC_COMMAND, &tick.to_le_bytes()));
            session.answer(tick);
        }
        session
    });
    for tick in 1..=100_u64 {
        endpoint.outgoing(HWSC_STATUS).write(&[1]).unwrap();
        let presence = endpoint.exchange(tick);
        assert_eq!(presence, Presence { connected: true, new: tick == 1, was_connected: true });
        assert_eq!(endpoint.incoming(HWSC_COMMAND).data(), tick.to_le_bytes());
    }
    neighbour.join().unwrap().end(lost());
}

#[test]
fn tick_on_the_grid_does_not_wait() {
    let (mut endpoint, session) = connected(Role::Workstation, ClockKind::Real);
    assert_eq!(endpoint.exchange(1), Presence { connected: true, new: true, was_connected: true });
    assert_eq!(endpoint.exchange(2), Presence { connected: true, new: false, was_connected: true });
    session.deliver(&written(HWSC_COMMAND, b"go"));
    endpoint.exchange(3);
    assert_eq!(endpoint.incoming(HWSC_COMMAND).data(), b"go");
    session.end(lost());
}

#[test]
fn locked_mailbox_is_skipped_until_the_next_tick() {
    let (mut endpoint, session) = connected(Role::Workstation, ClockKind::Real);
    endpoint.exchange(1);
    session.deliver(&written(HWSC_COMMAND, b"go"));
    let shared = Arc::clone(&endpoint.shared);
    let held = locked(&shared.incoming[0]);
    endpoint.exchange(2);
    assert_eq!(endpoint.incoming(HWSC_COMMAND).data(), b"");
    drop(held);
    endpoint.exchange(3);
    assert_eq!(endpoint.incoming(HWSC_COMMAND).data(), b"go");
    session.end(lost());
}

#[test]
fn reconnected_neighbour_gets_initialized_mailboxes_and_all_data() {
    let (mut endpoint, session) = connected(Role::Workstation, ClockKind::Real);
    session.deliver(&written(HWSC_COMMAND, b"go"));
    endpoint.outgoing(HWSC_STATUS).write(b"status").unwrap();
    endpoint.exchange(1);
    let occupied = endpoint.handle().attach().map(drop);
    assert_eq!(occupied.unwrap_err().to_string(), "workstation is connected already");
    session.end(lost());
    assert!(!endpoint.exchange(2).connected);
    let mut session = TestSession::begin(&endpoint.handle());
    assert_eq!(endpoint.exchange(3), Presence { connected: true, new: true, was_connected: true });
    assert_eq!(endpoint.incoming(HWSC_COMMAND).mailgram(), 0);
    assert_eq!(session.next(), Sent::Mailbox(Box::new(written(HWSC_STATUS, b"status"))));
    assert_eq!(session.next(), Sent::Pulse(3));
    let events: Vec<_> = std::iter::from_fn(|| endpoint.event()).collect();
    let connected = NetEvent::Connected(Role::Workstation);
    assert_eq!(events, [connected.clone(), NetEvent::Disconnected(Role::Workstation, lost()), connected]);
    session.end(lost());
}

#[test]
fn ended_run_informs_its_neighbour_and_refuses_others() {
    let (endpoint, mut session) = connected(Role::Workstation, ClockKind::Fast);
    let handle = endpoint.handle();
    let neighbour = thread::spawn(move || while session.next() != Sent::Over {});
    drop(endpoint);
    assert!(!handle.is_connected(), "the end waits until the reason was sent");
    neighbour.join().unwrap();
    assert_eq!(handle.attach().map(drop), Err(AttachError::Over));
    assert_eq!(AttachError::Over.to_string(), OVER);
}

#[test]
fn disconnection_ends_the_wait_of_a_tick() {
    let (mut endpoint, mut session) = connected(Role::Workstation, ClockKind::Fast);
    let neighbour = thread::spawn(move || {
        session.pulse();
        session.end(lost());
    });
    assert_eq!(endpoint.exchange(1), Presence { connected: false, new: true, was_connected: true });
    neighbour.join().unwrap();
    assert!(!endpoint.exchange(2).connected);
}

/// After an interruption it is unknown whether the neighbour would have answered, so it is treated as connected.
#[test]
fn end_of_the_run_ends_the_wait_of_a_tick() {
    let interrupted = Arc::new(AtomicBool::new(false));
    let (endpoint, mut session) = connected(Role::Workstation, ClockKind::Fast);
    let mut endpoint = endpoint.until(Arc::clone(&interrupted));
    let silent = thread::spawn(move || {
        session.pulse();
        session.deliver(&written(HWSC_COMMAND, b"PAUSE"));
        interrupted.store(true, Ordering::Relaxed);
        session
    });
    assert_eq!(endpoint.exchange(1), Presence { connected: true, new: true, was_connected: true });
    assert_eq!(endpoint.incoming(HWSC_COMMAND).data(), b"PAUSE");
    assert!(endpoint.exchange(2).connected);
    silent.join().unwrap().end(lost());
}

/// A run ends when its workstation controller is no longer connected.
#[test]
fn connection_between_two_ticks_is_recorded() {
    let mut endpoint = Endpoint::new(Role::Workstation, ClockKind::Fast).unwrap();
    assert!(!endpoint.exchange(1).was_connected);
    TestSession::begin(&endpoint.handle()).end(lost());
    assert_eq!(endpoint.exchange(2), Presence { connected: false, new: false, was_connected: true });
}

#[test]
fn stopped_endpoint_has_no_neighbour_and_does_not_wait() {
    for clock in [ClockKind::Fast, ClockKind::Real] {
        let (mut endpoint, mut session) = connected(Role::DataSystem, clock);
        let stop = endpoint.stop_handle();
        let neighbour = thread::spawn(move || {
            session.pulse();
            stop.stop();
            while session.next() != Sent::Over {}
        });
        let tick = (1..).find(|&tick| !endpoint.exchange(tick).connected).unwrap();
        assert!(clock == ClockKind::Real || tick == 1);
        assert!(!endpoint.exchange(tick + 1).connected);
        neighbour.join().unwrap();
    }
}
