//! Neighbours that do not answer: a run in fast clock waits until its own end. A Data System that answers pulses, but
//! not its requests, is asked again.

use std::{
    sync::mpsc::{Receiver, Sender, channel},
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use neighbours::{
    data_system::{
        command,
        status::{ServerStatus, Status, Summary},
    },
    mailbox::{DATA_SYSTEM_COMMAND, DATA_SYSTEM_STATUS, Mailbox},
};
use rustix::process::{Pid, Signal, kill_process};
use sessions::network::{Peer, Received, Role};
use whole_system_tests::Scratch;

use super::bench::{Controller, Ended, TIME_LIMIT, Workstation, attend, bare};

const LONG: usize = 50; // more than enough

fn start(
    clock: &str,
    serve: impl FnOnce(Peer) + Send + 'static,
) -> (Controller, Workstation, JoinHandle<()>) {
    let scratch = Scratch::new("silent");
    let outbox = scratch.file("outbox").display().to_string();
    let more = ["--clock", clock, "--outbox", &outbox];
    let controller = Controller::start_at(scratch, None, "workstation,data-system", &more);
    let peer = controller.connect(Role::DataSystem);
    let data_system = thread::spawn(move || serve(peer));
    let workstation = Workstation::connect(&controller);
    (controller, workstation, data_system)
}

fn terminate(mut controller: Controller) -> Ended {
    kill_process(Pid::from_child(&controller.child), Signal::TERM).expect("it runs");
    let asked = Instant::now();
    while controller.child.try_wait().expect("a child").is_none() {
        assert!(asked.elapsed() < TIME_LIMIT, "it does not end");
        thread::sleep(Duration::from_millis(10));
    }
    controller.end()
}

fn follow(mut workstation: Workstation) {
    let _ = workstation.peer.pulse(workstation.tick); // after the end of the run, reading fails, too
    attend(workstation.peer);
}

/// Answers some pulses, then only reads.
fn fall_silent(mut peer: Peer, answers: usize, tell: &Sender<()>) {
    let mut pulses = 0;
    while let Ok(received) = peer.receive() {
        let Received::Pulse(pulse) = received else { continue };
        if pulses < answers && peer.pulse(pulse).is_err() {
            return;
        }
        if pulses == answers {
            tell.send(()).expect("the test listens");
        }
        pulses += 1;
    }
}

#[test]
fn a_run_can_be_ended_while_a_tick_waits_for_a_neighbour() {
    const STEPPED: [Role; 3] = [Role::Workstation, Role::Pedestal, Role::Vision];
    for silent in STEPPED {
        let (tell, heard) = channel();
        let controller = Controller::start("asked", "workstation,pedestal,vision", &["--clock", "fast"]);
        let peers = STEPPED.map(|role| {
            let (peer, tell) = (controller.connect(role), tell.clone());
            let answers = if role == silent { LONG } else { usize::MAX };
            thread::spawn(move || fall_silent(peer, answers, &tell))
        });
        heard.recv_timeout(TIME_LIMIT).expect("a tick waits");
        let ended = terminate(controller);
        assert_eq!(ended.status, Some(0), "{silent}: {}", ended.said);
        assert!(!ended.page.contains("has disconnected"), "{silent}: {}", ended.page);
        for peer in peers {
            peer.join().expect("it has not panicked");
        }
    }
}

#[test]
fn waiting_run_ends_on_request() {
    for clock in ["fast", "real"] {
        let (tell, heard) = channel();
        let (controller, mut workstation, data_system) = start(clock, move |mut peer| {
            let mut waited = 0;
            while let Ok(received) = peer.receive() {
                let Received::Pulse(pulse) = received else { continue };
                waited += usize::from(peer.mailbox(DATA_SYSTEM_COMMAND).mailgram() != 0);
                if waited == LONG {
                    tell.send(()).expect("the test listens");
                }
                if peer.pulse(pulse).is_err() {
                    return;
                }
            }
        });
        workstation.send(&bare(1, "STARTUP"));
        let workstation = thread::spawn(move || follow(workstation));
        heard.recv_timeout(TIME_LIMIT).expect("it is asked, and waited for");
        let ended = terminate(controller);
        assert_eq!(ended.status, Some(0), "{clock}: {}", ended.said);
        assert!(!ended.said.contains("cannot be listed"), "{clock}: {}", ended.said);
        for thread in [workstation, data_system] {
            thread.join().expect("it has not panicked");
        }
    }
}

/// Gives the first command this answer or none, and correct answers to all others. Returns the received commands.
fn connect_after(first: Option<&'static [u8]>) -> (Ended, Receiver<Vec<u8>>) {
    let (tell, heard) = channel();
    let (controller, mut workstation, data_system) = start("real", move |mut peer| {
        let (mut status_box, mut read) = (Mailbox::initialized(DATA_SYSTEM_STATUS), 0);
        while let Ok(received) = peer.receive() {
            let Received::Pulse(pulse) = received else { continue };
            let mailbox = peer.mailbox(DATA_SYSTEM_COMMAND);
            if mailbox.mailgram() != read {
                let command_id = command::decode(mailbox.data()).expect("a command").command_id;
                tell.send(mailbox.data().to_vec()).expect("the test listens");
                let done =
                    Status { command_id, server: ServerStatus::Ready, summary: Summary::Done }.encode();
                let answer = if read == 0 { first } else { Some(&done[..]) };
                read = mailbox.mailgram();
                if let Some(answer) = answer {
                    status_box.write(answer).expect("it fits");
                    peer.send(&status_box).expect("the controller reads");
                }
            }
            if peer.pulse(pulse).is_err() {
                return;
            }
        }
    });
    assert_eq!(workstation.carry_out(&bare(1, "STARTUP")).0, "finished");
    let ended = terminate(controller);
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    data_system.join().expect("it has not panicked");
    (ended, heard)
}

#[test]
fn lost_command_is_repeated() {
    let (ended, heard) = connect_after(None);
    let silent = "the Data System has not answered command 1 for 10 s";
    assert!(ended.page.contains(silent), "{}", ended.page);
    let [first, again] = [heard.recv(), heard.recv()];
    assert_eq!(first, again);
}

#[test]
fn a_garbled_answer_is_an_event_and_the_command_is_requested_again() {
    let (ended, heard) = connect_after(Some(b"what?"));
    let found = "a status of 14 bytes was expected, found 5";
    assert!(ended.page.contains(found), "{}", ended.page);
    assert!(!ended.page.contains("refuses"), "{}", ended.page);
    let [first, again] = [heard.recv(), heard.recv()];
    assert_eq!(first, again);
}
