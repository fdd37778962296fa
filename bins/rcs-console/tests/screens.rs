//! Every screen and state as text, from the log of a short run that fails because no blank is on the tray.

use std::{
    path::{Path, PathBuf},
    sync::LazyLock,
};

use executive::boards::Board;
use executive::memory::{
    Text,
    cell::{CellView, ControllerView, Lamps, TableView},
};
use interfaces::ProcessId;
use programs::rcs_console::{
    model::{Effect, Key, Model, Operating, Pane, Place, Prompt, Screen, terminal::library::Library},
    once,
    picture::Picture,
    source::{About, Cell, Recorded, Source, State},
    story::Story,
    view::{Look, Scene, Waiting, draw},
};
use ratatui::{Terminal, backend::TestBackend};
use runtime::{Ending, LogTarget, Observer, Run, RunConfig};

const PLAIN: Look = Look { colour: false, ascii: false };
const FAILURE: u64 = 623; // tick in which E-move fails

struct Silent;

impl Observer for Silent {
    fn message(&mut self, _: &str) {}
}

static LOG: LazyLock<(tempfile::TempDir, PathBuf)> = LazyLock::new(|| {
    let directory = tempfile::tempdir().expect("a directory can be made");
    let path = directory.path().join("missing.mcap");
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data");
    let faults = Some(data.join("faults/blank-missing.toml"));
    let log = LogTarget::File(path.clone());
    let config = RunConfig { faults, log, shared_memory: false, ..RunConfig::new(data, "linkbar") };
    let outcome = Run::new(config, Box::new(Silent)).expect("the run begins").complete();
    assert!(matches!(outcome.ending, Ending::Failed(_)), "the run is to fail");
    (directory, path)
});

fn log() -> Recorded {
    Recorded::open(&LOG.1).expect("the log can be read")
}

struct As(Recorded, State);

impl Source for As {
    fn about(&self) -> About<'_> {
        About { name: "demo", state: self.1, result: None, damage: None }
    }

    fn refresh(&mut self) {}

    fn range(&self) -> Option<(u64, u64)> {
        self.0.range()
    }

    fn picture(&self, tick: u64) -> Option<Picture> {
        self.0.picture(tick)
    }

    fn story(&self) -> &Story {
        self.0.story()
    }

    fn cell(&self, _: u64) -> Cell {
        Cell::NotPublished
    }
}

struct Operated(As); // a run with a simulated cell, whose robot controller has been started

impl Source for Operated {
    fn about(&self) -> About<'_> {
        self.0.about()
    }

    fn refresh(&mut self) {}

    fn range(&self) -> Option<(u64, u64)> {
        self.0.range()
    }

    fn picture(&self, tick: u64) -> Option<Picture> {
        self.0.picture(tick)
    }

    fn story(&self) -> &Story {
        self.0.story()
    }

    fn cell(&self, _: u64) -> Cell {
        let lamps = Lamps {
            power: true,
            hydraulics_enabled: true,
            hydraulics_on: true,
            auto: true,
            ..Lamps::default()
        };
        let controller = ControllerView {
            stage: Text::clipped("DEPC"),
            lamps,
            aligned: [true; 6],
            ..ControllerView::default()
        };
        let table = TableView { power: true, manual: false, obeys: true };
        Cell::Shown(Box::new(CellView { controller, table, ..CellView::default() }))
    }
}

/// A screen with a tick, after the previous tick.
fn model(screen: Screen, process: ProcessId, tick: u64, source: &dyn Source) -> Model {
    let mut model = Model::new(screen);
    model.process = process;
    for shown in [tick - 1, tick] {
        model.place = Place::At(shown);
        model.take(source);
    }
    model
}

fn keys(model: &mut Model, source: &dyn Source, keys: &str) -> Effect {
    let mut effect = Effect::Draw;
    for key in keys.chars() {
        let key = match key {
            '\n' => Key::Enter,
            '\t' => Key::Tab,
            '\x1b' => Key::Esc,
            other => Key::Char(other),
        };
        effect = model.key(key, source);
        model.take(source);
    }
    effect
}

fn drawn(scene: &Scene<'_>, look: Look, width: u16, height: u16) -> String {
    let mut terminal = Terminal::new(TestBackend::new(width, height)).expect("there is a screen");
    terminal.draw(|frame| _ = draw(frame, scene, look)).expect("the screen can be drawn");
    terminal.backend().to_string()
}

fn screen(model: &Model, source: &dyn Source) -> String {
    drawn(&Scene::Source(model, source), PLAIN, 80, 24)
}

#[test]
fn ladder() {
    let log = log();
    insta::assert_snapshot!("ladder", screen(&model(Screen::Ladder, ProcessId::Emove, 300, &log), &log));
}

#[test]
fn ladder_shows_a_failure_on_its_way_up() {
    let log = log();
    insta::assert_snapshot!(
        "ladder-failure",
        screen(&model(Screen::Ladder, ProcessId::Emove, FAILURE, &log), &log)
    );
}

#[test]
fn wide_ladder_has_the_text_of_the_rows() {
    let log = log();
    let model = model(Screen::Ladder, ProcessId::Emove, FAILURE + 2, &log);
    insta::assert_snapshot!("ladder-wide", drawn(&Scene::Source(&model, &log), PLAIN, 160, 30));
}

#[test]
fn large_ladder_shows_the_process_and_whole_commands() {
    let log = log();
    let model = model(Screen::Ladder, ProcessId::Emove, FAILURE + 2, &log);
    insta::assert_snapshot!("ladder-beside", drawn(&Scene::Source(&model, &log), PLAIN, 120, 40));
    for (width, height) in [(120, 24), (120, 40), (200, 50)] {
        let text = drawn(&Scene::Source(&model, &log), PLAIN, width, height);
        let picture = model.picture.as_ref().unwrap();
        for process in ProcessId::ALL {
            let command = picture.command(*process);
            assert!(text.contains(&command), "{command} is cut at {width} x {height}\n{text}");
        }
    }
    let look = Look { ascii: true, colour: false };
    let ascii = drawn(&Scene::Source(&model, &log), look, 120, 40);
    assert!(ascii.is_ascii() && ascii.contains("!!E-move   <= CAUSE"), "{ascii}");
}

#[test]
fn process_with_the_text_of_its_table() {
    let log = log();
    let mut model = model(Screen::Process, ProcessId::Emove, FAILURE, &log);
    keys(&mut model, &log, "s");
    insta::assert_snapshot!("process-source", screen(&model, &log));
    keys(&mut model, &log, "s");
    assert!(!model.shows_source);
}

/// The workstation controller of another process commands; the console asks how to take over.
#[test]
fn operator_takes_over_from_a_workstation_controller() {
    let run = As(log(), State::Runs);
    let mut model = operating(Screen::Ladder, &run);
    let refusal = "the workstation controller commands this run: ask there, or end its session; stops are possible, \
                   and `stand-alone` takes over";
    model.operating.as_mut().unwrap().answered(3, Err(refusal.into()));
    insta::assert_snapshot!("take-over", screen(&model, &run));
    let asked = |model: &mut Model| std::mem::take(&mut model.operating.as_mut().unwrap().outbox).join("; ");
    keys(&mut model, &run, " ");
    assert_eq!(asked(&mut model), "stop", "a stop needs no taking over");
    keys(&mut model, &run, "\n");
    assert_eq!(asked(&mut model), "stand-alone");
    insta::assert_snapshot!("take-over-waits", screen(&model, &run));
    let operating = model.operating.as_mut().unwrap();
    operating.sent(4, "stand-alone".into());
    operating.answered(4, Err("MOVE of the workstation controller, number 5, is executed".into()));
    let later = |tick| Picture { tick: rcs_core::tick::Tick(tick), ..run.picture(625).unwrap() };
    operating.look(&later(640));
    assert!(operating.outbox.is_empty(), "it has been asked just now");
    operating.look(&later(655));
    assert_eq!(asked(&mut model), "stand-alone");
    keys(&mut model, &run, "P");
    assert_eq!(asked(&mut model), "stand-alone now");
    let operating = model.operating.as_mut().unwrap();
    operating.sent(5, "stand-alone now".into());
    operating.answered(5, Ok("tick 656: the workstation controller no longer commands".into()));
    assert!(model.taking_over().is_none());
}

#[test]
fn process() {
    let log = log();
    insta::assert_snapshot!(
        "process",
        screen(&model(Screen::Process, ProcessId::Emove, FAILURE, &log), &log)
    );
}

#[test]
fn process_with_its_buffers() {
    let log = log();
    let mut model = model(Screen::Process, ProcessId::Grip, 100, &log);
    keys(&mut model, &log, "\t\t/force\n");
    assert_eq!(model.pane, Pane::Buffers);
    insta::assert_snapshot!("process-buffers", screen(&model, &log));
}

#[test]
fn process_with_its_rows() {
    let log = log();
    let mut model = model(Screen::Process, ProcessId::Prim, FAILURE, &log);
    keys(&mut model, &log, "\t");
    insta::assert_snapshot!("process-rows", screen(&model, &log));
}

#[test]
fn link() {
    let log = log();
    insta::assert_snapshot!("link", screen(&model(Screen::Link, ProcessId::Task, FAILURE, &log), &log));
}

#[test]
fn cell() {
    let log = log();
    insta::assert_snapshot!("cell", screen(&model(Screen::Cell, ProcessId::Task, FAILURE, &log), &log));
}

#[test]
fn cell_drawn_from_above_and_from_the_side() {
    let log = log();
    let mut model = model(Screen::Cell, ProcessId::Task, FAILURE, &log);
    keys(&mut model, &log, "v");
    insta::assert_snapshot!("cell-above", screen(&model, &log));
    let large = drawn(&Scene::Source(&model, &log), PLAIN, 80, 50);
    assert!(large.contains("from the side") && large.contains("nearest to the robot"), "{large}");
    keys(&mut model, &log, "v");
    assert!(model.drawing.is_none());
}

/// A console that operates a run, with one accepted and one refused command.
fn operating(kind: Screen, run: &dyn Source) -> Model {
    let mut model = model(kind, ProcessId::Emove, 300, run);
    model.place = Place::Last;
    model.take(run);
    let mut operating = Operating::default();
    operating
        .answered(0, Ok("tick 624: the job waits; console-4711 commands; knob 1000; connected 1".into()));
    model.operating = Some(operating);
    keys(&mut model, run, if kind == Screen::Terminal { ":863 12 12 LINE-LOAD\n" } else { ":PAUSE\n" });
    let mut operating = model.operating.take().expect("it operates");
    let line = operating.outbox.pop().expect("a request");
    operating.sent(1, line);
    operating.answered(1, Ok("tick 620: command 7".into()));
    operating.sent(2, "vise open TABLE".into());
    operating.answered(2, Err("there is no vise at TABLE; the cell description has one at PFIXTURE".into()));
    operating.sent(3, "job go".into());
    model.operating = Some(operating);
    model
}

#[test]
fn operator_keys_send_requests() {
    let run = As(log(), State::Runs);
    let mut model = operating(Screen::Ladder, &run);
    let asked = |model: &mut Model| std::mem::take(&mut model.operating.as_mut().unwrap().outbox).join("; ");
    keys(&mut model, &run, " h:job w\t\n");
    assert_eq!(asked(&mut model), "stop; joystick hold PRIM; job wait");
    model.robot_elsewhere = false;
    model.key(Key::F1, &run);
    keys(&mut model, &run, "j");
    model.key(Key::F1, &run);
    assert_eq!(asked(&mut model), "", "another key takes the first F1 back");
    model.key(Key::F1, &run);
    assert_eq!(asked(&mut model), "estop terminals");
    keys(&mut model, &run, "!!");
    assert_eq!(asked(&mut model), "estop terminals", "some terminals keep F1 for themselves");
    model.robot_elsewhere = true;
    keys(&mut model, &run, "!!");
    assert_eq!(asked(&mut model), "joystick hold PRIM; board 4 stop", "the E-stops are at the robot");
    keys(&mut model, &run, "6w-+jjj\n\n");
    assert_eq!(
        asked(&mut model),
        "joystick frame WORLD; joystick velocity 900; joystick velocity 1000; PAUSE"
    );
    model.key(Key::Up, &run);
    assert_eq!(asked(&mut model), "");
    assert!(
        model.answer.as_ref().is_some_and(|answer| answer.contains("no frame is on")),
        "{:?}",
        model.answer
    );
    model.picture.as_mut().unwrap().external.devices.joystick.frame = 1;
    model.key(Key::Up, &run);
    model.key(Key::PageDown, &run);
    assert_eq!(asked(&mut model), "joystick stick 192 0 3; joystick down 3");
    // A console without `--operate` sends nothing.
    model.operating = None;
    keys(&mut model, &run, "\x1b :");
    assert!(model.prompt.is_none());
}

#[test]
fn text_at_the_terminal_of_an_operator_never_acts_as_keys() {
    let run = As(log(), State::Runs);
    let mut model = operating(Screen::Terminal, &run);
    for line in ["610 NO-SUCH-WORD 1", "job wait", "2 7", "hold", "quit", ".R"] {
        let begin = if line.starts_with(|first: char| first.is_ascii_digit()) { ":" } else { "" };
        keys(&mut model, &run, &format!("{begin}{line}"));
        model.key(Key::Left, &run);
        model.key(Key::PageUp, &run);
        assert_eq!(model.prompt, Some(Prompt::Request(line.to_owned())));
        model.key(Key::Esc, &run);
        assert_eq!((model.screen, &model.prompt), (Screen::Terminal, &None));
    }
    assert_eq!(model.operating.as_ref().unwrap().outbox, [""; 0]);
    keys(&mut model, &run, "job wait\n");
    assert_eq!(model.operating.as_ref().unwrap().outbox, ["job wait"]);
    // Stops are keys also while a line is typed. A console that only reads treats letters as keys.
    keys(&mut model, &run, "job");
    model.key(Key::F1, &run);
    assert!(model.prompt.is_none() && model.operating.as_ref().unwrap().is_armed);
    keys(&mut model, &run, " ");
    assert_eq!(model.operating.take().unwrap().outbox, ["job wait", "stop"]);
    keys(&mut model, &run, "6");
    assert_eq!(model.screen, Screen::Panels);
}

#[test]
fn one_enter_starts_no_job() {
    let run = As(log(), State::Runs);
    let mut model = operating(Screen::Panels, &run);
    let asked = |model: &mut Model| std::mem::take(&mut model.operating.as_mut().unwrap().outbox).join("; ");
    keys(&mut model, &run, ":\n");
    assert_eq!(asked(&mut model), "", "the line is empty");
    keys(&mut model, &run, "\n");
    assert_eq!(model.answer.as_deref(), Some("Enter again presses: job go"));
    keys(&mut model, &run, "j\nk\n");
    assert_eq!(asked(&mut model), "", "another key takes the first Enter back");
    keys(&mut model, &run, "\n");
    assert_eq!(asked(&mut model), "job go");
}

/// The screen in the documentation is that of this run. `RCS_PAGES=write` writes it.
#[test]
fn the_page_shows_the_ladder_of_this_log() {
    let log = log();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/console.md");
    let page = std::fs::read_to_string(&path).expect("the page is there");
    let (before, rest) = page.split_once("```text\n").expect("the page shows a screen");
    let (shown, after) = rest.split_once("```").expect("the screen ends");
    let drawn = once::screen_text(&model(Screen::Ladder, ProcessId::Emove, FAILURE, &log), &log, PLAIN);
    if std::env::var_os("RCS_PAGES").is_some_and(|value| value == "write") {
        let written = format!("{before}```text\n{drawn}```{after}");
        std::fs::write(&path, written).expect("the page can be written");
        return;
    }
    assert_eq!(shown, drawn);
    assert!(!after.contains("```text"), "one screen is compared");
}

#[test]
fn operator_has_terminal_and_panels() {
    let run = Operated(As(log(), State::Runs));
    insta::assert_snapshot!("terminal", screen(&operating(Screen::Terminal, &run), &run));
    insta::assert_snapshot!("panels", screen(&operating(Screen::Panels, &run), &run));
}

/// A console that shows a log and has the blocks of the data.
fn at_the_terminal(log: &dyn Source, typed: &str) -> Model {
    let mut model = model(Screen::Terminal, ProcessId::Task, FAILURE, log);
    model.terminal.library = Library::with(log.blocks().expect("a log has its blocks").to_vec());
    keys(&mut model, log, typed);
    model
}

#[test]
fn terminal_with_a_block_of_commands() {
    let log = log();
    insta::assert_snapshot!("terminal-list", screen(&at_the_terminal(&log, ":863 LIST\n"), &log));
}

/// IV.2.3: the board is stopped first. The editor shows the checker's messages at their lines, then the diff.
#[test]
fn block_is_edited_while_its_board_is_stopped() {
    let data = tempfile::tempdir().expect("a directory can be made");
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data");
    for source in taskdata::load::source::read_blocks_under(&shipped).0 {
        let path = data.path().join(&source.name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, source.text.as_bytes()).unwrap();
    }
    let run = As(log(), State::Runs);
    let mut model = operating(Screen::Terminal, &run);
    model.terminal.library = Library::of(data.path().to_owned());
    let says = |model: &Model, text: &str| {
        assert!(model.answer.as_ref().is_some_and(|answer| answer.contains(text)), "{:?}", model.answer);
    };
    keys(&mut model, &run, ":863 EDIT\n");
    says(&model, "board 6 runs: ^C stops it");
    keys(&mut model, &run, ":863 LIST\n");
    model.picture.as_mut().unwrap().external.operator.stopped = interfaces::operator::board_bit(6);
    model.key(Key::F2, &run);
    let place = data.path().display().to_string();
    let shown = |model: &Model| screen(model, &run).replace(&place, "DATA");
    let lines =
        |text: &str| text.lines().filter(|line| !line.contains("DATA")).collect::<Vec<_>>().join("\n");
    (0..5).for_each(|_| _ = model.key(Key::Down, &run));
    keys(&mut model, &run, "== MOVE -- 0 -- 0 0 NOWHERE 0 -- 0");
    model.key(Key::F2, &run);
    says(&model, "nothing is written");
    insta::assert_snapshot!("editor-errors", lines(&shown(&model)));
    (0..14).for_each(|_| _ = model.key(Key::Backspace, &run));
    keys(&mut model, &run, "SAFE 0 -- 0");
    model.key(Key::F2, &run);
    insta::assert_snapshot!("editor-change", lines(&shown(&model)));
    std::mem::take(&mut model.operating.as_mut().unwrap().outbox);
    keys(&mut model, &run, "\n");
    assert_eq!(model.operating.as_mut().unwrap().outbox, ["load 16000 863"]);
    assert!(model.terminal.editor.is_none());
    let text = std::fs::read_to_string(data.path().join("commands.blk")).unwrap();
    assert!(text.contains("\n== MOVE -- 0 -- 0 0 SAFE 0 -- 0\n"), "{text}");
}

/// Completion knows the names of the task data.
#[test]
fn names_are_completed_in_the_terminal() {
    let log = log();
    let mut model = at_the_terminal(&log, ":send MOVE LINKBAR1_B\t");
    assert_eq!(model.prompt, Some(Prompt::Request("send MOVE LINKBAR1_BH ".to_owned())));
    keys(&mut model, &log, "\t");
    assert!(model.answer.as_ref().is_some_and(|answer| answer.contains("+2")), "{:?}", model.answer);
}

#[test]
fn terminal_with_a_show_word() {
    let log = log();
    insta::assert_snapshot!("terminal-show", screen(&at_the_terminal(&log, "\t\t\t\t:II\n"), &log));
}

#[test]
fn terminal_explains_words_without_effect() {
    let log = log();
    let typed = ":WUNLOAD\n:903 LOAD\n:GO\n:LOC SAFE-P\n:LOC LOCATE-OBJ\n";
    insta::assert_snapshot!("terminal-said", screen(&at_the_terminal(&log, typed), &log));
}

#[test]
fn control_c_stops_the_board_and_keeps_an_operating_console() {
    let run = As(log(), State::Runs);
    let mut model = operating(Screen::Terminal, &run);
    assert_eq!(model.key(Key::Interrupt, &run), Effect::Draw);
    assert_eq!(std::mem::take(&mut model.operating.as_mut().unwrap().outbox), ["board 6 stop"]);
    model.key(Key::BackTab, &run);
    keys(&mut model, &run, ":GO\n");
    assert_eq!(std::mem::take(&mut model.operating.as_mut().unwrap().outbox), ["board 4 go"]);
    model.operating = None;
    assert_eq!(model.key(Key::Interrupt, &run), Effect::Quit);
}

#[test]
fn command_is_followed_to_its_end() {
    let run = As(log(), State::Runs);
    let mut model = operating(Screen::Terminal, &run);
    let operating = model.operating.as_mut().unwrap();
    operating.sent(4, "MOVE".into());
    operating.answered(4, Ok("tick 100: command 5".into()));
    for tick in [500, FAILURE, 625] {
        operating.look(&run.picture(tick).unwrap());
    }
    assert_eq!(operating.exchanges.last().unwrap().stages, ["executing", "error"]);
}

#[test]
fn watched_fields_replace_the_buffers() {
    let log = log();
    let mut model = model(Screen::Process, ProcessId::Task, FAILURE, &log);
    keys(&mut model, &log, "wtask.status.report\nwt3i.status.echo\nwno-such-name\n");
    assert!(model.answer.as_ref().is_some_and(|answer| answer.contains("no field")), "{:?}", model.answer);
    insta::assert_snapshot!("process-watch", screen(&model, &log));
    keys(&mut model, &log, "wt3i.status.echo\nv");
    assert_eq!((model.watch.as_slice(), model.shows_watch), (&["task.status.report".to_owned()][..], false));
}

#[test]
fn help() {
    let log = log();
    let mut model = model(Screen::Ladder, ProcessId::Task, 300, &log);
    keys(&mut model, &log, "?");
    insta::assert_snapshot!("help", screen(&model, &log));
    keys(&mut model, &log, "x");
    assert!(!model.help, "any key goes back");
}

#[test]
fn waiting() {
    let mut waiting = Waiting::default();
    insta::assert_snapshot!("waiting", drawn(&Scene::Waiting(&waiting), PLAIN, 80, 24));
    waiting.take(vec!["clevis-12".parse().expect("a name"), "linkbar-11".parse().expect("a name")]);
    waiting.cursor = 1;
    let boards: Vec<_> = Board::ALL.iter().map(|board| (*board, *board != Board::Four)).collect();
    let coming_up = Waiting { runs: waiting.runs[1..].to_vec(), boards, ..Waiting::default() };
    insta::assert_snapshot!("boards", drawn(&Scene::Waiting(&coming_up), PLAIN, 80, 24));
    insta::assert_snapshot!("choice", drawn(&Scene::Waiting(&waiting), PLAIN, 80, 24));
}

#[test]
fn state_of_a_run_is_shown() {
    let line = |state, place, keys_typed: &str| {
        let source = As(log(), state);
        let mut model = Model::new(Screen::Ladder);
        model.take(&source);
        model.place = place;
        model.take(&source);
        keys(&mut model, &source, keys_typed);
        screen(&model, &source)
            .lines()
            .map(|line| format!("{}\n", line.trim_matches('"').trim_end()))
            .collect::<Vec<_>>()
    };
    let says = |state, place, keys, expected: &str| {
        let lines = line(state, place, keys)[1..4].join("");
        assert!(lines.contains(expected), "{expected:?} is not in\n{lines}");
        lines
    };
    says(State::Runs, Place::Last, "", " !! FAULT    E-move: vision sees no object");
    says(State::Runs, Place::Last, "", "speed 100 %  tick 625  25.00 s");
    says(State::Runs, Place::At(600), "", "tick 625, SHOWN 600");
    says(State::Runs, Place::Last, "p", "tick 625, SHOWN 625");
    assert!(!says(State::Runs, Place::Last, "pp", "VIEWER").contains("SHOWN"));
    says(State::Silent(4), Place::Last, "", " ?? NO DATA  no new tick for 4 s");
    says(State::Torn, Place::Last, "", "TORN");
    says(State::Over, Place::Last, "", " ENDED");
    says(State::Over, Place::Last, "", "next: o opens its log at the first cause");
    let news = line(State::Over, Place::Last, "a")[22].clone();
    assert!(news.contains("the run ended: Task says error"), "{news}");
}

#[test]
fn alarm_stays_until_it_is_acknowledged() {
    let log = log();
    let mut model = model(Screen::Ladder, ProcessId::Task, 400, &log);
    let news = |model: &Model| screen(model, &log).lines().nth(22).map(str::to_owned).unwrap_or_default();
    assert!(news(&model).contains("!!    73"), "{}", news(&model));
    keys(&mut model, &log, "a");
    assert!(!news(&model).contains("!!"), "{}", news(&model));
}

#[test]
fn keys_go_in_time() {
    let log = log();
    let mut model = model(Screen::Ladder, ProcessId::Task, 300, &log);
    let mut go = |typed: &str| {
        keys(&mut model, &log, typed);
        model.tick()
    };
    assert_eq!([go("["), go("]"), go("}"), go("{")], [299, 300, 325, 300]);
    assert_eq!(go("g450\n"), 450);
    assert_eq!(go("gno\n"), 450, "a text that is not a number has no effect");
    assert_eq!(go("t"), FAILURE, "the next trouble");
    assert_eq!(go("T"), 73, "the warning before it");
    let (next, previous) = (go("n"), go("N"));
    assert!((74..100).contains(&next) && (50..74).contains(&previous), "{next}, {previous}");
    assert_eq!(go("c"), FAILURE, "the first cause");
    assert_eq!(model.process, ProcessId::Emove, "the process that knows it is under the cursor");
    assert_eq!(model.key(Key::Home, &log), Effect::Draw);
    model.take(&log);
    assert_eq!(model.tick(), 1);
    assert_eq!(model.key(Key::End, &log), Effect::Draw);
    model.take(&log);
    assert_eq!(model.tick(), 625);
}

#[test]
fn keys_select_screens_and_quit() {
    let log = log();
    let mut model = model(Screen::Ladder, ProcessId::Task, 300, &log);
    for (key, screen) in
        [("2", Screen::Process), ("3", Screen::Link), ("4", Screen::Cell), ("\x1b", Screen::Ladder)]
    {
        keys(&mut model, &log, key);
        assert_eq!(model.screen, screen);
    }
    keys(&mut model, &log, "jj\n");
    assert_eq!((model.screen, model.process), (Screen::Process, ProcessId::Pedestal));
    assert_eq!(keys(&mut model, &log, "o"), Effect::OpenLog);
    assert_eq!(keys(&mut model, &log, "q"), Effect::Quit);
    assert_eq!(model.key(Key::Interrupt, &log), Effect::Quit);
}

/// The states of a run that a ladder can show: frozen, silent, torn, ended.
#[test]
fn ladder_in_every_state_of_a_run() {
    for (name, state, place) in [
        ("frozen", State::Runs, Place::At(600)),
        ("silent", State::Silent(4), Place::Last),
        ("torn", State::Torn, Place::Last),
        ("ended", State::Over, Place::Last),
    ] {
        let run = As(log(), state);
        let mut model = Model::new(Screen::Ladder);
        model.take(&run);
        model.place = place;
        model.take(&run);
        insta::assert_snapshot!(format!("state-{name}"), screen(&model, &run));
    }
}

/// The screens for operators on a console without `--operate`, and all screens in ASCII.
#[test]
fn every_screen_without_an_operator_and_in_ascii() {
    let log = log();
    for kind in Screen::ALL {
        let model = model(kind, ProcessId::Emove, FAILURE, &log);
        let look = Look { ascii: true, colour: false };
        let text = drawn(&Scene::Source(&model, &log), look, 80, 24);
        insta::assert_snapshot!(format!("ascii-{}", kind.name().to_lowercase()), text);
    }
}

#[test]
fn ascii_has_no_other_signs() {
    let log = log();
    for kind in Screen::ALL {
        let model = model(kind, ProcessId::Emove, FAILURE, &log);
        let look = Look { ascii: true, colour: true };
        let text = drawn(&Scene::Source(&model, &log), look, 80, 24);
        assert!(text.is_ascii(), "{text}");
    }
}

#[test]
fn too_small_terminal_shows_a_message() {
    let log = log();
    let model = model(Screen::Ladder, ProcessId::Task, 300, &log);
    let small = |width, height| drawn(&Scene::Source(&model, &log), PLAIN, width, height);
    assert!(small(79, 24).contains("needs 80 x 24 characters; this terminal has 79 x 24"));
    assert!(small(80, 23).contains("this terminal has 80 x 23"));
    assert!(small(1, 1).contains('r'));
}

#[test]
fn colour_repeats_a_mark() {
    let log = log();
    let model = model(Screen::Ladder, ProcessId::Task, FAILURE, &log);
    let scene = Scene::Source(&model, &log);
    let mut terminal = Terminal::new(TestBackend::new(80, 24)).expect("there is a screen");
    let look = Look { colour: true, ascii: false };
    terminal.draw(|frame| _ = draw(frame, &scene, look)).expect("the screen can be drawn");
    let buffer = terminal.backend().buffer();
    let marked = (0..24).filter(|y| buffer[(0, *y)].symbol() == "!");
    let red = |y: &u16| buffer[(0, *y)].fg == ratatui::style::Color::Red;
    let (all, with_colour) = (marked.clone().count(), marked.filter(red).count());
    assert!(all > 1 && all == with_colour, "{all} marks, {with_colour} in red");
}

/// The keys that stop the robot are on every screen of a console that operates a run, also during text input.
#[test]
fn operator_always_sees_the_keys_that_stop_the_robot() {
    let run = As(log(), State::Runs);
    let last = |model: &Model| screen(model, &run).lines().last().map(str::to_owned).unwrap_or_default();
    for kind in Screen::ALL {
        let mut model = operating(kind, &run);
        for typed in ["", "?", "x/", "\x1b"] {
            keys(&mut model, &run, typed);
            let line = last(&model);
            assert!(line.contains("Space=stop") && line.contains("F1=E-stop"), "{kind:?} {typed:?}: {line}");
        }
    }
    let mut model = operating(Screen::Ladder, &run);
    keys(&mut model, &run, "? ");
    assert_eq!(
        model.operating.as_ref().unwrap().outbox,
        ["stop"],
        "Space stops while help covers the screen"
    );
    model.operating.as_mut().unwrap().lost = Some("gone".into());
    assert!(!last(&model).contains("Space=stop"), "keys without effect are not offered");
}

/// A digit selects a screen everywhere. On the panels it once turned the velocity knob of a running robot.
#[test]
fn digits_select_screens_on_every_screen() {
    let run = As(log(), State::Runs);
    for kind in Screen::ALL {
        for (digit, wanted) in ('1'..='7').zip(Screen::ALL) {
            let mut model = operating(kind, &run);
            model.operating.as_mut().unwrap().outbox.clear();
            keys(&mut model, &run, &digit.to_string());
            assert_eq!((model.screen, &model.prompt), (wanted, &None), "{digit} on {kind:?}");
            assert_eq!(model.operating.as_ref().unwrap().outbox, [""; 0], "{digit} on {kind:?}");
        }
        let mut model = operating(kind, &run);
        model.operating.as_mut().unwrap().outbox.clear();
        keys(&mut model, &run, "089");
        assert_eq!((model.screen, &model.prompt), (kind, &None));
        assert_eq!(model.operating.as_ref().unwrap().outbox, [""; 0]);
    }
}

/// The band of a log is neither filled nor inverted, so that it does not look like the state of a robot.
#[test]
fn band_of_a_log_looks_different_from_that_of_a_run() {
    use ratatui::style::{Color, Modifier};
    let log = log();
    let run = As(Recorded::open(&LOG.1).expect("the log can be read"), State::Runs);
    for (source, is_live) in [(&log as &dyn Source, false), (&run as &dyn Source, true)] {
        let model = model(Screen::Ladder, ProcessId::Task, 625, source);
        for look in [PLAIN, Look { colour: true, ascii: true }] {
            let mut terminal = Terminal::new(TestBackend::new(80, 24)).expect("there is a screen");
            let scene = Scene::Source(&model, source);
            terminal.draw(|frame| _ = draw(frame, &scene, look)).expect("the screen can be drawn");
            let cell = &terminal.backend().buffer()[(30, 1)];
            let is_filled = cell.bg != Color::Reset || cell.modifier.contains(Modifier::REVERSED);
            assert_eq!(is_filled, is_live, "{look:?}");
        }
        assert_eq!(screen(&model, source).contains("LOG [!! FAULT]"), !is_live);
    }
}
