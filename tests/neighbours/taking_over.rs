//! An operator takes command from a workstation controller, and returns it (IV.4.1).

use std::time::Instant;

use executive::memory::operator_socket;
use interfaces::HwsCommand;
use neighbours::mailbox::HWSC_STATUS;
use rcs_core::name::Name16;
use sessions::operator::Client;

use super::bench::{Controller, TIME_LIMIT, Workstation, bare};

/// Repeats a request until it is accepted; the workstation controller reads meanwhile.
fn ask_until(client: &mut Client, workstation: &mut Workstation, request: &str, meanwhile: &[&str]) {
    let begun = Instant::now();
    while let Err(why) = client.ask(request).expect("the run answers") {
        assert!(meanwhile.iter().any(|reason| why.contains(reason)), "{request}: {why}");
        assert!(begun.elapsed() < TIME_LIMIT, "{request}: {why}");
        workstation.run_to(workstation.tick + 5);
    }
}

#[test]
fn commands_during_an_operator_session_are_not_executed_later() {
    let name = format!("taken-{}", std::process::id());
    let controller = Controller::start("taken", "workstation", &["--clock", "20x", "--run", &name]);
    let mut workstation = Workstation::connect(&controller);
    assert_eq!(workstation.carry_out(&bare(1, "PAUSE")).0, "finished");
    workstation.send(&HwsCommand { destination: Some(Name16::clipped("SAFE")), ..bare(2, "MOVE") });
    while (workstation.status().echo, workstation.status().report.text()) != (2, "executing") {
        workstation.tick();
    }
    let socket = operator_socket(&name.parse().expect("a name"));
    let mut client = Client::connect(&socket, &"anna".parse().expect("a name")).expect("the run listens");
    let refused = |client: &mut Client, request: &str| client.ask(request).expect("an answer").unwrap_err();
    assert!(refused(&mut client, "PAUSE").contains("`stand-alone` takes over"));
    assert!(refused(&mut client, "workstation").contains("commands already"));
    assert!(refused(&mut client, "stand-alone").contains("number 2, is executed"));
    client.ask("stand-alone now").expect("an answer").expect("it is taken");
    assert!(refused(&mut client, "stand-alone").contains("stand-alone already"));
    workstation.send(&bare(3, "PAUSE")); // ignored
    ask_until(&mut client, &mut workstation, "PAUSE", &[]);
    assert!(refused(&mut client, "workstation").contains("the robot at HOME"));
    let home = "MOVE -- 0 -- 0 0 HOME 0 -- 0";
    ask_until(&mut client, &mut workstation, home, &[]);
    let begun = Instant::now();
    while refused(&mut client, "workstation").contains("the robot at HOME") {
        assert!(begun.elapsed() < TIME_LIMIT, "the robot does not come to HOME");
        workstation.run_to(workstation.tick + 5);
    }
    assert!(refused(&mut client, "workstation").contains("PAUSE as the last command"));
    ask_until(&mut client, &mut workstation, "PAUSE", &[]);
    ask_until(&mut client, &mut workstation, "workstation", &["is not finished"]);
    workstation.run_to(workstation.tick + 50);
    while workstation.peer.mailbox(HWSC_STATUS).mailgram() == 0 {
        workstation.tick();
    }
    let last = workstation.status().echo;
    assert!(last >= 5, "the numbers are one sequence: {last}");
    assert_eq!(workstation.carry_out(&bare(u32::from(last) + 1, "PAUSE")).0, "finished");
    drop((client, workstation));
    controller.kill();
}
