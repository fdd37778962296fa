//! An agent and a simulated Data System, without a network. With a time limit of zero an agent checks once, so that the
//! results do not depend on the computer's clock.

use std::{
    path::Path,
    sync::{Arc, atomic::AtomicBool, mpsc},
    thread::JoinHandle,
};

use interfaces::{
    DataBaseCommand,
    data_base::{DataBaseReport, DataBaseVerb},
};
use rcs_core::{
    name::{Name10, Name16},
    tick::Tick,
};

use super::*;
use crate::{
    data_system::{self, Pace},
    network::{
        ClockKind, Disconnect, EndpointHandle, Role,
        endpoint::tests::{Sent, TestSession},
    },
};
use neighbours::mailbox::Mailbox;

type Written = Vec<Vec<u8>>;
type Garble = fn(&mut Vec<u8>);

/// A server on a thread. `answer` receives the number of the mailgram, from 1, and its command.
fn serve(
    handle: &EndpointHandle,
    mut answer: impl FnMut(usize, &[u8]) -> Written + Send + 'static,
) -> JoinHandle<()> {
    let mut session = TestSession::begin(handle);
    thread::spawn(move || {
        let (mut status_box, mut read) = (Mailbox::initialized(DATA_SYSTEM_STATUS), 0);
        loop {
            match session.next() {
                Sent::Pulse(tick) => session.answer(tick),
                Sent::Mailbox(command) => {
                    read += 1;
                    for status in answer(read, command.data()) {
                        status_box.write(&status).unwrap();
                        session.deliver(&status_box);
                    }
                }
                Sent::Over => return,
            }
        }
    })
}

fn agent(place: &Path, clock: ClockKind) -> (Agent, EndpointHandle) {
    agent_at(place, Endpoint::new(Role::DataSystem, clock).unwrap())
}

fn agent_at(place: &Path, endpoint: Endpoint) -> (Agent, EndpointHandle) {
    let handle = endpoint.handle();
    (
        Agent::new(endpoint, Outbox::open(&place.join("outbox")).unwrap()).with_reply_limit(Duration::ZERO),
        handle,
    )
}

fn command(number: u32, command: DataBaseVerb, position: &str) -> DataBaseCommand {
    DataBaseCommand {
        number,
        command,
        item: Name16::new("LINKBAR1").unwrap(),
        serial: Name16::new("17").unwrap(),
        position: Name10::new(position).unwrap(),
        sector: Some(4),
    }
}

fn bytes(number: u32, verb: DataBaseVerb, position: &str) -> Vec<u8> {
    let (bytes, length) = command::encode(&command(number, verb, position)).unwrap();
    bytes[..length].to_vec()
}

fn update(number: u32, position: &str) -> Vec<u8> {
    bytes(number, DataBaseVerb::Update, position)
}

fn id(bytes: &[u8]) -> u16 {
    command::decode(bytes).unwrap().command_id
}

fn status(command_id: u16, summary: Summary) -> Vec<u8> {
    Status { command_id, server: ServerStatus::Ready, summary }.encode().to_vec()
}

fn done(bytes: &[u8]) -> Written {
    vec![status(id(bytes), Summary::Done)]
}

fn is_done(answer: Option<Answer>, number: u16) {
    let answer = answer.expect("an answer");
    assert_eq!((answer.status.command_id, answer.status.summary), (number, Summary::Done), "{}", answer.why);
}

fn pending(agent: &Agent) -> usize {
    agent.outbox.pending().unwrap().len()
}

#[test]
fn lost_command_is_repeated_with_its_number() {
    let place = tempfile::tempdir().unwrap();
    let (mut agent, handle) = agent(place.path(), ClockKind::Fast);
    let (tell, heard) = mpsc::channel();
    let server = serve(&handle, move |read, bytes| {
        tell.send(bytes.to_vec()).unwrap();
        if read == 1 { Vec::new() } else { done(bytes) }
    });
    assert_eq!(agent.execute(&update(70, "UNIT_1")), None);
    let silent = Remark::Silent { command_id: 1, patience: Duration::ZERO };
    assert_eq!(agent.remarks(), [Remark::Network(NetEvent::Connected(Role::DataSystem)), silent]);
    assert_eq!(pending(&agent), 1);
    is_done(agent.execute(&update(71, "UNIT_1")), 71);
    assert_eq!(pending(&agent), 0);
    is_done(agent.execute(&update(72, "UNIT_1")), 72);
    drop(agent);
    server.join().unwrap();
    let [first, again, later] = &heard.iter().collect::<Vec<_>>()[..] else { panic!("three were sent") };
    assert_eq!(first, again);
    assert_eq!([id(first), id(later)], [1, 2], "a repetition after the answer is a new command");
}

#[test]
fn late_answer_is_accepted_once() {
    let place = tempfile::tempdir().unwrap();
    let (mut agent, handle) = agent(place.path(), ClockKind::Fast);
    let server = serve(&handle, |_, _| Vec::new());
    assert_eq!(agent.execute(&update(1, "UNIT_1")), None);
    let mut status_box = Mailbox::initialized(DATA_SYSTEM_STATUS);
    status_box.write(&status(1, Summary::Done)).unwrap();
    handle.deliver(DATA_SYSTEM_STATUS, status_box.used()).unwrap();
    agent.idle();
    is_done(agent.execute(&update(2, "UNIT_1")), 2);
    assert_eq!(agent.execute(&update(3, "UNIT_2")), None);
    assert_eq!(pending(&agent), 1);
    drop(agent);
    server.join().unwrap();
}

/// In an earlier version, a repeated answer to STARTUP marked the next update as done.
#[test]
fn repeated_answer_does_not_answer_the_next_request() {
    let place = tempfile::tempdir().unwrap();
    let (mut agent, handle) = agent(place.path(), ClockKind::Fast);
    let kept = update(1, "UNIT_1");
    agent.outbox.keep(kept[..].try_into().unwrap()).unwrap();
    let (mut answered, mut deaf) = (Vec::new(), true);
    let server = serve(&handle, move |_, bytes| {
        if bytes.len() == DML && std::mem::take(&mut deaf) {
            return answered.clone();
        }
        answered = done(bytes);
        answered.clone()
    });
    assert_eq!(agent.execute(&bytes(6, DataBaseVerb::Startup, "")), None);
    assert_eq!(pending(&agent), 1);
    is_done(agent.execute(&bytes(7, DataBaseVerb::Startup, "")), 7);
    assert_eq!(pending(&agent), 0);
    drop(agent);
    server.join().unwrap();
}

#[test]
fn answers_to_other_commands_and_partial_answers_are_ignored() {
    for (offset, summary) in [
        (1, Summary::Done),
        (u16::MAX, Summary::Done),
        (1, Summary::Refused(Refusal::Value)),
        (0, Summary::None),
    ] {
        let place = tempfile::tempdir().unwrap();
        let (mut agent, handle) = agent(place.path(), ClockKind::Fast);
        let server = serve(&handle, move |_, bytes| vec![status(id(bytes).wrapping_add(offset), summary)]);
        for number in 1..5 {
            // In the second half each command differs, so that the number answered too early is used.
            let position = if number < 3 { "UNIT_1" } else { "UNIT_2" };
            assert_eq!(agent.execute(&update(number, position)), None);
        }
        assert_eq!(pending(&agent), 2);
        drop(agent);
        server.join().unwrap();
    }
}

#[test]
fn garbled_status_is_ignored_and_reported_with_its_content() {
    let right = |bytes: &[u8]| done(bytes).remove(0);
    let garbles: [(&str, Garble); 6] = [
        ("a status of 14 bytes was expected, found 13", |status| status.truncate(13)),
        ("a status of 14 bytes was expected, found 0", Vec::clear),
        ("a status of 14 bytes was expected, found 248", |status| *status = vec![0xFF; 248]),
        ("byte A1 was expected at 0, found A0", |status| status[0] = 0xA0),
        ("a server status from 00 to 02 was expected at 10, found 09", |status| status[10] = 9),
        ("a summary status 00, 01 or 80 to 84 was expected at 13, found 53", |status| status[13] = 83),
    ];
    for (text, garble) in garbles {
        let place = tempfile::tempdir().unwrap();
        let (mut agent, handle) = agent(place.path(), ClockKind::Fast);
        let server = serve(&handle, move |read, bytes| {
            let mut status = right(bytes);
            if read == 1 {
                garble(&mut status);
            }
            vec![status]
        });
        assert_eq!(agent.execute(&update(1, "UNIT_1")), None, "{text}");
        assert_eq!(pending(&agent), 1, "{text}");
        let said: Vec<_> = agent.remarks().iter().skip(1).map(ToString::to_string).collect();
        let garbled = format!(
            "{DATA_SYSTEM_STATUS} cannot be read, the Data System is treated as not answering: {text}"
        );
        assert_eq!(said, [garbled, "the Data System has not answered command 1 for 0 s".to_owned()]);
        is_done(agent.execute(&update(2, "UNIT_1")), 2);
        assert_eq!(pending(&agent), 0, "{text}");
        drop(agent);
        server.join().unwrap();
    }
}

#[test]
fn garbled_status_is_reported_once_during_the_wait() {
    let place = tempfile::tempdir().unwrap();
    let (agent, handle) = agent(place.path(), ClockKind::Fast);
    let mut agent = agent.with_reply_limit(Duration::MAX);
    let mut session = TestSession::begin(&handle);
    let server = thread::spawn(move || {
        let mut status_box = Mailbox::initialized(DATA_SYSTEM_STATUS);
        for pulses in 1..=5 {
            let tick = session.pulse();
            let bytes = if pulses < 5 { vec![pulses] } else { status(1, Summary::Done) };
            status_box.write(&bytes).unwrap();
            session.deliver(&status_box);
            session.answer(tick);
        }
        session
    });
    is_done(agent.execute(&update(9, "UNIT_1")), 9);
    let garbled = Remark::Garbled(StatusError::Size(1));
    assert_eq!(agent.remarks(), [Remark::Network(NetEvent::Connected(Role::DataSystem)), garbled]);
    server.join().unwrap();
}

#[test]
fn new_server_with_restarted_numbers_is_read() {
    let place = tempfile::tempdir().unwrap();
    let (mut agent, handle) = agent(place.path(), ClockKind::Fast);
    for number in 1..4 {
        // Its statuses have the same mailgram numbers as those of the previous server.
        let server = serve(&handle, |_, bytes| done(bytes));
        is_done(agent.execute(&update(number, "UNIT_1")), number.try_into().unwrap());
        handle.detach(Disconnect::Lost("it was killed".to_owned()));
        server.join().unwrap();
    }
}

#[test]
fn stopped_endpoint_ends_the_wait_for_a_silent_server() {
    for clock in [ClockKind::Fast, ClockKind::Real] {
        let place = tempfile::tempdir().unwrap();
        let (agent, handle) = agent(place.path(), clock);
        let mut agent = agent.with_reply_limit(Duration::MAX);
        let stop_handle = agent.stop_handle();
        let server = serve(&handle, move |_, _| {
            stop_handle.stop();
            Vec::new()
        });
        assert_eq!(agent.execute(&update(1, "UNIT_1")), None);
        assert_eq!(agent.execute(&update(2, "UNIT_2")), None);
        assert_eq!(pending(&agent), 2, "the next run sends them");
        drop(agent);
        server.join().unwrap();
    }
}

/// The agent has no time limit, so only the end of the run ends its wait.
#[test]
fn interrupted_run_does_not_wait_for_a_silent_server() {
    for (clock, pace) in [(ClockKind::Fast, Pace::Wait), (ClockKind::Real, Pace::Poll)] {
        let place = tempfile::tempdir().unwrap();
        let flag = Arc::new(AtomicBool::new(false));
        let endpoint = Endpoint::new(Role::DataSystem, clock).unwrap().until(Arc::clone(&flag));
        let ((agent, handle), (tell, heard)) = (agent_at(place.path(), endpoint), mpsc::channel());
        let server = serve(&handle, move |_, _| {
            flag.store(true, std::sync::atomic::Ordering::Relaxed);
            tell.send(()).unwrap();
            Vec::new()
        });
        let mut system = data_system::elsewhere(agent.with_reply_limit(Duration::MAX), pace);
        system.step(Tick(1), &DataBaseCommand::default());
        let abort = command(1, DataBaseVerb::Abort, "");
        system.step(Tick(2), &abort);
        heard.recv().unwrap();
        for tick in 3..50 {
            system.step(Tick(tick), &abort);
            assert_eq!(system.status().report, DataBaseReport::Executing);
        }
        assert_eq!(system.items().unwrap(), []);
        drop(system);
        server.join().unwrap();
    }
}

#[test]
fn task_retries_with_a_silent_server() {
    let place = tempfile::tempdir().unwrap();
    let (agent, handle) = agent(place.path(), ClockKind::Fast);
    let server = serve(&handle, |read, bytes| if read == 1 { Vec::new() } else { done(bytes) });
    let mut system = data_system::elsewhere(agent, Pace::Wait);
    system.step(Tick(1), &DataBaseCommand::default());
    let reports = [1, 2].map(|number| {
        let first = u64::from(number) * 250;
        let abort = command(number, DataBaseVerb::Abort, "");
        (first..first + 250).for_each(|tick| system.step(Tick(tick), &abort));
        assert_eq!(system.status().echo, number);
        let silent = Remark::Silent { command_id: 1, patience: Duration::ZERO };
        assert_eq!(system.keeper().remarks().contains(&silent), number == 1);
        system.status().report
    });
    assert_eq!(reports, [DataBaseReport::Executing, DataBaseReport::Done]);
    assert_eq!(system.refusals(), Vec::<String>::new());
    drop(system);
    server.join().unwrap();
}
