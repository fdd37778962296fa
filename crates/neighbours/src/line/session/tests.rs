//! Two sessions; the test carries the bytes.

use proptest::prelude::*;

use super::*;
use crate::mailbox::{HWSC_COMMAND, HWSC_STATUS, MAX_SIZE, VISION_PICTURE, VISION_REQUEST};

const TICK: Duration = Duration::from_millis(40);

#[derive(Clone, Debug, PartialEq)]
enum Seen {
    Hello(Role),
    Welcome(ClockKind),
    Mailgram(Place, Vec<u8>),
    Pulse(u64),
    Error(SessionError),
}

fn events(session: &mut Session, now: Instant) -> Vec<Seen> {
    let mut seen = Vec::new();
    loop {
        seen.push(match session.event(now) {
            Ok(None) => return seen,
            Ok(Some(Event::Hello(role))) => Seen::Hello(role),
            Ok(Some(Event::Welcome(clock))) => Seen::Welcome(clock),
            Ok(Some(Event::Mailgram(place, used))) => Seen::Mailgram(place, used.to_vec()),
            Ok(Some(Event::Pulse(tick))) => Seen::Pulse(tick),
            Err(error) => Seen::Error(error),
        });
    }
}

/// Passes bytes to the other side in pieces. Returns its events.
fn carry(from: &mut Session, to: &mut Session, pieces: usize, now: Instant) -> Vec<Seen> {
    let bytes = std::mem::take(from.output());
    let seen = bytes.chunks(pieces).flat_map(|piece| {
        to.receive(piece, now);
        events(to, now)
    });
    seen.collect()
}

fn open(role: Role, clock: ClockKind) -> (Session, Session, Instant) {
    let now = Instant::now();
    let (mut controller, mut neighbour) = (Session::controller(clock, now), Session::neighbour(role, now));
    assert_eq!(carry(&mut controller, &mut neighbour, 100, now), []);
    assert_eq!(carry(&mut neighbour, &mut controller, 100, now), [Seen::Hello(role)]);
    controller.admit();
    assert_eq!(carry(&mut controller, &mut neighbour, 100, now), [Seen::Welcome(clock)]);
    (controller, neighbour, now)
}

fn written(place: Place, data: &[u8]) -> Mailbox {
    let mut mailbox = Mailbox::initialized(place);
    mailbox.write(data).unwrap();
    mailbox
}

#[test]
fn session_begins_with_the_specified_bytes() {
    let now = Instant::now();
    let mut controller = Session::controller(ClockKind::Fast, now);
    let mut neighbour = Session::neighbour(Role::Vision, now);
    assert_eq!(controller.output(), b"RCS2\x03\x00\x01\x00");
    assert_eq!(neighbour.output(), b"", "the controller begins");
    carry(&mut controller, &mut neighbour, 1, now);
    assert_eq!(neighbour.output(), b"RCS2\x03\x00\x04\x00");
    carry(&mut neighbour, &mut controller, 1, now);
    assert_eq!(controller.output(), b"", "its caller decides");
    controller.admit();
    assert_eq!(controller.output(), b"\x02\x00\x00\x00\x08\x00\x00\x00\x00\x00\x00\x00");
}

#[test]
fn messages_before_admission_wait_for_it() {
    let now = Instant::now();
    let mut controller = Session::controller(ClockKind::Real, now);
    controller.receive(b"RCS2\x03\x00\x01\x00", now);
    assert_eq!(events(&mut controller, now), [Seen::Hello(Role::Workstation)]);
    let mut bytes = Vec::new();
    frame::put_mailbox(&mut bytes, &written(HWSC_COMMAND, b"go"));
    controller.receive(&bytes, now);
    assert_eq!(events(&mut controller, now), []);
    controller.admit();
    let go = Seen::Mailgram(HWSC_COMMAND, written(HWSC_COMMAND, b"go").used().to_vec());
    assert_eq!(events(&mut controller, now), [go]);
}

#[test]
fn refused_neighbour_gets_the_reason() {
    let now = Instant::now();
    let mut controller = Session::controller(ClockKind::Real, now);
    let mut neighbour = Session::neighbour(Role::Workstation, now);
    controller.close(&"too late\x1B[2J");
    let told = Seen::Error(SessionError::Reason("too late?[2J".to_owned()));
    assert_eq!(carry(&mut controller, &mut neighbour, 7, now), [told], "without what a terminal would obey");
    assert_eq!(neighbour.deadline(), None);
}

#[test]
fn protocol_error_closes_the_session_with_a_reason() {
    let frame = |address: u32, data: &[u8]| {
        let mut bytes = Vec::new();
        frame::put(&mut bytes, address, data);
        bytes
    };
    let cases = [
        (frame(HWSC_STATUS.address, b"finished"), "the address of mailbox HWSC to RCS Command at F6000 or "),
        (
            frame(frame::PULSE, &8_u64.to_le_bytes()),
            "an answer to a pulse up to 7 was expected, found one to 8",
        ),
        (frame(frame::PULSE, b"?"), "the number of a tick was expected in a pulse, 8 bytes, found 1"),
        (frame(DISCONNECT, b"good bye"), "the address of mailbox HWSC to RCS Command at F6000 or "),
        (vec![0, 0x60, 0x0F, 0, 1, 0], "a length of 8 to 4096 was expected after the address F6000, found 1"),
    ];
    for (bytes, expected) in cases {
        let (mut controller, mut neighbour, now) = open(Role::Workstation, ClockKind::Real);
        controller.pulse(7, now);
        carry(&mut controller, &mut neighbour, 100, now);
        controller.receive(&bytes, now);
        let seen = events(&mut controller, now);
        let [Seen::Error(error)] = &seen[..] else { panic!("{seen:?}") };
        assert!(error.to_string().starts_with(expected), "{error}");
        let told = carry(&mut controller, &mut neighbour, 5, now);
        assert_eq!(told, [Seen::Error(SessionError::Reason(error.to_string()))]);
        controller.receive(&frame(HWSC_COMMAND.address, b"go"), now);
        assert_eq!(events(&mut controller, now), [], "later bytes are ignored");
    }
}

#[test]
fn invalid_hello_is_refused_at_its_first_wrong_byte() {
    let cases: [(&[u8], &str); 5] = [
        (b"GET / HTTP/1.1\r\n", "a hello was expected, found [47, 45, 54, 20]"),
        (b"R\x00", "a hello was expected, found [52, 00, 00, 00]"),
        (b"RCS2\x02\x00\x01\x00", "version 3 of the protocol was expected, found 2"),
        (b"RCS2\x03\x00\x4D\x00", "the number of a neighbour was expected, found 77"),
        (b"RCS2\x03\x00", ""),
    ];
    for (bytes, expected) in cases {
        let now = Instant::now();
        let mut controller = Session::controller(ClockKind::Real, now);
        controller.receive(bytes, now);
        match controller.event(now) {
            Ok(event) => assert_eq!((event, expected), (None, "")),
            Err(error) => assert_eq!(error.to_string(), expected),
        }
    }
    let mut neighbour = Session::neighbour(Role::Vision, Instant::now());
    neighbour.receive(b"RCS2\x03\x00\x02\x00", Instant::now());
    assert_eq!(neighbour.event(Instant::now()), Err(SessionError::Clock(2)));
    let mut neighbour = Session::neighbour(Role::Vision, Instant::now());
    neighbour.receive(b"RCS2\x03\x00\x01\x00\x00\x60\x0F\x00\x08\x00\0\0\0\0\0\0", Instant::now());
    assert_eq!(neighbour.event(Instant::now()), Err(SessionError::Welcome(0xF6000)));
}

#[test]
fn only_an_unanswered_pulse_makes_a_neighbour_silent() {
    let (mut controller, _, now) = open(Role::Workstation, ClockKind::Real);
    let limit = answer_limit(ClockKind::Real);
    assert_eq!((controller.deadline(), controller.check_time(now + limit * 9)), (None, Ok(())));
    controller.pulse(7, now);
    controller.pulse(8, now + TICK);
    assert_eq!(controller.deadline(), Some(now + limit));
    let answer = |controller: &mut Session, tick, now| {
        let mut bytes = Vec::new();
        frame::put_pulse(&mut bytes, tick);
        controller.receive(&bytes, now);
        assert_eq!(events(controller, now), [Seen::Pulse(tick)]);
    };
    answer(&mut controller, 7, now + limit - TICK); // late by one tick
    assert_eq!(controller.deadline(), Some(now + limit * 2 - TICK));
    answer(&mut controller, 8, now + limit);
    assert_eq!(controller.deadline(), None);
    controller.pulse(9, now + limit * 5);
    answer(&mut controller, 8, now + limit * 5 + TICK); // repeated
    assert_eq!(controller.check_time(now + limit * 6 - TICK), Ok(()));
    assert_eq!(controller.check_time(now + limit * 6), Err(SessionError::Silent(limit)));
    assert_eq!((controller.check_time(now + limit * 7), controller.deadline()), (Ok(()), None));
}

#[test]
fn received_bytes_do_not_extend_the_hello_limit() {
    let now = Instant::now();
    let mut controller = Session::controller(ClockKind::Real, now);
    for (at, byte) in b"RCS2\x03\x00".iter().enumerate() {
        let later = now + Duration::from_secs(at as u64 + 1);
        controller.receive(&[*byte], later);
        assert_eq!((events(&mut controller, later), controller.check_time(later)), (vec![], Ok(())));
    }
    let limit = answer_limit(ClockKind::Real);
    assert_eq!(controller.check_time(now + limit), Err(SessionError::NoHello(limit)));
}

#[test]
fn neighbour_time_limit_applies_only_on_the_grid() {
    for clock in [ClockKind::Real, ClockKind::Fast] {
        let (_, mut neighbour, now) = open(Role::Pedestal, clock);
        let late = neighbour.check_time(now + NEIGHBOUR_LIMIT);
        let expected = match clock {
            ClockKind::Real => Err(SessionError::Silent(NEIGHBOUR_LIMIT)),
            ClockKind::Fast => Ok(()),
        };
        assert_eq!(late, expected);
    }
}

#[derive(Clone, Debug)]
enum Action {
    Mailbox(Place, Vec<u8>),
    Pulse(u64),
}

fn actions() -> impl Strategy<Value = Vec<Action>> {
    let data = |place: Place, most: usize| {
        prop::collection::vec(any::<u8>(), 0..most).prop_map(move |data| Action::Mailbox(place, data))
    };
    let action = prop_oneof![
        data(VISION_REQUEST, 249),
        data(VISION_PICTURE, MAX_SIZE - 7),
        any::<u64>().prop_map(Action::Pulse)
    ];
    prop::collection::vec(action, 0..20)
}

proptest! {
    /// The events, and their order, do not depend on the pieces in which bytes arrive.
    #[test]
    fn events_do_not_depend_on_the_pieces_of_bytes(actions in actions(), pieces in 1_usize..5000) {
        let (mut controller, mut neighbour, now) = open(Role::Vision, ClockKind::Fast);
        let mut expected = Vec::new();
        for action in actions {
            match action {
                Action::Mailbox(place, data) => {
                    let mailbox = written(place, &data);
                    controller.send(&mailbox);
                    expected.push(Seen::Mailgram(place, mailbox.used().to_vec()));
                }
                Action::Pulse(tick) => {
                    controller.pulse(tick, now);
                    expected.push(Seen::Pulse(tick));
                }
            }
        }
        prop_assert_eq!(carry(&mut controller, &mut neighbour, pieces, now), expected);
    }

    /// Arbitrary bytes cause at most one error. No event follows it, and the stored input never exceeds a frame.
    #[test]
    fn arbitrary_bytes_neither_panic_nor_exhaust_memory(
        opened in any::<bool>(),
        pieces in prop::collection::vec(prop::collection::vec(any::<u8>(), 0..200), 0..60),
    ) {
        let now = Instant::now();
        let mut session =
            if opened { open(Role::Pedestal, ClockKind::Real).0 } else { Session::controller(ClockKind::Real, now) };
        session.pulse(u64::MAX, now);
        let mut seen = Vec::new();
        for piece in &pieces {
            session.receive(piece, now);
            seen.extend(events(&mut session, now));
            prop_assert!(session.input.len() - session.read <= frame::MAX_FRAME);
        }
        let errors = seen.iter().filter(|event| matches!(event, Seen::Error(_))).count();
        let is_last = matches!(seen.last(), Some(Seen::Error(_)));
        prop_assert!(errors == 0 || errors == 1 && is_last, "{:?}", seen);
    }

    /// Another program may listen instead of the controller.
    #[test]
    fn arbitrary_bytes_do_not_panic_at_a_neighbour(
        bytes in prop::collection::vec(any::<u8>(), 0..300),
        front in 0_usize..3,
    ) {
        let now = Instant::now();
        let mut session = Session::neighbour(Role::DataSystem, now);
        let hello: &[u8] = &[&b"RCS2\x03\x00\x00\x00"[..], b"\x02\x00\x00\x00\x08\x00\0\0\0\0\0\0"].concat();
        session.receive(&hello[..[0, HELLO, hello.len()][front]], now);
        events(&mut session, now);
        session.receive(&bytes, now);
        let errors = events(&mut session, now).iter().filter(|event| matches!(event, Seen::Error(_))).count();
        prop_assert!(errors <= 1);
    }
}
