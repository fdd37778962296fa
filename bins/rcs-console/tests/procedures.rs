//! The procedures: steps that the console detects, confirmations by the operator, and requests to the run.

use executive::memory::{
    Text,
    cell::{ControllerView, Lamps},
};
use geometry::pose::WireFrame;
use interfaces::{ProcessId, prim::PrimVerb, subtask::SubtaskVerb, t3i::T3iReport};
use programs::rcs_console::{
    model::{Key, Model, Operating, Screen, procedures::ALL},
    once,
    view::Look,
};

use crate::stage::Stage;

const PLAIN: Look = Look { colour: false, ascii: false };
const HOME: WireFrame =
    WireFrame { tool: [0, -7142, -1485], wrist_to_tool: [0, -2121, -2121], tool_to_finger: [3000, 0, 0] };

impl Stage {
    /// A run in which all processes execute PAUSE, and the robot controller is at a stage.
    fn at(stage: &str) -> Self {
        let mut made = Self::new();
        made.turn_to(stage);
        made.picture.external.hws.command = rcs_core::name::Name16::clipped("PAUSE");
        made.picture.memory.task.subtask.command = SubtaskVerb::Pause;
        made.picture.memory.subtask.emove.command = interfaces::emove::EmoveVerb::Pause;
        made.picture.memory.emove.prim.command = PrimVerb::Pause;
        made.picture.memory.t3i.status.resolver_frame = Some(HOME);
        made
    }

    fn turn_to(&mut self, stage: &str) {
        if let Some(view) = &mut self.view {
            let lamps = Lamps { hydraulics_on: stage == "DEPC", ..Lamps::default() };
            let (stage, at_rest) = (Text::clipped(stage), true);
            view.controller = ControllerView { stage, at_rest, lamps, ..ControllerView::default() };
        }
    }

    fn hold(&mut self, processes: &[ProcessId], held: bool) {
        for process in processes {
            self.picture.memory.header_mut(*process).republished = held;
        }
    }
}

/// A console with an open procedure.
fn open(section: &str, title: &str, operates: bool) -> Model {
    let mut model = Model::new(Screen::Procedures);
    model.operating = operates.then(Operating::default);
    let at = ALL.iter().position(|procedure| procedure.section == section && procedure.title.contains(title));
    model.procedures.cursor = at.expect("the procedure is there");
    model.procedures.is_open = true;
    model
}

/// Advance by a tick, and update the console.
fn look(model: &mut Model, stage: &mut Stage) {
    stage.pass(1);
    model.take(stage);
}

fn word(model: &Model, id: &str) -> &'static str {
    let track = &model.procedures.tracks[model.procedures.cursor];
    let at = track.procedure.steps.iter().position(|step| step.id == id).expect("the step is there");
    track.marks[at].word()
}

fn cursor(model: &Model) -> &'static str {
    model.procedures.tracks[model.procedures.cursor].step().map_or("", |step| step.id)
}

/// The requests of the console; the run accepts all of them.
fn asked(model: &mut Model) -> String {
    let operating = model.operating.as_mut().expect("it operates");
    let lines = std::mem::take(&mut operating.outbox);
    for line in &lines {
        let number = operating.newest() + 1;
        operating.sent(number, line.clone());
        operating.answered(number, Ok("tick 7".into()));
    }
    lines.join("; ")
}

fn screen(model: &Model, stage: &Stage) -> String {
    once::screen_text(model, stage, PLAIN)
}

#[test]
fn all_procedures_are_listed_and_open() {
    let mut stage = Stage::at("control power off");
    let mut model = Model::new(Screen::Procedures);
    look(&mut model, &mut stage);
    insta::assert_snapshot!("procedures", screen(&model, &stage));
    for procedure in ALL {
        model.key(Key::Enter, &stage);
        look(&mut model, &mut stage);
        assert!(screen(&model, &stage).contains(procedure.title), "{}", screen(&model, &stage));
        model.key(Key::Esc, &stage);
        model.key(Key::Down, &stage);
    }
}

#[test]
fn start_up_is_detected_step_by_step() {
    let mut stage = Stage::at("control power off");
    let mut model = open("IV.3.3", "initialize", true);
    look(&mut model, &mut stage);
    assert_eq!([word(&model, "1a"), word(&model, "1b"), cursor(&model)], ["seen", "", "1b"]);
    model.key(Key::Enter, &stage);
    assert_eq!(asked(&mut model), "board 2 stop");
    stage.hold(&[ProcessId::Emove, ProcessId::Prim], true);
    look(&mut model, &mut stage);
    // The knob and the frames of the box are in the required state from the beginning.
    assert_eq!([word(&model, "1b"), word(&model, "2"), cursor(&model)], ["seen", "seen", "4"]);
    // A step whose state is lost loses its mark.
    stage.picture.external.devices.joystick.velocity = 100;
    look(&mut model, &mut stage);
    assert_eq!(word(&model, "2"), "");
    stage.picture.external.devices.joystick.velocity = 0;
    for stages in ["fault", "hydraulics disabled"] {
        stage.turn_to(stages);
        look(&mut model, &mut stage);
    }
    assert_eq!([word(&model, "4"), word(&model, "5"), cursor(&model)], ["seen", "seen", "6"]);
    // Only the operator can confirm that the work volume is clear. The log contains the confirmation.
    model.key(Key::Char('y'), &stage);
    assert_eq!([word(&model, "6"), cursor(&model)], ["said", "7"]);
    assert!(asked(&mut model).starts_with("note IV.3.3 6: the work volume is clear"));
    stage.turn_to("hydraulics enabled");
    look(&mut model, &mut stage);
    // A step that moves the robot first shows a warning.
    assert_eq!(cursor(&model), "8");
    model.key(Key::Enter, &stage);
    assert!(
        model.answer.as_deref().is_some_and(|answer| answer.starts_with("WARNING: the arm becomes live"))
    );
    assert_eq!(asked(&mut model), "");
    model.key(Key::Enter, &stage);
    assert_eq!(asked(&mut model), "panel manual on");
    stage.turn_to("manual");
    look(&mut model, &mut stage);
    assert_eq!([word(&model, "8"), word(&model, "9"), cursor(&model)], ["seen", "", "9"]);
    stage.view().controller.aligned = [true; 6];
    look(&mut model, &mut stage);
    assert_eq!(word(&model, "9"), "seen");
    stage.turn_to("auto, at HOME");
    stage.view().controller.aligned = [true; 6];
    look(&mut model, &mut stage);
    insta::assert_snapshot!("procedure-start-up", screen(&model, &stage));
    assert_eq!([word(&model, "10"), word(&model, "11"), cursor(&model)], ["seen", "seen", "12"]);
}

#[test]
fn after_step_14_stopped_boards_may_run() {
    let mut stage = Stage::at("DEPC");
    stage.view().controller.aligned = [true; 6];
    stage.hold(&[ProcessId::Emove, ProcessId::Prim], true);
    stage.picture.memory.prim.t3i.frame = HOME;
    stage.picture.memory.t3i.status.frame_feedback = HOME;
    stage.picture.memory.t3i.status.report = T3iReport::Error;
    let mut model = open("IV.3.3", "initialize", true);
    look(&mut model, &mut stage);
    model.key(Key::Char('y'), &stage);
    assert_eq!(cursor(&model), "12b");
    asked(&mut model);
    model.key(Key::Enter, &stage);
    assert_eq!(asked(&mut model), "PAUSE; execute EMOVE 8; execute PRIM 2");
    look(&mut model, &mut stage);
    assert_eq!(word(&model, "12b"), "", "T3 Interface has not answered");
    stage.picture.memory.t3i.status.report = T3iReport::Finished;
    look(&mut model, &mut stage);
    assert_eq!([word(&model, "12b"), cursor(&model)], ["done", "13"]);
    model.key(Key::Enter, &stage);
    assert_eq!(asked(&mut model), "execute PRIM 2");
    look(&mut model, &mut stage);
    assert_eq!([word(&model, "13"), cursor(&model)], ["done", "14"]);
    model.key(Key::Enter, &stage);
    model.key(Key::Enter, &stage);
    assert_eq!(asked(&mut model), "joystick free PRIM; board 2 go; PAUSE");
    stage.hold(&[ProcessId::Emove, ProcessId::Prim], false);
    stage.picture.memory.t3i.status.link_running = true;
    look(&mut model, &mut stage);
    assert_eq!(word(&model, "14"), "", "it has not stood for two seconds");
    stage.pass(50);
    look(&mut model, &mut stage);
    assert_eq!(word(&model, "14"), "done");
    assert_eq!(word(&model, "1b"), "done", "it was seen before, and step 14 has ended it");
}

#[test]
fn operator_confirms_steps_of_a_robot_at_a_port() {
    let mut stage = Stage::at("DEPC");
    stage.view = None;
    let mut model = open("IV.1", "Power up", false);
    look(&mut model, &mut stage);
    assert_eq!([word(&model, "1"), word(&model, "2"), word(&model, "5")], ["", "", "seen"]);
    model.key(Key::Char('y'), &stage);
    model.key(Key::Char('y'), &stage);
    assert_eq!([word(&model, "1"), word(&model, "2"), cursor(&model)], ["said", "said", "3"]);
    model.key(Key::Char('y'), &stage);
    assert_eq!(word(&model, "3"), "", "the potentiometer of the table is read here, too");
    assert!(model.answer.as_deref().is_some_and(|answer| answer.starts_with("the console checks")));
    model.key(Key::Enter, &stage);
    assert!(model.answer.as_deref().is_some_and(|answer| answer.contains("--operate")));
}

#[test]
fn step_is_skipped_with_a_reason_and_restored() {
    let mut stage = Stage::at("DEPC");
    let mut model = open("III.6", "Stop", true);
    look(&mut model, &mut stage);
    assert_eq!([word(&model, "1"), cursor(&model)], ["seen", "2"]);
    model.key(Key::Char('s'), &stage);
    model.key(Key::Enter, &stage);
    assert_eq!(word(&model, "2"), "", "no reason was given");
    for key in "sno time".chars().map(Key::Char).chain([Key::Enter]) {
        model.key(key, &stage);
    }
    assert_eq!([word(&model, "2"), cursor(&model)], ["left", "3"]);
    assert_eq!(asked(&mut model), "note III.6 2: Prim is held: left out, no time");
    stage.turn_to("fault");
    let controller = &mut stage.view().controller;
    controller.estops[2] = true;
    controller.cut = Text::clipped("the E-stop near the terminals was pressed");
    look(&mut model, &mut stage);
    assert_eq!([word(&model, "3"), cursor(&model)], ["seen", "4"]);
    insta::assert_snapshot!("procedure-e-stop", screen(&model, &stage));
    model.key(Key::Down, &stage);
    model.key(Key::Down, &stage);
    model.key(Key::Enter, &stage);
    assert_eq!(asked(&mut model), "release terminals; panel fault-reset");
    for _ in 0..4 {
        model.key(Key::Up, &stage);
    }
    model.key(Key::Char('u'), &stage);
    assert_eq!([word(&model, "2"), cursor(&model)], ["", "2"]);
    model.key(Key::Char('r'), &stage);
    assert_eq!(word(&model, "3"), "");
}
