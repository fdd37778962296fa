//! The panel screen: joystick box (III.3.3), robot controller (IV.3.3), emergency stops (III.6), rotary table (IV.1
//! step 3) and Active Pedestal (VI.7) in their present state, and the requests to a run.

use executive::memory::cell::TableView;
use geometry::units::inches;
use interfaces::{
    CommonMemory,
    device::{DeviceInputs, JoystickBox, KNOB_FULL, PedestalSensors, TABLE_STEPS_PER_TENTH},
    grip::Felt,
    pedestal::PedestalVerb,
    station::{BoxFrame, EStop, Stepped},
};

use super::{
    Section, Text, Tone,
    session::{JOGS, Operating},
};
use crate::rcs_console::source::Cell;

/// The requests of the key list, in order.
pub const KEYS: [&str; 45] = [
    "job go",
    "job wait",
    "job skip",
    "PAUSE",
    "panel power on",
    "panel power off",
    "panel fault-reset",
    "panel hydraulics enable",
    "panel hydraulics disable",
    "panel manual on",
    "panel manual off",
    "panel align",
    "panel auto",
    "panel cycle-start",
    "panel interrupt",
    "panel cancel",
    "panel enter",
    "panel hold on",
    "panel hold off",
    "release control-panel",
    "release teach-pendant",
    "release terminals",
    "release joystick-box",
    "release pedestal",
    "joystick hold EMOVE",
    "joystick free EMOVE",
    "table power off",
    "table power on",
    "table mode manual",
    "table run+ 25",
    "table run- 25",
    "table step+",
    "table step-",
    "table reset",
    "table mode prog",
    "pedestal pause",
    "pedestal pre-grip OBJECT",
    "pedestal grip OBJECT",
    "pedestal flip 180",
    "pedestal flip -180",
    "pedestal release",
    "pedestal release by hand",
    "confirm clamped",
    "confirm by hand",
    "leave",
];
/// Word of a key that the operator replaces by a name before it is sent.
pub const TO_NAME: &str = "OBJECT";
/// Number of keys shown around the cursor.
const SHOWN: usize = 3;

/// The sections: box, controller, pedestal and keys, from top to bottom.
#[must_use]
pub fn sections(
    devices: &DeviceInputs,
    memory: &CommonMemory,
    cell: &Cell,
    operating: Option<&Operating>,
) -> Vec<Section> {
    let mut sections =
        vec![joystick_box(&devices.joystick, memory.prim.status.recording, operating), controller(cell)];
    let mut lines = vec![pedestal(memory)];
    if let Cell::Shown(view) = cell {
        lines.push(rotary_table(&devices.pedestal, view.table));
    }
    sections.push(Section::new("active pedestal", lines));
    match operating {
        Some(operating) => sections.push(keys(operating)),
        None => sections.push(look_only()),
    }
    sections
}

fn look_only() -> Section {
    let text = " This console looks only: start it with --operate to work on a run.";
    Section::new("keys", vec![Text::new(Tone::Faint, text)])
}

fn frame(joystick: &JoystickBox) -> &'static str {
    match BoxFrame::from_bits(joystick.frame) {
        Some(BoxFrame::Off) => "no frame is on: the box moves nothing",
        Some(frame) => frame.text(),
        None => "several switches are on: the box moves nothing",
    }
}

fn joystick_box(joystick: &JoystickBox, recording: bool, operating: Option<&Operating>) -> Section {
    let held = Stepped::ALL.iter().filter(|process| joystick.hold & process.bit() != 0);
    let held: Vec<&str> = held.map(|process| process.process().text()).collect();
    let held = if held.is_empty() { "no process".to_owned() } else { held.join(", ") };
    let percent = u32::from(joystick.velocity) * 100 / u32::from(KNOB_FULL);
    let bar = "#".repeat(usize::try_from(percent / 5).unwrap_or_default());
    let mut lines = vec![
        Text::plain(format!(" frame   {}", frame(joystick))),
        Text::plain(format!(" knob    {percent:>3} %  {bar}")),
        Text::plain(format!(" holds   {held}")),
    ];
    if recording {
        lines.push(Text::new(
            Tone::Marked,
            " record  E-move and Prim are suspended until carriage return (M)",
        ));
    }
    if let Some(operating) = operating {
        let jog = JOGS.get(operating.jog).copied().unwrap_or_default();
        let keys = [
            " w t o r=frame WORLD, TOOL, TOOL-ORIGIN, WRIST-ORIGIN   x=off".to_owned(),
            " ` 1 ... 9 0=knob 0, 10 ... 90, 100 %   h=hold Prim   z=step Prim".to_owned(),
            format!(" arrows=X Y   PgUp PgDn=Z   , .=roll   {{ }}=gripper   a key moves {jog:.2} in (s)"),
            " m=record the pose   M=return after it".to_owned(),
        ];
        lines.extend(keys.map(|text| Text::new(Tone::Faint, text)));
    }
    Section::new("joystick box", lines)
}

fn controller(cell: &Cell) -> Section {
    let view = match cell {
        Cell::Shown(view) => view,
        Cell::NotPublished => {
            let text = " the robot is not simulated here: its panel and its E-stops are at the robot";
            return Section::new("robot controller", vec![Text::new(Tone::Faint, text)]);
        }
        Cell::Recorded { .. } => {
            let text = " a log has no panel: the messages of the controller are on screen 3";
            return Section::new("robot controller", vec![Text::new(Tone::Faint, text)]);
        }
    };
    let t3 = &view.controller;
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
    let aligned: String = t3.aligned.iter().map(|axis| if *axis { '*' } else { '.' }).collect();
    let mut lines = vec![
        Text::plain(format!(" stage   {}   lit: {}", t3.stage, lamps.join(", "))),
        Text::plain(format!(" screen  {}   aligned {aligned}", t3.screen)),
    ];
    if !t3.cut.to_string().is_empty() {
        lines.push(Text::new(Tone::Trouble, format!("!!no pressure: {}", t3.cut)));
    }
    let pressed: Vec<_> = t3
        .estops
        .iter()
        .zip(EStop::ALL)
        .filter(|(pressed, _)| **pressed)
        .map(|(_, site)| site.text())
        .collect();
    lines.push(match pressed.is_empty() {
        true => Text::plain(" E-stops all five are out"),
        false => Text::new(Tone::Trouble, format!("!!E-stops that are in: {}", pressed.join(", "))),
    });
    Section::new("robot controller", lines)
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

/// Hand and table of the Active Pedestal, and its last command.
fn pedestal(memory: &CommonMemory) -> Text {
    let status = &memory.pedestal.status;
    let part = memory.subtask.regrip.map_or_else(|| "a part".to_owned(), |regrip| regrip.object.to_string());
    let holds = match status.felt {
        Felt::Something if status.gripped => format!("holds {part}"),
        Felt::NotKnown if status.gripped => format!("may hold {part}"),
        Felt::Something | Felt::Nothing | Felt::NotKnown => "holds nothing".to_owned(),
    };
    let angle = status.table_position.map_or_else(
        || "at no known angle".to_owned(),
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
    let first = operating.cursor.saturating_sub(SHOWN / 2).min(KEYS.len().saturating_sub(SHOWN));
    let line = |(at, key): (usize, &&str)| {
        let (mark, tone) = if at == operating.cursor { ('>', Tone::Marked) } else { (' ', Tone::Plain) };
        Text::new(tone, format!(" {mark} {key}"))
    };
    let shown = KEYS.iter().enumerate().skip(first).take(SHOWN).map(line);
    let title = format!("keys, {} of {}: j k=choose, Enter=press", operating.cursor + 1, KEYS.len());
    Section::new(title, shown.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(section: Section) -> String {
        section.lines.into_iter().map(|line| line.text).collect::<Vec<_>>().join("\n")
    }

    #[test]
    fn a_recorded_pose_suspends_prim_and_emove_until_carriage_return() {
        let shown = |recording| text(joystick_box(&JoystickBox::default(), recording, None));
        assert!(!shown(false).contains("suspended"));
        assert!(shown(true).contains("E-move and Prim are suspended until carriage return (M)"));
    }

    #[test]
    fn a_log_is_not_a_robot_at_a_port() {
        let log = Cell::Recorded { parts: Vec::new(), clearance: None, contacts: None };
        assert!(!text(controller(&log)).contains("at the robot"));
        assert!(text(controller(&Cell::NotPublished)).contains("its E-stops are at the robot"));
    }
}
