//! The state band as a model, without a terminal: each state from its sensors.

use executive::memory::{Text, cell::CellView};
use interfaces::{CommonMemory, ExternalInputs, ProcessId, Reason, hws::HwsReport, operator::board_bit};
use programs::rcs_console::{
    model::{
        Model, Operating, Screen,
        band::{Band, Condition, band},
    },
    picture::Picture,
    source::{About, Cell, Source, State},
    story::Story,
};
use rcs_core::{name::Name16, tick::Tick};
use record::{Level, reader::LogLine};

/// A run with one picture and one view of its cell, which executes a MOVE.
struct Stage {
    picture: Picture,
    view: CellView,
    story: Story,
    state: State,
    operating: Option<Operating>,
}

impl Source for Stage {
    fn about(&self) -> About<'_> {
        About { name: "demo", state: self.state, result: None, damage: None }
    }

    fn refresh(&mut self) {}

    fn range(&self) -> Option<(u64, u64)> {
        Some((1, self.picture.tick.0))
    }

    fn picture(&self, _: u64) -> Option<Picture> {
        Some(self.picture.clone())
    }

    fn story(&self) -> &Story {
        &self.story
    }

    fn cell(&self, _: u64) -> Cell {
        Cell::Shown(Box::new(self.view))
    }
}

impl Stage {
    fn new() -> Self {
        let (mut external, mut memory) = (ExternalInputs::default(), CommonMemory::default());
        external.devices.joystick.velocity = 1000;
        external.hws.number = 5;
        external.hws.command = Name16::clipped("MOVE");
        for process in ProcessId::ALL {
            memory.header_mut(*process).stamp = Tick(100);
        }
        let picture = Picture { tick: Tick(100), external, memory, timing: None };
        let operating = Some(Operating::default());
        Self { picture, view: CellView::default(), story: Story::new(99), state: State::Runs, operating }
    }

    /// A line of the cell at the present tick.
    fn tell(&mut self, code: &str, text: &str) {
        let (tick, level, source) = (Tick(100), Level::Error, "cell".to_owned());
        self.story.tell([LogLine { tick, level, source, text: text.to_owned(), code: code.to_owned() }]);
    }

    fn band(&self) -> Band {
        let mut model = Model::new(Screen::Ladder);
        model.take(self);
        model.operating.clone_from(&self.operating);
        band(&model, self)
    }
}

/// A change of the stage, and the resulting state, reason and next step.
type Case = (fn(&mut Stage), Condition, &'static str, &'static str);

#[test]
fn every_state_follows_from_its_sensors() {
    let cases: [Case; 15] = [
        (|_| {}, Condition::Running, "MOVE", ""),
        (|stage| stage.picture.external.hws.number = 0, Condition::Paused, "no command yet", ""),
        (
            |stage| stage.picture.external.hws.command = Name16::clipped("PAUSE"),
            Condition::Paused,
            "PAUSE",
            "",
        ),
        (
            |stage| {
                stage
                    .operating
                    .as_mut()
                    .unwrap()
                    .answered(0, Ok("tick 9: the job waits; anna commands".into()))
            },
            Condition::Paused,
            "the job waits",
            ":job go",
        ),
        (
            |stage| stage.picture.external.devices.joystick.frame = 1,
            Condition::Paused,
            "joystick box is on",
            "x",
        ),
        (
            |stage| stage.picture.memory.prim.status.recording = true,
            Condition::Paused,
            "pose is recorded",
            "M",
        ),
        (
            |stage| stage.picture.external.devices.joystick.velocity = 0,
            Condition::Stopped,
            "knob is at 0",
            "Space turns it back",
        ),
        (
            |stage| stage.picture.memory.header_mut(ProcessId::Prim).republished = true,
            Condition::Stopped,
            "Prim is held",
            "h releases it",
        ),
        (
            |stage| stage.picture.external.operator.stopped = board_bit(4),
            Condition::Stopped,
            "board 4 is stopped",
            "`GO`",
        ),
        (
            |stage| stage.picture.external.operator.stopped = board_bit(0),
            Condition::Stopped,
            "pulse",
            "`SSGO`",
        ),
        (
            |stage| stage.view.controller.cut = Text::clipped("MANUAL ON/OFF was pressed"),
            Condition::Stopped,
            "no pressure: MANUAL ON/OFF",
            "7",
        ),
        (
            |stage| stage.view.controller.estops[3] = true,
            Condition::EStop,
            "the E-stop on the joystick box is pressed",
            "III.6",
        ),
        (
            |stage| stage.tell("cell.fell", "LINKBAR1 lies on the floor"),
            Condition::Fault,
            "LINKBAR1 lies",
            "cell",
        ),
        (
            |stage| stage.state = State::Silent(4),
            Condition::NoData,
            "no new tick for 4 s",
            "look at the robot",
        ),
        (|stage| stage.state = State::Over, Condition::Ended, "MOVE", "o opens its log"),
    ];
    for (change, condition, why, next) in cases {
        let mut stage = Stage::new();
        change(&mut stage);
        let band = stage.band();
        assert_eq!(band.condition, condition, "{band:?}");
        assert!(band.why.contains(why) && band.next.contains(next), "{band:?}");
        assert!(!next.is_empty() || band.next.is_empty(), "{band:?}");
    }
}

#[test]
fn emergency_stop_lasts_until_the_robot_has_pressure_again() {
    let mut stage = Stage::new();
    stage.picture.external.devices.joystick.velocity = 0;
    stage.tell("cell.emergency", "T3: the E-stop near the terminals was pressed");
    stage.view.controller.estops[2] = true;
    stage.view.controller.cut = Text::clipped("the E-stop near the terminals was pressed");
    assert_eq!(stage.band().condition, Condition::EStop, "it is more important than the knob");
    stage.view.controller.estops[2] = false;
    assert_eq!(stage.band().condition, Condition::EStop, "released, but without pressure");
    stage.view.controller.cut = Text::default();
    assert_eq!(stage.band().condition, Condition::Stopped);
    stage.picture.external.devices.joystick.velocity = 1000;
    stage.picture.external.hws.command = Name16::clipped("PAUSE");
    let band = stage.band();
    assert_eq!(band.condition, Condition::Paused);
    assert!(band.why.contains("E-stop near the terminals"), "{band:?}");
}

#[test]
fn failed_command_is_a_fault_with_its_remedy_until_pause() {
    let mut stage = Stage::new();
    let before = stage.picture.clone();
    stage.picture.memory.task.status.report = HwsReport::Error;
    stage.picture.memory.task.status.reason = Reason::HolsterOccupied;
    stage.story.note(&before, &stage.picture);
    let band = stage.band();
    assert_eq!(band.condition, Condition::Fault);
    assert!(band.why.starts_with("Task: the holster is not empty"), "{band:?}");
    assert!(band.next.starts_with("empty the holster; `:job go`"), "{band:?}");
    stage.operating = None;
    assert!(stage.band().next.ends_with("(with --operate)"), "a viewer cannot do it");
    stage.picture.external.hws.command = Name16::clipped("PAUSE");
    stage.picture.memory.task.status.report = HwsReport::Finished;
    assert_eq!(stage.band().condition, Condition::Paused);
}

#[test]
fn facts_name_line_hand_knob_tick_and_role() {
    let mut stage = Stage::new();
    stage.view.job.lines = 13;
    stage.view.job.begun = 4;
    let answer = "tick 9: the job plays; anna commands; knob 1000; connected 1: anna";
    stage.operating.as_mut().unwrap().answered(0, Ok(answer.into()));
    let band = stage.band();
    let facts =
        ["line 4 of 13", "holds nothing", "speed 100 %", "tick 100", "4.00 s", "demo", "anna commands"];
    assert_eq!(band.facts, facts);
    assert_eq!((band.role, band.is_recorded), ("OPERATOR", false));
    stage.operating.as_mut().unwrap().lost = Some("gone".into());
    assert_eq!(stage.band().role, "VIEWER");
    stage.state = State::Log;
    let band = stage.band();
    assert_eq!((band.role, band.is_recorded), ("RECORDED", true));
    assert!(band.facts.iter().any(|fact| fact == "tick 100 of 100"), "{band:?}");
}
