//! The lines of a job that begin with `**`: the action of each, and the message for each error.

use std::path::Path;

use interfaces::station::{
    BoxAction, BoxButton, BoxFrame, EStop, Key, LineVerb, ResolverKey, Stepped, TableKey, ViseOpening,
    following,
};
use rcs_core::name::Name16;
use taskdata::load::{
    Job, Source, Step, Store, Workstation,
    job::{Drum, Offset},
    source::read_blocks_under,
};

fn store() -> Store {
    let sound = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/sound"));
    match Store::from_sources(read_blocks_under(sound).0) {
        Ok((store, _)) => store,
        Err(report) => panic!("{report}"),
    }
}

fn load(text: &str) -> Result<Vec<Step>, String> {
    let source = Source { name: "try.job".into(), text: text.into() };
    match Job::from_source(source, &store()) {
        Ok((job, _)) => Ok(job.steps.into_iter().map(|line| line.step).collect()),
        Err(report) => Err(report.to_string()),
    }
}

fn action(line: &str) -> Workstation {
    match load(line).unwrap_or_else(|report| panic!("{report}"))[..] {
        [Step::Workstation(action)] => action,
        ref other => panic!("{line}: {other:?}"),
    }
}

fn name(text: &str) -> Name16 {
    Name16::new(text).unwrap()
}

#[test]
fn tray_vise_and_machine() {
    let Workstation::Tray { location, object, offset } = action("** tray UNIT_1 4 LINKBAR1_BH 50 -20 1500")
    else {
        panic!()
    };
    assert_eq!((location.name.as_str(), location.sector, object), ("UNIT_1", Some(4), name("LINKBAR1_BH")));
    assert_eq!(offset, Some(Offset { x: 50, y: -20, angle: 1500 }));
    let random = action("** tray UNIT_1 4 LINKBAR1_BH");
    assert!(matches!(random, Workstation::Tray { offset: None, .. }));
    for (word, opening) in
        [("partial", ViseOpening::Partial), ("close", ViseOpening::Close), ("open", ViseOpening::Open)]
    {
        let plain = action(&format!("** vise {word} PFIXTURE"));
        assert!(matches!(plain, Workstation::Vise { opening: o, program: None, .. } if o == opening));
        let named = action(&format!("** vise {word} PFIXTURE CLEVIS"));
        assert!(
            matches!(named, Workstation::Vise { opening: o, program: Some(p), .. } if o == opening && p == name("CLEVIS"))
        );
    }
    let machine = action("** machine LINKBAR1_BH LINKBAR1 PFIXTURE");
    let Workstation::Machine { blank, part, location } = machine else { panic!() };
    assert_eq!((blank, part, location.name.as_str()), (name("LINKBAR1_BH"), name("LINKBAR1"), "PFIXTURE"));
}

#[test]
fn drum_and_wait() {
    assert_eq!(action("** drum grip"), Workstation::Drum(Drum::Grip));
    assert_eq!(action("** drum release"), Workstation::Drum(Drum::Release));
    assert_eq!(action("** drum tool LINKBAR1"), Workstation::Drum(Drum::Tool(name("LINKBAR1"))));
    assert_eq!(action("** wait 50"), Workstation::Wait { ticks: 50 });
    assert_eq!(action("** workstation"), Workstation::HandOver);
}

#[test]
fn resolver_electronics() {
    assert_eq!(action("** resolvers manual"), Workstation::Resolvers(ResolverKey::Manual(true)));
    assert_eq!(action("** resolvers auto"), Workstation::Resolvers(ResolverKey::Manual(false)));
    assert_eq!(action("** resolvers joint 5"), Workstation::Resolvers(ResolverKey::Joint(5)));
    let report = load("** resolvers joint 6").unwrap_err();
    assert!(report.contains("number of a joint"), "{report}");
}

#[test]
fn command_that_must_fail_is_accepted() {
    let steps = |text: &str| {
        let source = Source { name: "try.job".into(), text: text.into() };
        Job::from_source(source, &store()).map(|(job, _)| job.steps).map_err(|report| report.to_string())
    };
    let expecting =
        |text: &str| steps(text).unwrap().iter().map(|line| line.expects_error).collect::<Vec<_>>();
    let lines = "== PAUSE -- +0 -- 0 +0 -- 0 -- 0\n\
                 == PAUSE -- +0 -- 0 +0 -- 0 -- 0 expect error\n\
                 == PAUSE -- +0 -- 0 +0 -- 0 -- 0 #17 expect error\n";
    assert_eq!(expecting(lines), [false, true, true]);
    let other = steps("== PAUSE -- +0 -- 0 +0 -- 0 -- 0 expect finished").unwrap_err();
    assert!(other.contains("error was expected after expect"), "{other}");
    assert!(steps("** wait 5 expect error").is_err(), "nothing fails");
}

#[test]
fn the_joystick_box() {
    let frames = [
        ("WORLD", BoxFrame::World),
        ("TOOL", BoxFrame::Tool),
        ("TOOL-ORIGIN", BoxFrame::ToolOrigin),
        ("WRIST-ORIGIN", BoxFrame::WristOrigin),
        ("OFF", BoxFrame::Off),
    ];
    let buttons = [
        ("up", BoxButton::Up),
        ("down", BoxButton::Down),
        ("roll+", BoxButton::RollPlus),
        ("roll-", BoxButton::RollMinus),
        ("open", BoxButton::Open),
        ("close", BoxButton::Close),
    ];
    let processes = [
        ("TASK", Stepped::Task),
        ("SUBTASK", Stepped::Subtask),
        ("EMOVE", Stepped::Emove),
        ("PRIM", Stepped::Prim),
    ];
    let mut expected: Vec<(String, BoxAction)> = vec![
        ("stick 1000 -500 25".into(), BoxAction::Stick { x: 1000, y: -500, ticks: 25 }),
        ("stick 0 0 0".into(), BoxAction::Stick { x: 0, y: 0, ticks: 0 }),
        ("stick 0 0 25".into(), BoxAction::Stick { x: 0, y: 0, ticks: 25 }),
        ("velocity 500".into(), BoxAction::Velocity(500)),
        ("record".into(), BoxAction::Record),
        ("resume".into(), BoxAction::Resume),
    ];
    expected.extend(frames.map(|(word, frame)| (format!("frame {word}"), BoxAction::Frame(frame.bits()))));
    expected.extend(buttons.map(|(word, button)| (format!("{word} 7"), BoxAction::Press(button, 7))));
    for (word, process) in processes {
        expected.push((format!("hold {word}"), BoxAction::Hold(process.bit())));
        expected.push((format!("free {word}"), BoxAction::Free(process.bit())));
        expected.push((format!("step {word}"), BoxAction::Step(process.bit(), 1)));
        expected.push((format!("step {word} 3"), BoxAction::Step(process.bit(), 3)));
    }
    for (line, joystick) in expected {
        assert_eq!(action(&format!("** joystick {line}")), Workstation::Joystick(joystick), "{line}");
    }
}

#[test]
fn emergency_stops_and_the_panel_of_the_robot_controller() {
    let sites = [
        ("control-panel", EStop::ControlPanel),
        ("teach-pendant", EStop::TeachPendant),
        ("terminals", EStop::Terminals),
        ("joystick-box", EStop::JoystickBox),
        ("pedestal", EStop::Pedestal),
    ];
    for (word, site) in sites {
        assert_eq!(action(&format!("** estop {word}")), Workstation::Press(site));
        assert_eq!(action(&format!("** release {word}")), Workstation::Release(site));
    }
    let keys = [
        ("power on", Key::ControlPower(true)),
        ("power off", Key::ControlPower(false)),
        ("fault-reset", Key::FaultReset),
        ("hydraulics enable", Key::Hydraulics(true)),
        ("hydraulics disable", Key::Hydraulics(false)),
        ("manual on", Key::Manual(true)),
        ("manual off", Key::Manual(false)),
        ("align", Key::Align(None)),
        ("align 6", Key::Align(Some(6))),
        ("auto", Key::Auto),
        ("cycle-start", Key::CycleStart),
        ("interrupt", Key::Interrupt),
        ("cancel", Key::Cancel),
        ("enter", Key::Enter),
        ("hold on", Key::Hold(true)),
        ("hold off", Key::Hold(false)),
    ];
    for (words, key) in keys {
        assert_eq!(action(&format!("** panel {words}")), Workstation::Panel(key));
    }
    let keys = [
        ("power off", TableKey::Power(false)),
        ("mode manual", TableKey::Manual(true)),
        ("mode prog", TableKey::Manual(false)),
        ("run+ 25", TableKey::Run { plus: true, ticks: 25 }),
        ("run- 1", TableKey::Run { plus: false, ticks: 1 }),
        ("step+", TableKey::Step { plus: true, count: 1 }),
        ("step- 30", TableKey::Step { plus: false, count: 30 }),
        ("reset", TableKey::Reset),
    ];
    for (words, key) in keys {
        assert_eq!(action(&format!("** table {words}")), Workstation::Table(key));
    }
}

fn lines_from(words: &[&'static str]) -> Vec<String> {
    let Some(lists) = following(words) else { return vec![words.join(" ")] };
    let next = lists.iter().flat_map(|list| list.variants);
    next.flat_map(|variant| lines_from(&[words, &[variant.text]].concat())).collect()
}

#[test]
fn grammar_lines_are_job_lines_and_documented() {
    let page = include_str!("../../../data/README.md");
    let verbs = LineVerb::ALL.iter().map(|verb| verb.text()).filter(|verb| following(&[verb]).is_some());
    let lines: Vec<String> = verbs.flat_map(|verb| lines_from(&[verb])).collect();
    assert!(lines.len() > 60, "{}", lines.len());
    for line in lines {
        let endings = ["", " 1", " 1 1 1", " PFIXTURE", " LINKBAR1"]; // that some words require
        let read = endings.iter().any(|ending| load(&format!("** {line}{ending}")).is_ok());
        assert!(read, "{line}: {:?}", load(&format!("** {line}")));
        for word in line.split(' ').filter(|word| word.parse::<u8>().is_err()) {
            assert!(page.contains(word), "data/README.md does not have {word}");
        }
    }
}

#[test]
fn path_after_a_restart_may_begin_at_home() {
    let there = "== MOVE -- +0 -- 0 +0 SAFE 0 -- 0";
    let on = "== MOVE -- +0 -- 0 +0 PFIXTURE 0 -- 0";
    let said = load(&format!("{there}\n{on}")).expect_err("no trajectory leads from SAFE to PFIXTURE");
    assert!(said.contains("no trajectory leads from SAFE"), "{said}");
    assert!(load(&format!("{there}\n** panel auto\n{on}")).is_ok());
}

#[test]
fn events_during_a_command_precede_it() {
    let steps = load("** after 50 joystick hold PRIM\n== MOVE -- +0 -- 0 +0 HOME 0 -- 0").unwrap();
    let held = Workstation::Joystick(BoxAction::Hold(Stepped::Prim.bit()));
    assert_eq!(steps[0], Step::After { ticks: 50, action: held });
    assert!(matches!(steps[1], Step::Command(_)));
}

#[test]
fn every_job_error_has_its_message() {
    for (line, message, help) in [
        (
            "** vice open PFIXTURE",
            "column 4: no step of the workstation is named vice",
            "the nearest is vise",
        ),
        (
            "**",
            "column 1: tray, vise, machine, drum, joystick, estop, release, panel, table, resolvers, wait, load, after, \
             workstation was expected, the line ends",
            "",
        ),
        (
            "** vise shut PFIXTURE",
            "column 9: no opening of a vise is named shut",
            "there are partial, close, open",
        ),
        ("** vise open", "column 9: a vise was expected, the line ends", ""),
        (
            "** vise open PFIXTUR",
            "column 14: no location point, owner or array is named PFIXTUR",
            "the nearest known name is PFIXTURE",
        ),
        ("** vise open PFIXTURE CLEVIS 3", "column 30: the line should end before 3", ""),
        (
            "** tray UNIT_1 four LINKBAR1_BH",
            "column 16: a sector, a whole number, was expected; four found",
            "** tray UNIT SECTOR OBJECT, or with X Y ANGLE after it",
        ),
        (
            "** machine LINKBAR1_B LINKBAR1 PFIXTURE",
            "column 12: no object is named LINKBAR1_B",
            "the nearest known name is LINKBAR1_BH",
        ),
        ("** drum clamp", "column 9: no step of the drum is named clamp", "there are grip, release, tool"),
        ("** drum tool", "column 9: a tool was expected, the line ends", ""),
        (
            "** drum tool LINKBAR",
            "column 14: no object is named LINKBAR",
            "the nearest known name is LINKBAR1",
        ),
        (
            "** joystick stik 1 2 3",
            "column 13: no part of the joystick box is named stik",
            "the nearest is stick",
        ),
        (
            "** joystick frame WORD",
            "column 19: no frame of the joystick box is named WORD",
            "the nearest is WORLD",
        ),
        (
            "** joystick stick 2000 0 5",
            "column 19: x of the stick is -1000 to 1000, 2000 found",
            "** joystick stick X Y TICKS, X and Y from -1000 to 1000",
        ),
        (
            "** joystick stick 0 -1001 5",
            "column 21: y of the stick is -1000 to 1000, -1001 found",
            "** joystick stick X Y TICKS",
        ),
        (
            "** joystick stick 1 0 0",
            "column 23: a number of ticks is 1 to 36000, 0 found",
            "stick 0 0 releases it",
        ),
        ("** joystick stick 0 0", "column 21: a number of ticks was expected, the line ends", ""),
        (
            "** joystick up 0",
            "column 16: a number of ticks is 1 to 36000, 0 found",
            "** joystick up|down|roll+|roll-|open|close TICKS",
        ),
        (
            "** joystick velocity -1",
            "column 22: the velocity is 0 to 1000, -1 found",
            "** joystick velocity N, from 0 to 1000",
        ),
        (
            "** joystick hold E-MOVE",
            "column 18: no process that the joystick box can hold is named E-MOVE",
            "the nearest is EMOVE",
        ),
        (
            "** joystick step PRIM many",
            "column 23: a count, a whole number, was expected; many found",
            "** joystick step PROCESS, or with a COUNT after it",
        ),
        (
            "** estop door",
            "column 10: no emergency stop is named door",
            "there are control-panel, teach-pendant, terminals, joystick-box, pedestal",
        ),
        ("** release", "column 4: control-panel, teach-pendant", ""),
        ("** estop pedestal 3", "column 19: the line should end before 3", ""),
        ("** panel siren", "column 10: no key of the robot controller is named siren", "there are power, "),
        ("** panel manual", "column 10: on, off was expected, the line ends", ""),
        (
            "** panel hydraulics on",
            "column 21: no position of the keyswitch is named on",
            "there are enable, disable",
        ),
        ("** panel align 7", "column 16: an axis is 1 to 6, 7 found", "** panel align, or with an AXIS"),
        ("** wait", "column 4: a number of ticks was expected, the line ends", ""),
        ("** load", "column 4: a file of blocks was expected, the line ends", ""),
        ("** load no-such.blk", "column 9: no-such.blk cannot be read", ""),
        (
            "** wait 50000",
            "column 9: a number of ticks, a whole number, was expected; 50000 found",
            "** wait TICKS; a tick is 40 ms",
        ),
        (
            "** after 5 wait 3",
            "column 12: this action has its own duration and cannot follow after",
            "** after TICKS, then another line's words behind its **",
        ),
        (
            "** after 5 drum grip",
            "column 4: no command follows this line",
            "after counts its ticks from the next line with ==; ** wait waits by itself",
        ),
    ] {
        let said = load(line).expect_err(line);
        assert!(said.contains(message), "{line}\nsaid {said}\nexpected {message}");
        assert!(said.contains(help), "{line}\nsaid {said}\nexpected {help}");
        assert_eq!(said.matches("error: ").count(), 1, "one mistake, one message: {said}");
    }
}

#[test]
fn serial_number_may_follow_the_nine_fields() {
    let serial = |line: &str| match load(line).unwrap_or_else(|report| panic!("{report}"))[..] {
        [Step::Command(command)] => command.serial,
        ref other => panic!("{line}: {other:?}"),
    };
    assert_eq!(serial("== MOVE -- +0 -- 0 +0 HOME 0 -- 0"), Name16::EMPTY);
    assert_eq!(serial("== MOVE -- +0 -- 0 +0 HOME 0 -- 0 #17"), name("17"));
    let long = load("== MOVE -- +0 -- 0 +0 HOME 0 -- 0 #12345678901234567").unwrap_err();
    assert!(long.contains("serial number: a name of at most 16 characters was expected"), "{long}");
    let empty = load("== MOVE -- +0 -- 0 +0 HOME 0 -- 0 #").unwrap_err();
    assert!(empty.contains("the line should end before #"), "{empty}");
}
