//! The state band as a model, without a terminal: each state from its sensors.

use executive::memory::Text;
use interfaces::{ProcessId, Reason, device::GroupHealth, hws::HwsReport, operator::board_bit};
use programs::rcs_console::{
    model::{
        Model, Operating, Screen,
        band::{Band, Condition, band},
    },
    source::State,
    view::{Look, Scene, draw},
};
use ratatui::{Terminal, backend::TestBackend};
use rcs_core::{name::Name16, tick::Tick};
use record::{Level, reader::LogLine};

use crate::stage::Stage;

/// The console of an operator, and a run that executes a MOVE.
struct Desk {
    run: Stage,
    operating: Option<Operating>,
}

impl Desk {
    fn new() -> Self {
        let mut run = Stage::new();
        run.picture.external.devices.joystick.velocity = 1000;
        run.picture.external.hws.number = 5;
        run.picture.external.hws.command = Name16::clipped("MOVE");
        Self { run, operating: Some(Operating::default()) }
    }

    /// A line of the cell at the present tick.
    fn tell(&mut self, code: &str, text: &str) {
        let (tick, level, source) = (Tick(100), Level::Error, "cell".to_owned());
        self.run.story.tell([LogLine { tick, level, source, text: text.to_owned(), code: code.to_owned() }]);
    }

    fn band(&self) -> Band {
        let mut model = Model::new(Screen::Ladder);
        model.take(&self.run);
        model.operating.clone_from(&self.operating);
        band(&model, &self.run)
    }
}

/// A change of the run or of the console, and the resulting state, reason and next step.
type Case = (fn(&mut Desk), Condition, &'static str, &'static str);

#[test]
fn every_state_follows_from_its_sensors() {
    let cases: [Case; 18] = [
        (|_| {}, Condition::Running, "MOVE", ""),
        (|desk| desk.run.picture.external.hws.number = 0, Condition::Paused, "no command yet", ""),
        (
            |desk| desk.run.picture.external.hws.command = Name16::clipped("PAUSE"),
            Condition::Paused,
            "PAUSE",
            "",
        ),
        (
            |desk| {
                desk.operating
                    .as_mut()
                    .unwrap()
                    .answered(0, Ok("tick 9: the job waits; anna commands".into()))
            },
            Condition::Paused,
            "the job waits",
            ":job go",
        ),
        (
            |desk| {
                desk.operating = None;
                desk.run.view().job.phase = Text::clipped("waits");
                desk.run.view().job.reason = Text::clipped("** wait for the operator");
            },
            Condition::Paused,
            "the job waits: ** wait for the operator",
            "`:job go` continues the job (with --operate)",
        ),
        (
            |desk| desk.run.picture.external.devices.joystick.frame = 1,
            Condition::Paused,
            "joystick box is on",
            "x",
        ),
        (
            |desk| desk.run.picture.memory.prim.status.recording = true,
            Condition::Paused,
            "pose is recorded",
            "M",
        ),
        (
            |desk| desk.run.picture.external.devices.joystick.velocity = 0,
            Condition::Stopped,
            "knob is at 0",
            "Space turns it back",
        ),
        (
            |desk| {
                let devices = &mut desk.run.picture.external.devices;
                devices.joystick.velocity = 0;
                (devices.field.grip, devices.field.any) = (GroupHealth::Stale, GroupHealth::Stale);
            },
            Condition::Stopped,
            "field I/O: grip STALE",
            "waits for the device",
        ),
        (
            |desk| {
                let field = &mut desk.run.picture.external.devices.field;
                (field.hand, field.any) = (GroupHealth::Tripped, GroupHealth::Tripped);
            },
            Condition::Stopped,
            "pedestal TRIPPED",
            "io go DEVICE",
        ),
        (
            |desk| desk.run.picture.memory.header_mut(ProcessId::Prim).republished = true,
            Condition::Stopped,
            "Prim is held",
            "h releases it",
        ),
        (
            |desk| desk.run.picture.external.operator.stopped = board_bit(4),
            Condition::Stopped,
            "board 4 is stopped",
            "`GO`",
        ),
        (
            |desk| desk.run.picture.external.operator.stopped = board_bit(0),
            Condition::Stopped,
            "pulse",
            "`SSGO`",
        ),
        (
            |desk| desk.run.view().controller.cut = Text::clipped("MANUAL ON/OFF was pressed"),
            Condition::Stopped,
            "no pressure: MANUAL ON/OFF",
            "7",
        ),
        (
            |desk| desk.run.view().controller.estops[3] = true,
            Condition::EStop,
            "the E-stop on the joystick box is pressed",
            "III.6",
        ),
        (
            |desk| desk.tell("cell.fell", "LINKBAR1 lies on the floor"),
            Condition::Fault,
            "LINKBAR1 lies",
            "cell",
        ),
        (
            |desk| desk.run.state = State::Silent(4),
            Condition::NoData,
            "no new tick for 4 s",
            "look at the robot",
        ),
        (|desk| desk.run.state = State::Over, Condition::Ended, "MOVE", "o opens its log"),
    ];
    for (change, condition, why, next) in cases {
        let mut desk = Desk::new();
        change(&mut desk);
        let band = desk.band();
        assert_eq!(band.condition, condition, "{band:?}");
        assert!(band.why.contains(why) && band.next.contains(next), "{band:?}");
        assert!(!next.is_empty() || band.next.is_empty(), "{band:?}");
    }
}

/// The three lines of the band on a terminal of this width.
fn drawn(desk: &Desk, width: u16) -> String {
    let mut model = Model::new(Screen::Ladder);
    model.take(&desk.run);
    model.operating.clone_from(&desk.operating);
    let mut terminal = Terminal::new(TestBackend::new(width, 24)).expect("there is a screen");
    let look = Look { colour: false, ascii: false };
    terminal.draw(|frame| _ = draw(frame, &Scene::Source(&model, &desk.run), look)).expect("it can be drawn");
    let screen = terminal.backend().to_string();
    let lines = screen.lines().skip(1).take(3).map(|line| line.trim_matches('"').trim_end());
    lines.collect::<Vec<_>>().join("\n")
}

#[test]
fn band_is_read_at_a_glance_in_every_state_and_width() {
    let states: [fn(&mut Desk); 5] = [
        |_| {},
        |desk| {
            desk.run.view().job.phase = Text::clipped("waits");
            desk.run.view().job.reason = Text::clipped("the workstation is to be loaded");
        },
        |desk| desk.run.picture.external.devices.joystick.velocity = 0,
        |desk| {
            desk.tell(
                "cell.emergency",
                "T3: the E-stop on the joystick box was pressed: hydraulics off, the arm sinks",
            );
            desk.run.view().controller.estops[3] = true;
            desk.run.view().controller.cut = Text::clipped("the E-stop on the joystick box was pressed");
        },
        |desk| {
            desk.tell(
                "contact.begins",
                "right_finger runs into pot_2_near, 0.007 in deep, at (-54.38, -20.87, -12.58 in)",
            );
        },
    ];
    let mut shown = String::new();
    for change in states {
        let mut desk = Desk::new();
        desk.run.view().job.lines = 13;
        desk.run.view().job.begun = 4;
        desk.run.view().commander.source = Text::clipped("job");
        desk.run.view().commander.operator = Text::clipped("anna");
        change(&mut desk);
        for width in [80, 120, 200] {
            shown += &format!("{}\n\n", drawn(&desk, width));
        }
    }
    insta::assert_snapshot!("band-states", shown);
}

#[test]
fn emergency_stop_lasts_until_the_robot_has_pressure_again() {
    let mut desk = Desk::new();
    desk.run.picture.external.devices.joystick.velocity = 0;
    desk.tell("cell.emergency", "T3: the E-stop near the terminals was pressed");
    desk.run.view().controller.estops[2] = true;
    desk.run.view().controller.cut = Text::clipped("the E-stop near the terminals was pressed");
    assert_eq!(desk.band().condition, Condition::EStop, "it is more important than the knob");
    desk.run.view().controller.estops[2] = false;
    assert_eq!(desk.band().condition, Condition::EStop, "released, but without pressure");
    desk.run.view().controller.cut = Text::default();
    assert_eq!(desk.band().condition, Condition::Stopped);
    desk.run.picture.external.devices.joystick.velocity = 1000;
    desk.run.picture.external.hws.command = Name16::clipped("PAUSE");
    let band = desk.band();
    assert_eq!(band.condition, Condition::Paused);
    assert!(band.why.contains("E-stop near the terminals"), "{band:?}");
}

#[test]
fn failed_command_is_a_fault_with_its_remedy_until_pause() {
    let mut desk = Desk::new();
    let before = desk.run.picture.clone();
    desk.run.picture.memory.task.status.report = HwsReport::Error;
    desk.run.picture.memory.task.status.reason = Reason::HolsterOccupied;
    desk.run.story.note(&before, &desk.run.picture);
    let band = desk.band();
    assert_eq!(band.condition, Condition::Fault);
    assert!(band.why.starts_with("Task: the holster is not empty"), "{band:?}");
    assert!(band.next.starts_with("empty the holster; `:job go`"), "{band:?}");
    desk.operating = None;
    assert!(desk.band().next.ends_with("(with --operate)"), "a viewer cannot do it");
    desk.run.picture.external.hws.command = Name16::clipped("PAUSE");
    desk.run.picture.memory.task.status.report = HwsReport::Finished;
    assert_eq!(desk.band().condition, Condition::Paused);
}

#[test]
fn facts_name_line_hand_knob_tick_and_role() {
    let mut desk = Desk::new();
    desk.run.view().job.lines = 13;
    desk.run.view().job.begun = 4;
    let answer = "tick 9: the job plays; anna commands; knob 1000; connected 1: anna";
    desk.operating.as_mut().unwrap().answered(0, Ok(answer.into()));
    let band = desk.band();
    let facts =
        ["line 4 of 13", "holds nothing", "speed 100 %", "tick 100", "4.00 s", "demo", "anna commands"];
    assert_eq!(band.facts, facts);
    assert_eq!((band.role, band.is_recorded), ("OPERATOR", false));
    for (source, operator, commands) in [
        ("job", "", "the job commands"),
        ("job", "anna", "anna commands"),
        ("workstation controller", "anna", "the workstation controller commands"),
    ] {
        desk.run.view().commander.source = Text::clipped(source);
        desk.run.view().commander.operator = Text::clipped(operator);
        assert_eq!(desk.band().facts.last().map(String::as_str), Some(commands));
    }
    desk.operating.as_mut().unwrap().lost = Some("gone".into());
    assert_eq!(desk.band().role, "VIEWER");
    desk.run.state = State::Log;
    let band = desk.band();
    assert_eq!((band.role, band.is_recorded), ("RECORDED", true));
    assert!(band.facts.iter().any(|fact| fact == "tick 100 of 100"), "{band:?}");
}
