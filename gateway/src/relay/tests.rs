//! A run and a neighbour without programs, with a relay at each side and no network between them.

use std::{
    io::{Read as _, Write as _},
    os::unix::net::UnixStream,
    sync::{
        Arc,
        atomic::{AtomicU32, Ordering},
    },
    thread::{self, JoinHandle},
};

use neighbours::mailbox::{HWSC_COMMAND, HWSC_STATUS, Mailbox};

use super::*;

const ROLE: Role = Role::Workstation;
const TIME_LIMIT: Duration = Duration::from_secs(60); // of each action, for a busy machine

fn open(clock: ClockKind) -> (Session, Session) {
    let now = Instant::now();
    let (mut controller, mut neighbour) = (Session::controller(clock, now), Session::neighbour(ROLE, now));
    for _ in 0..2 {
        neighbour.receive(&std::mem::take(controller.output()), now);
        while neighbour.event(now).unwrap().is_some() {}
        controller.receive(&std::mem::take(neighbour.output()), now);
        while controller.event(now).unwrap().is_some() {}
        controller.admit();
    }
    (controller, neighbour)
}

struct Program {
    session: Session,
    stream: UnixStream,
}

impl Program {
    fn flush(&mut self) {
        self.stream.write_all(&std::mem::take(self.session.output())).unwrap();
    }

    fn event(&mut self) -> String {
        loop {
            match self.session.event(Instant::now()) {
                Ok(Some(event)) => return format!("{event:?}"),
                Err(error) => return error.to_string(),
                Ok(None) => {}
            }
            let mut bytes = [0; 4096];
            let count = self.stream.read(&mut bytes).unwrap();
            if count == 0 {
                return "closed".to_owned();
            }
            self.session.receive(&bytes[..count], Instant::now());
        }
    }

    fn wait_for_pulse(&mut self, tick: u64) {
        while self.event() != format!("Pulse({tick})") {}
    }
}

/// Two relays, which lose the first `lost` samples to the run.
struct Pair {
    run: Program,
    neighbour: Program,
    inboxes: [Arc<Inbox>; 2],
    ends: [JoinHandle<End>; 2],
}

fn pair(clock: ClockKind, lost: u32) -> Pair {
    let (to_run, to_neighbour) = (Arc::new(Inbox::new(true).unwrap()), Arc::new(Inbox::new(true).unwrap()));
    let start = |side: Side, session: Session, own: &Arc<Inbox>, other: &Arc<Inbox>, lost: u32| {
        let (near, far) = UnixStream::pair().unwrap();
        far.set_read_timeout(Some(TIME_LIMIT)).unwrap();
        let (own, other, lost) = (Arc::clone(own), Arc::clone(other), AtomicU32::new(lost));
        let thread = thread::spawn(move || {
            let admitted = Admitted { line: Line::new(near).unwrap(), session, clock };
            let mut publish = |state: &State, end: Option<&str>| {
                if lost.fetch_update(Ordering::SeqCst, Ordering::SeqCst, |left| left.checked_sub(1)).is_err()
                {
                    other.deliver(state.encode(end));
                }
            };
            Relay::new(admitted, ROLE, side, &own, &mut publish).run()
        });
        (far, thread)
    };
    let (run, gateway) = open(clock);
    let (far_gateway, neighbour) = open(clock);
    let (run_stream, run_end) = start(Side::Run, gateway, &to_run, &to_neighbour, 0);
    let (stream, end) = start(Side::Neighbour, far_gateway, &to_neighbour, &to_run, lost);
    Pair {
        run: Program { session: run, stream: run_stream },
        neighbour: Program { session: neighbour, stream },
        inboxes: [to_run, to_neighbour],
        ends: [run_end, end],
    }
}

fn written(place: neighbours::mailbox::Place, data: &[u8]) -> Mailbox {
    let mut mailbox = Mailbox::initialized(place);
    mailbox.write(data).unwrap();
    mailbox
}

#[test]
fn mailgrams_pulses_and_the_reason_pass_both_relays() {
    let Pair { mut run, mut neighbour, ends, .. } = pair(ClockKind::Real, 0);
    let now = Instant::now();
    let (status, command) = (written(HWSC_STATUS, b"idle"), written(HWSC_COMMAND, b"PAUSE"));
    run.session.send(&status);
    run.session.pulse(5, now);
    run.flush();
    assert_eq!(neighbour.event(), format!("{:?}", Event::Mailgram(HWSC_STATUS, status.used())));
    assert_eq!(neighbour.event(), "Pulse(5)");
    neighbour.session.send(&command);
    neighbour.session.pulse(5, now);
    neighbour.flush();
    assert_eq!(run.event(), format!("{:?}", Event::Mailgram(HWSC_COMMAND, command.used())));
    assert_eq!(run.event(), "Pulse(5)");
    run.session.close(&"workstation is connected already");
    run.flush();
    drop(run);
    assert_eq!(neighbour.event(), "workstation is connected already");
    drop(neighbour);
    let words = "workstation is connected already".to_owned();
    assert_eq!(ends.map(|end| end.join().unwrap()), [End::Local(words.clone()), End::Network(words)]);
}

#[test]
fn lost_answer_to_a_pulse_in_fast_clock_is_repeated() {
    let Pair { mut run, mut neighbour, .. } = pair(ClockKind::Fast, 1);
    run.session.pulse(1, Instant::now());
    run.flush();
    neighbour.wait_for_pulse(1);
    neighbour.session.pulse(1, Instant::now());
    neighbour.flush();
    run.wait_for_pulse(1);
    run.session.pulse(2, Instant::now());
    run.flush();
    // The repeated sample is not a second pulse for the neighbour.
    assert_eq!(neighbour.event(), "Pulse(2)");
}

#[test]
fn vanished_neighbour_ends_the_claim_before_its_silence() {
    let Pair { mut run, neighbour: _neighbour, inboxes, ends: [end, _] } = pair(ClockKind::Real, 0);
    inboxes[0].set_gone();
    assert_eq!(run.event(), "closed");
    drop(run);
    assert_eq!(end.join().unwrap(), End::Gone);
}

#[test]
fn mailbox_of_the_other_direction_ends_the_claim_and_does_not_reach_the_run() {
    let Pair { mut run, neighbour: _neighbour, inboxes, ends: [end, _] } = pair(ClockKind::Real, 0);
    inboxes[0].deliver(State::initialized(ROLE.from_controller()).encode(None));
    assert_eq!(run.event(), "closed");
    drop(run);
    assert!(matches!(end.join().unwrap(), End::Violation(_)));
}
