//! The panel screen: present state of joystick box (III.3.3), robot controller (IV.3.3), emergency stops
//! (III.6), rotary table (IV.1 step 3) and Active Pedestal (VI.7), and the requests to a run.

use executive::memory::cell::TableView;
use geometry::units::inches;
use interfaces::{
    CommonMemory,
    device::{DeviceInputs, JoystickBox, KNOB_FULL, PedestalSensors, TABLE_STEPS_PER_TENTH},
    grip::Felt,
    pedestal::PedestalVerb,
    station::{BoxFrame, Stepped},
};

use super::{
    Section, Text, Tone,
    band::late_devices,
    session::{JOGS, Operating},
};
use crate::rcs_console::source::Cell;

/// The requests of the key list: a title, and the words that follow it. Words without a title are whole requests.
const KEYS: [(&str, &[&str]); 7] = [
    ("job", &["go", "wait", "skip"]),
    ("", &["PAUSE", "leave", "joystick hold EMOVE", "joystick free EMOVE"]),
    (
        "panel",
        &[
            "power on",
            "power off",
            "fault-reset",
            "hydraulics enable",
            "hydraulics disable",
            "manual on",
            "manual off",
            "align",
            "auto",
            "cycle-start",
            "interrupt",
            "cancel",
            "enter",
            "hold on",
            "hold off",
        ],
    ),
    ("release", &["control-panel", "teach-pendant", "terminals", "joystick-box", "pedestal"]),
    (
        "table",
        &[
            "power off",
            "power on",
            "mode manual",
            "run+ 25",
            "run- 25",
            "step+",
            "step-",
            "reset",
            "mode prog",
        ],
    ),
    (
        "pedestal",
        &["pause", "pre-grip OBJECT", "grip OBJECT", "flip 180", "flip -180", "release", "release by hand"],
    ),
    ("confirm", &["clamped", "by hand"]),
];
/// Placeholder that the operator replaces by a name before the request is sent.
pub const TO_NAME: &str = "OBJECT";
const WIDTH: usize = 79; // columns of a line of the key list

pub fn requests() -> impl Iterator<Item = String> {
    let whole = |title: &str, words: &str| format!("{title} {words}").trim_start().to_owned();
    KEYS.iter().flat_map(move |(title, all)| all.iter().map(move |words| whole(title, words)))
}

/// A request of the list; empty if the list has no such request.
#[must_use]
pub fn request(at: usize) -> String {
    requests().nth(at).unwrap_or_default()
}

#[must_use]
pub fn sections(
    devices: &DeviceInputs,
    memory: &CommonMemory,
    cell: &Cell,
    operating: Option<&Operating>,
) -> Vec<Section> {
    let mut lines = joystick_box(&devices.joystick, memory.prim.status.recording, operating);
    lines.extend(controller(cell));
    lines.push(pedestal(memory));
    lines.extend(late_devices(&devices.field).map(|text| Text::new(Tone::Marked, format!(" {text}"))));
    if let Cell::Shown(view) = cell {
        lines.push(rotary_table(&devices.pedestal, view.table));
    }
    let keys = match operating {
        Some(operating) => keys(operating),
        None => look_only(),
    };
    vec![Section::new("joystick box, robot controller, active pedestal", lines), keys]
}

fn look_only() -> Section {
    let text = " This console is read-only: start it with --operate to work on a run.";
    Section::new("keys", vec![Text::new(Tone::Faint, text)])
}

fn frame(joystick: &JoystickBox) -> &'static str {
    match BoxFrame::from_bits(joystick.frame) {
        Some(BoxFrame::Off) => "no frame is on",
        Some(frame) => frame.text(),
        None => "several frames are on: it moves nothing",
    }
}

fn joystick_box(joystick: &JoystickBox, recording: bool, operating: Option<&Operating>) -> Vec<Text> {
    let held = Stepped::ALL.iter().filter(|process| joystick.hold & process.bit() != 0);
    let held: Vec<&str> = held.map(|process| process.process().text()).collect();
    let held = if held.is_empty() { "no process".to_owned() } else { held.join(", ") };
    let percent = u32::from(joystick.velocity) * 100 / u32::from(KNOB_FULL);
    let mut lines =
        vec![Text::plain(format!(" box       {}   knob {percent} %   holds {held}", frame(joystick)))];
    if recording {
        lines.push(Text::new(
            Tone::Marked,
            " record    E-move and Prim are suspended until carriage return (M)",
        ));
    }
    if let Some(operating) = operating {
        let jog = JOGS.get(operating.jog).copied().unwrap_or_default();
        let keys = [
            "   w t o r=WORLD TOOL TOOL-ORIGIN WRIST-ORIGIN  x=off  - +=knob  h z=hold, step".to_owned(),
            format!("   arrows=X Y  PgUp PgDn=Z  , .=roll  {{ }}=gripper  s={jog:.2} in  m=record M=return"),
        ];
        lines.extend(keys.map(|text| Text::new(Tone::Faint, text)));
    }
    lines
}

fn controller(cell: &Cell) -> Vec<Text> {
    let Some(t3) = cell.controller() else {
        let text = match cell {
            Cell::Recorded(log) if log.job.is_none() => {
                " robot     this log of an older program has no panel"
            }
            _ => " robot     not simulated here: its panel and its E-stops are at the robot",
        };
        return vec![Text::new(Tone::Faint, text)];
    };
    let lit = |on: bool, name: &'static str| on.then_some(name);
    let lamps = [
        lit(t3.lamps.power, "POWER"),
        lit(t3.lamps.fault_reset, "FAULT RESET"),
        lit(t3.lamps.hydraulics_enabled, "HYD ENABLED"),
        lit(t3.lamps.hydraulics_on, "MANUAL"),
        lit(t3.lamps.auto, "AUTO"),
        lit(t3.lamps.hold, "HOLD"),
    ];
    let lamps: Vec<_> = lamps.into_iter().flatten().collect();
    let aligned = match cell {
        Cell::Shown(view) => view.controller.aligned.map(|axis| if axis { "*" } else { "." }).concat(),
        Cell::NotPublished | Cell::Recorded(_) => String::new(),
    };
    let aligned = if aligned.is_empty() { aligned } else { format!("   aligned {aligned}") };
    let estops = match t3.pressed.is_empty() {
        true => Text::plain(format!(" E-stops   all five are out{aligned}")),
        false => Text::new(Tone::Trouble, format!("!!E-stops   pressed: {}{aligned}", t3.pressed.join(", "))),
    };
    let mut lines =
        vec![Text::plain(format!(" robot     stage {}   lit: {}", t3.stage, lamps.join(", "))), estops];
    if !t3.screen.is_empty() {
        lines.push(Text::plain(format!(" screen    {}", t3.screen)));
    }
    lines
}

/// The counter of the table, in degrees with two decimals (IV.1 step 3).
fn rotary_table(sensors: &PedestalSensors, panel: TableView) -> Text {
    let counter = f64::from(sensors.motor_counter) / f64::from(TABLE_STEPS_PER_TENTH * 10);
    let at = match (sensors.limit_plus, sensors.limit_minus) {
        (true, _) => "at its + limit",
        (_, true) => "at its - limit",
        _ if sensors.motor_moving => "turns",
        _ => "stands",
    };
    let mode = if panel.manual { "MANUAL" } else { "PROG" };
    let shown = match panel {
        TableView { power: false, .. } => format!("power off, mode {mode}"),
        TableView { obeys: true, .. } => format!("power on, mode {mode}, obeys its serial line"),
        TableView { manual: true, .. } => format!("power on, mode {mode}: RUN, STEP and RESET count"),
        _ => format!("power on, mode {mode}: turn it off and on"),
    };
    Text::plain(format!(" counter {counter:>7.2}, {at}; {shown}"))
}

fn pedestal(memory: &CommonMemory) -> Text {
    let status = &memory.pedestal.status;
    let part = memory.subtask.regrip.map_or_else(|| "a part".to_owned(), |regrip| regrip.object.to_string());
    let holds = match status.felt {
        Felt::Something if status.gripped => format!("holds {part}"),
        Felt::NotKnown if status.gripped => format!("may hold {part}"),
        Felt::Something | Felt::Nothing | Felt::NotKnown => "holds nothing".to_owned(),
    };
    let angle = status.table_position.map_or_else(
        || "at an unknown angle".to_owned(),
        |tenths| format!("at {:.1} deg", f64::from(tenths) / 10.0),
    );
    let opening = inches(status.grip_size);
    let command = match memory.subtask.pedestal.command {
        PedestalVerb::None => "no command",
        verb => verb.text(),
    };
    Text::plain(format!(" hand {holds}, {opening:.2} in open; table {angle}; {command} {}", status.report))
}

fn keys(operating: &Operating) -> Section {
    let mut lines = Vec::new();
    let (mut line, mut number, mut at) = (String::new(), 0, 0);
    for (title, all) in KEYS {
        let mut title = if title.is_empty() { String::new() } else { format!(" {title}:") };
        for words in all {
            let is_chosen = number == operating.cursor;
            let shown = if is_chosen { format!("[{words}]") } else { format!(" {words} ") };
            let shown = std::mem::take(&mut title) + &shown;
            if line.chars().count() + shown.chars().count() > WIDTH {
                lines.push(Text::plain(std::mem::take(&mut line)));
            }
            line.push_str(&shown);
            if is_chosen {
                at = lines.len();
            }
            number += 1;
        }
    }
    lines.push(Text::plain(line));
    if let Some(line) = lines.get_mut(at) {
        line.tone = Tone::Marked;
    }
    let title = format!("keys: j k=choose, Enter=press `{}`", request(operating.cursor));
    Section { title, lines, at }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rcs_console::source::RecordedCell;
    use record::views::{Controller, JobState};

    fn text(lines: Vec<Text>) -> String {
        lines.into_iter().map(|line| line.text).collect::<Vec<_>>().join("\n")
    }

    /// The smallest terminal has room for 18 lines below the band, including the two titles.
    #[test]
    fn panels_with_all_requests_fit_the_smallest_terminal() {
        let mut operating = Operating::default();
        operating.cursor = 21;
        let cell = Cell::Shown(Box::default());
        let all = sections(&DeviceInputs::default(), &CommonMemory::default(), &cell, Some(&operating));
        let lines: Vec<_> = all.into_iter().flat_map(|section| section.lines).collect();
        // A message on the screen of the robot controller adds one line.
        assert!(lines.len() < 18 - 2, "{}", text(lines));
        assert!(lines.iter().all(|line| line.text.chars().count() <= 80), "{}", text(lines));
        let said = text(lines);
        for (_, words) in KEYS {
            assert!(words.iter().all(|words| said.contains(words)), "{said}");
        }
        assert!(said.contains("[hold off]"), "{said}");
    }

    #[test]
    fn recorded_pose_suspends_prim_and_emove_until_return() {
        let shown = |recording| text(joystick_box(&JoystickBox::default(), recording, None));
        assert!(!shown(false).contains("suspended"));
        assert!(shown(true).contains("E-move and Prim are suspended until carriage return (M)"));
    }

    #[test]
    fn panel_of_a_log_is_that_of_its_robot_controller() {
        let shown = |log: RecordedCell| text(controller(&Cell::Recorded(Box::new(log))));
        assert!(shown(RecordedCell::default()).contains("older program"));
        let recorded =
            Some(Controller { pressed: vec!["near the pedestal".into()], ..Controller::default() });
        let log =
            RecordedCell { job: Some(JobState::default()), controller: recorded, ..RecordedCell::default() };
        assert!(shown(log).contains("!!E-stops   pressed: near the pedestal"));
        let at_a_port = RecordedCell { job: Some(JobState::default()), ..RecordedCell::default() };
        assert!(shown(at_a_port).contains("its E-stops are at the robot"));
        assert!(text(controller(&Cell::NotPublished)).contains("its E-stops are at the robot"));
    }
}
