//! Vision in another process (IX.4, V.2.1): the same bits as in the cell. For any of its answers the arm makes only
//! motions that E-move has checked.

use std::{
    fs,
    path::Path,
    process::{Child, Command, Output, Stdio},
    thread::{self, JoinHandle},
};

use interfaces::{
    HwsCommand,
    device::{VisionRequest, VisionResponse, VisionStatus},
};
use neighbours::{
    mailbox::{Mailbox, VISION_PICTURE, VISION_REQUEST, VISION_RESPONSE},
    vision::{Areas, Picture, Ready, request},
};
use rcs_core::name::Name16;
use sessions::network::{Peer, Received, Role};
use whole_system_tests::{Scratch, golden, rcs_log, rcs_neighbour, root};

use super::bench::{Controller, Ended, Workstation, bare};

struct Vision(Child); // ends with the test

impl Vision {
    fn start(program: &Path, address: &str, more: &[&str]) -> Self {
        let child = Command::new(program)
            .args(["vision", "--network", address])
            .args(more)
            .current_dir(root())
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn();
        Self(child.expect("rcs-neighbour can be started"))
    }
}

impl Drop for Vision {
    fn drop(&mut self) {
        let _ = self.0.kill(); // it waits for another run
        let _ = self.0.wait();
    }
}

fn linkbar(name: &str, faults: &str) -> Ended {
    let program = rcs_neighbour();
    let controller = Controller::start(name, "vision", &["linkbar"]);
    let _vision = Vision::start(program, &controller.address.to_string(), &["--fault", faults]);
    controller.end()
}

fn after<'t>(text: &'t str, word: &str) -> &'t str {
    let mut lines = text.lines().filter_map(|line| line.trim_start().strip_prefix(word));
    lines.next().unwrap_or_else(|| panic!("no {word} in {text}")).trim()
}

/// Each run equals its golden. One process analyses all pictures.
#[test]
fn jobs_have_the_same_bits_with_vision_in_another_process() {
    let program = rcs_neighbour();
    let (scratch, scenarios) = (Scratch::new("vision-bits"), golden::scenarios());
    let address = format!("unix:{}", scratch.file("rcs.sock").display());
    let _vision = Vision::start(program, &address, &[]);
    for name in [
        "linkbar",
        "clevis",
        "turned-part",
        "linkbar-seed-7",
        "blank-askew",
        "noisy-cell",
        "camera-blind",
        "camera-silent",
    ] {
        let scenario = scenarios.iter().find(|scenario| scenario.name == name).expect("a golden");
        let (seed, faults) = (scenario.seed.to_string(), scenario.faults.as_ref());
        let faults = faults.map(|faults| root().join("data/faults").join(faults).display().to_string());
        let mut more = vec![scenario.job.as_str(), "--json", "--seed", seed.as_str()];
        more.extend(faults.iter().flat_map(|faults| ["--faults", faults.as_str()]));
        let controller = Controller::start_at(Scratch::new(name), Some(&address), "vision", &more);
        let ended = controller.end();
        assert_eq!(ended.status, Some(scenario.status), "{name}: {}", ended.said);
        let known = fs::read_to_string(scenario.text()).expect("a summary");
        assert_eq!(ended.result["digest"], after(&known, "digest"), "{name}");
        assert_eq!(ended.result["allocations_after_start"], 0, "{name}");
    }
}

/// V.2.1 LOCATE-OBJ. Picture 1 is the fast flood, 2 the precise one.
#[test]
fn failed_pictures_are_repeated_and_given_up() {
    for (faults, reason) in [
        ("1-3:camera-blind", "vision sees no object"),
        ("1-3:not-recognised", "vision sees no object"),
        ("2-4:camera-blind", "vision sees no object"),
        ("2-4:not-recognised", "vision does not recognise the object"),
        ("2-4:another-object", "vision does not recognise the object"),
        ("1-3:outside", "vision answers what its camera cannot have seen"),
        ("2-4:outside", "vision answers what its camera cannot have seen"),
        ("2-4:turned", "vision answers what its camera cannot have seen"),
        ("2:off", "vision does not answer"),
    ] {
        let ended = linkbar("gives-up", faults);
        let last = ended.said.lines().last().unwrap_or_default();
        assert_eq!(ended.status, Some(1), "{faults}: {last}");
        let expected = format!("E-move: {reason}, while it executed LOCATE-OBJ LINKBAR1_BH at UNIT_1");
        assert!(last.contains(&expected), "{faults}: {last}");
    }
    for faults in ["1-2:camera-blind", "1:outside,3:another-object", "2:turned,3:not-recognised"] {
        let ended = linkbar("tries-again", faults);
        assert_eq!(ended.status, Some(0), "{faults}: {}", ended.said);
    }
}

/// An answer to another request has no effect, and is reported.
#[test]
fn invalid_answers_are_reported_and_cause_no_motion() {
    let silent = linkbar("silent", "1:off");
    let digest = after(&silent.page, "digest").to_owned();
    for (fault, said) in [
        ("another-echo", "an answer of vision is refused: request 4 was expected, found 5"),
        (
            "input-not-ready",
            "vision's answer to request 4 is not read: vision-ready-input 2 (ready) was expected, found 1",
        ),
        ("garbled", "what vision has written is refused: 99 is not a code of status"),
        ("truncated", "what vision has written is refused: a response of 18 bytes was expected, found 14"),
    ] {
        let ended = linkbar("no-answer", &format!("1:{fault}"));
        assert_eq!(ended.status, Some(1), "{fault}: {}", ended.said);
        let last = ended.said.lines().last().unwrap_or_default();
        assert!(last.contains("E-move: vision does not answer, while it executed LOCATE-OBJ"), "{last}");
        assert!(ended.page.contains(said), "{fault}: {}", ended.page);
        assert_eq!(after(&ended.page, "digest"), digest, "{fault}");
    }
    let ended = linkbar("occupied", "1:output-not-ready");
    let said = "request 5 to vision waits: vision-ready-output 2 (ready) was expected, found 1";
    assert!(ended.page.contains(said) && ended.status == Some(1), "{}", ended.page);
}

#[test]
fn a_run_without_its_vision_warns_and_starts() {
    let controller = Controller::start("blind", "vision", &["linkbar", "--wait", "1"]);
    let ended = controller.end();
    assert_eq!(ended.status, Some(1), "{}", ended.said);
    assert!(ended.said.contains("vision has not connected; the run begins without it"), "{}", ended.said);
    assert!(
        ended.said.contains("E-move: vision does not answer, while it executed LOCATE-OBJ"),
        "{}",
        ended.said
    );
    assert!(
        ended.page.contains("request 4 to vision waits: no vision system is connected"),
        "{}",
        ended.page
    );
}

/// This vision system would recognise none of the cell's parts.
#[test]
fn vision_with_another_cell_description_ends_with_the_reason() {
    let scratch = Scratch::new("another-cell");
    scratch.data_with("cell.toml", "shape_tolerance = 0.06", "shape_tolerance = 0.05");
    let data = scratch.file("data").display().to_string();
    let program = rcs_neighbour();
    let controller = Controller::start("cell", "vision", &["linkbar"]);
    let output: Output = Command::new(program)
        .args(["vision", "--network", &controller.address.to_string(), "--data", &data])
        .output()
        .expect("rcs-neighbour can be started");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("name the data of the run with --data"), "{said}");
    let ended = controller.end();
    assert!(ended.said.contains("vision does not answer"), "{}", ended.said);
}

#[test]
fn the_log_has_the_reason_and_replays_without_vision() {
    let program = rcs_neighbour();
    let scratch = Scratch::new("vision-why");
    let (log, socket) = (scratch.file("run.mcap"), scratch.file("rcs.sock").display().to_string());
    let address = format!("unix:{socket}");
    let _vision = Vision::start(program, &address, &["--fault", "2-4:turned"]);
    let ended = Command::new(whole_system_tests::rcs_run())
        .args(["linkbar", "--network", &address, "--outside", "vision", "--shared-memory", "off", "--log"])
        .arg(&log)
        .current_dir(root())
        .output()
        .expect("rcs-run can be started");
    assert_eq!(ended.status.code(), Some(1));
    let read = |command: &str, log: &Path| {
        let output = Command::new(rcs_log()).arg(command).arg(log).output().expect("rcs-log can be started");
        (output.status.code(), String::from_utf8_lossy(&output.stdout).into_owned())
    };
    let (_, why) = read("why", &log);
    assert!(why.contains("vision answers what its camera cannot have seen"), "{why}");
    let (status, replayed) = read("replay", &log);
    assert_eq!(status, Some(0), "{replayed}");
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fate {
    Answers,
    DiesAtOnce,      // before it has read the request
    DiesInTheMiddle, // after it has reported that it is busy
}

fn serve(mut peer: Peer, fate: Fate) -> JoinHandle<()> {
    thread::spawn(move || {
        let mut response_box = Mailbox::initialized(VISION_RESPONSE);
        let mut response = VisionResponse::default();
        let mut read = 0;
        while let Ok(received) = peer.receive() {
            let Received::Pulse(pulse) = received else { continue };
            let mailbox = peer.mailbox(VISION_REQUEST);
            if mailbox.mailgram() != read {
                read = mailbox.mailgram();
                if fate == Fate::DiesAtOnce {
                    return;
                }
                let request = request::decode(mailbox.data()).expect("a request");
                let picture = Picture::decode(peer.mailbox(VISION_PICTURE).data()).expect("a picture");
                assert_eq!(u32::from(picture.number), request.number);
                response = VisionResponse { status: VisionStatus::Busy, ..answer(&request, &picture) };
            } else if response.status == VisionStatus::Busy {
                if fate == Fate::DiesInTheMiddle {
                    return;
                }
                response.status = VisionStatus::Done;
            }
            let areas = Areas { input: Ready::Ready, output: Ready::Ready, response };
            let bytes = areas.encode().expect("it fits");
            if response_box.data() != bytes {
                response_box.write(&bytes).expect("it fits");
                if peer.send(&response_box).is_err() {
                    return;
                }
            }
            if peer.pulse(pulse).is_err() {
                return;
            }
        }
    })
}

fn answer(request: &VisionRequest, picture: &Picture) -> VisionResponse {
    let [part] = &picture.parts[..] else { panic!("{picture:?}") };
    let [x, y, z] = part.centre;
    let hundredths = |inches: f64| (inches * f64::from(request.range_mm) / 25.4 / x * 100.0).round() as i32;
    let [first, second] = part.edges;
    let ([_, across, up], _) = if (first.1 > second.1) == (request.grip.abs() == 1) { first } else { second };
    let angle = (up.atan2(across).to_degrees() * 100.0).round() as i32;
    VisionResponse {
        echo: request.number,
        status: VisionStatus::Done,
        y: hundredths(y),
        z: hundredths(z),
        angle: (angle + 9_000).rem_euclid(18_000) - 9_000,
        recognised: Some(request.object_id),
    }
}

fn fetch(number: u32) -> HwsCommand {
    let name = |text| Name16::new(text).expect("a name");
    HwsCommand {
        object: Some(name("LINKBAR1_BH")),
        source_grip: 2,
        source: Some(name("UNIT_1")),
        source_sector: Some(4),
        destination_grip: 2,
        destination: Some(name("PFIXTURE")),
        ..bare(number, "MOVE")
    }
}

/// Time stops until the next vision system connects and finds the unanswered request.
#[test]
fn restarted_vision_answers_the_pending_request() {
    for fate in [Fate::Answers, Fate::DiesAtOnce, Fate::DiesInTheMiddle] {
        let controller = Controller::start("vision-dies", "workstation,vision", &[]);
        let mut vision = serve(controller.connect(Role::Vision), fate);
        let mut workstation = Workstation::connect(&controller);
        assert_eq!(workstation.carry_out(&bare(1, "PAUSE")).0, "finished");
        workstation.in_cell("tray UNIT_1 4 LINKBAR1_BH 40 -30 1500");
        workstation.send(&fetch(2));
        let mut killed = 0;
        loop {
            workstation.tick();
            let status = workstation.status();
            if status.echo == 2 && status.report.text() == "finished" {
                break;
            }
            assert_ne!(status.report.text(), "error", "{fate:?}: {}", status.reason);
            if vision.is_finished() {
                killed += 1;
                vision = serve(controller.connect(Role::Vision), Fate::Answers);
            }
        }
        assert_eq!(killed, u32::from(fate != Fate::Answers), "{fate:?}");
        drop(workstation);
        let ended = controller.end();
        vision.join().expect("it has not panicked");
        assert_eq!(ended.status, Some(0), "{}", ended.said);
        let told = ended.page.matches("vision has connected").count();
        assert_eq!(told, if killed == 0 { 1 } else { 2 }, "{}", ended.page);
    }
}
