//! Neighbours that answer no pulse: on the 40 ms grid the robot continues without them.

use std::thread;

use rustix::process::{Pid, Signal, kill_process};
use sessions::network::{Peer, Role};
use whole_system_tests::Scratch;

use super::bench::{Controller, Workstation, bare};

const TOLD: &str = "the controller says: no answer for 10 s"; // the last message to a hung neighbour

/// Reads bytes without answering, as the system does for a stopped program. Returns the last message.
fn hang(mut peer: Peer) -> String {
    loop {
        if let Err(error) = peer.receive() {
            return error.to_string();
        }
    }
}

#[test]
fn hung_neighbour_is_disconnected_without_stopping_the_robot() {
    const HUNG: [Role; 3] = [Role::DataSystem, Role::Pedestal, Role::Vision];
    let outside = "workstation,data-system,pedestal,vision";
    let scratch = Scratch::new("hung");
    let outbox = scratch.file("outbox").display().to_string();
    let more = ["--clock", "real", "--outbox", &outbox];
    let controller = Controller::start_at(scratch, None, outside, &more);
    let mut workstation = Workstation::connect(&controller);
    let hung = HUNG.map(|role| {
        let peer = controller.connect(role);
        thread::spawn(move || hang(peer))
    });
    workstation.send(&bare(1, "STARTUP")); // it waits for the Data System, which gets no request before
    while !hung.iter().all(thread::JoinHandle::is_finished) {
        workstation.tick();
    }
    for (role, told) in HUNG.into_iter().zip(hung) {
        assert_eq!(told.join().expect("it has not panicked"), TOLD, "{role}");
    }
    // The page shows only the first events, so all three must be recorded before.
    (0..5).for_each(|_| workstation.tick());
    for role in HUNG {
        drop(controller.connect(role));
    }
    assert_eq!(workstation.carry_out(&bare(2, "PAUSE")).0, "finished");
    assert_eq!(hang(workstation.peer), TOLD);
    drop(Workstation::connect(&controller));
    kill_process(Pid::from_child(&controller.child), Signal::TERM).expect("it runs");
    let ended = controller.end();
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    for role in HUNG {
        let gone = format!("{role} has disconnected: no answer for 10 s");
        assert!(ended.page.contains(&gone), "{gone}: {}", ended.page);
    }
}
