//! The points screen: couplers, inputs and outputs, live and from a log.

use std::path::{Path, PathBuf};

use executive::memory::{
    Attached, RunName, Text,
    field::{CouplerView, FieldView, PointView},
};
use programs::rcs_console::{
    model::{Key, Model, Place, Screen, points},
    once,
    source::{Recorded, Source},
    view::{Look, Scene, compose},
};
use rcs_core::name::Name16;
use runtime::{LogTarget, Observer, Run, RunConfig};

const PLAIN: Look = Look { colour: false, ascii: false };

struct Silent;

impl Observer for Silent {
    fn message(&mut self, _: &str) {}
}

/// The log of a run with emulated couplers, in which the arm is lost for a second, and what the run published.
fn log(directory: &Path) -> (Recorded, Vec<FieldView>) {
    let (path, faults) = (directory.join("cut.mcap"), directory.join("cut.toml"));
    std::fs::write(&faults, "[[fault]]\nkind = \"field-cut\"\ndevice = \"arm\"\nat = 100\nticks = 20\n")
        .expect("a fault file");
    let data = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../data");
    let name = RunName::unique("points");
    let config = RunConfig {
        name: Some(name.clone()),
        faults: Some(faults),
        log: LogTarget::File(path.clone()),
        ticks: Some(140),
        field: Some("sim:station".parse().expect("a mapping")),
        ..RunConfig::new(data, "linkbar")
    };
    let mut run = Run::new(config, Box::new(Silent)).expect("the run begins");
    let reader = Attached::open(&name).expect("the run shows its buffers");
    assert_eq!(reader.field(), Ok(None), "before the first tick");
    let mut published = Vec::new();
    while run.step() {
        published.push(reader.field().expect("it is legal").expect("there are couplers"));
    }
    drop(run.complete());
    (Recorded::open(&path).expect("the log can be read"), published)
}

fn model(source: &dyn Source, tick: u64) -> Model {
    let mut model = Model::new(Screen::Points);
    model.place = Place::At(tick);
    model.take(source);
    model
}

fn screen(model: &Model, source: &dyn Source, width: usize, height: usize) -> String {
    let (lines, _) = compose(&Scene::Source(model, source), PLAIN, width, height);
    lines.iter().map(|line| format!("{}\n", line.to_string().trim_end())).collect()
}

#[test]
fn points_of_a_log_are_shown_in_every_width() {
    let directory = tempfile::tempdir().expect("a directory");
    let (log, published) = log(directory.path());
    for view in &published {
        // The log has the state after a tick with the next one.
        let tick = view.tick.next();
        let Some(picture) = log.picture(tick.0).filter(|picture| picture.tick == tick) else { continue };
        let logged = log.field(&picture).expect("the log has the couplers");
        assert_eq!((logged.devices, logged.point_count), (view.devices, view.point_count), "tick {tick}");
        for (logged, shown) in logged.points.iter().zip(&view.points) {
            let is_of_the_box = logged.name.as_str().starts_with("joystick.");
            // The joystick box of the operator replaces its inputs at the start of a tick.
            let value = if is_of_the_box { logged.value } else { shown.value };
            assert_eq!(*logged, PointView { value, ..*shown }, "tick {tick}");
        }
    }
    assert!(published.len() > 100, "{} ticks", published.len());
    let fresh = model(&log, 90);
    insta::assert_snapshot!("points-80", screen(&fresh, &log, 80, 24));
    let mut late = model(&log, 108);
    insta::assert_snapshot!("points-120", screen(&late, &log, 120, 40));
    insta::assert_snapshot!("points-200", screen(&late, &log, 200, 50));
    let text = screen(&late, &log, 80, 24);
    assert!(text.contains("STALE") && text.contains("!!arm"), "in words, without colour: {text}");
    for key in "/pot\n".chars() {
        late.key(if key == '\n' { Key::Enter } else { Key::Char(key) }, &log);
    }
    let text = screen(&late, &log, 80, 24);
    assert!(text.contains("grip.potentiometer") && !text.contains("beam.1"), "filtered: {text}");
    late.key(Key::Esc, &log);
    late.key(Key::Char('v'), &log);
    assert_eq!(late.screen, Screen::Link);
    late.key(Key::Char('v'), &log);
    assert_eq!(late.screen, Screen::Points);
    assert!(once::screen_text(&late, &log, PLAIN).contains(">3 Link"));
}

#[test]
fn difference_between_command_and_device_is_a_word() {
    let mut view = FieldView { device_count: 1, point_count: 2, ..FieldView::default() };
    view.devices[0] = CouplerView {
        name: Name16::clipped("arm"),
        state: Name16::clipped("running"),
        age_ms: 7,
        ..CouplerView::default()
    };
    let output = |name: &str, value: f64| PointView {
        name: Text::clipped(name),
        device: Some(0),
        is_output: true,
        raw: 1.0,
        value,
    };
    (view.points[0], view.points[1]) = (output("v.open", 0.0), output("v.close", 1.0));
    let lines = |view: &FieldView| -> Vec<String> {
        let sections = points::sections(Some(view), "v.", 80);
        sections.into_iter().flat_map(|section| section.lines).map(|line| line.text).collect()
    };
    let shown = lines(&view);
    assert!(
        shown.iter().any(|line| line.starts_with("!!v.open") && line.ends_with("off DIFFERS")),
        "{shown:?}"
    );
    assert!(
        shown.iter().any(|line| line.starts_with("  v.close") && line.trim_end().ends_with("on")),
        "{shown:?}"
    );
    view.devices[0].state = Name16::clipped("tripped");
    let shown = lines(&view);
    assert!(shown.iter().filter(|line| line.ends_with("TRIPPED")).count() == 2, "{shown:?}");
}
