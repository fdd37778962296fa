//! The cell screen: the controller's sensors with joint margins, hand, grippers and holsters, and the parts.

use std::f64::consts::TAU;

use geometry::kinematics::{JOINT_NAMES, Joints, T3};
use interfaces::{
    CommonMemory,
    device::{DeviceInputs, RESOLVER_COUNTS},
};
use record::views::{Controller, JobState, Part};

use super::{Section, Text, Tone, drawing::Drawing};
use crate::rcs_console::{picture::Picture, source::Cell};

const NEAR: f64 = 10.0; // a joint nearer to a limit than this is marked, degrees
const BAR: f64 = 10.0; // margin per character of the bar, degrees
const LONGEST: f64 = 12.0; // length of the longest bar, characters

#[must_use]
pub fn sections(picture: &Picture, cell: &Cell) -> Vec<Section> {
    let devices = &picture.external.devices;
    vec![joints(devices), hand(&picture.memory, devices), holsters(devices), parts(cell), surroundings(cell)]
}

/// Drawings of the cell in two views, with the arm at the joint angles of the resolvers, for a body of this size.
#[must_use]
pub fn drawn(picture: &Picture, drawing: &Drawing, width: usize, room: usize) -> Vec<Section> {
    let devices = &picture.external.devices;
    if !devices.resolvers.valid {
        return vec![joints(devices)];
    }
    drawing.sections(&angles(devices), width, room)
}

/// Joint angles from the resolvers, rad, shifted by full turns into the limits of the arm.
fn angles(devices: &DeviceInputs) -> Joints {
    let turn = TAU / f64::from(RESOLVER_COUNTS);
    T3.within_limits(&devices.resolvers.counts.map(|counts| f64::from(counts) * turn))
}

fn joints(devices: &DeviceInputs) -> Section {
    if !devices.resolvers.valid {
        let text = " the resolver box has no power: the angles are not known";
        return Section::new("joints", vec![Text::new(Tone::Faint, text)]);
    }
    let angles = angles(devices);
    let line = |((name, angle), (low, high)): ((&str, &f64), (f64, f64))| {
        let margin = (angle - low).min(high - angle).to_degrees();
        let (mark, tone) = if margin < NEAR { ("!!", Tone::Trouble) } else { ("  ", Tone::Plain) };
        let bar = "#".repeat((margin / BAR).clamp(0.0, LONGEST).round() as usize);
        Text::new(
            tone,
            format!(
                "{mark}{name:<9}{:>8.1} deg   {:>6.0} to {:>4.0}   {margin:>6.1} to the limit  {bar}",
                angle.to_degrees(),
                low.to_degrees(),
                high.to_degrees()
            )
            .trim_end()
            .to_owned(),
        )
    };
    let lines = JOINT_NAMES.into_iter().zip(&angles).zip(T3.limits).map(line).collect();
    let least = T3.margin(&angles);
    let title = format!(
        "joints, by the resolvers; nearest to a limit: {}, {:.1} deg",
        JOINT_NAMES[least.joint],
        least.radians.to_degrees()
    );
    Section::new(title, lines)
}

fn hand(memory: &CommonMemory, devices: &DeviceInputs) -> Section {
    let inches = |hundredths: i32| f64::from(hundredths) / 100.0;
    let tool = memory.t3i.status.resolver_frame.map_or_else(
        || "the place of the tool point is not known".to_owned(),
        |frame| {
            let [x, y, z] = frame.tool.map(inches);
            format!("tool point {x:.2} {y:.2} {z:.2} in, by the resolvers")
        },
    );
    let on = match memory.quick_change.status.end_effector_id {
        Some(1) => "parts gripper",
        Some(2) => "v-gripper",
        Some(3) => "tool gripper",
        Some(_) => "a gripper whose id pins have a bad contact",
        None => "no gripper",
    };
    let grip = &memory.grip.status;
    let beams: String =
        (0..8).map(|bit| if devices.grip.beams >> bit & 1 == 1 { '#' } else { '.' }).collect();
    let held = memory.subtask.status.held;
    let lines = vec![
        Text::plain(format!(" {tool}")),
        Text::plain(format!(" on the robot: {on}; locking ring {}", memory.quick_change.status.ring)),
        Text::plain(format!(
            " Grip {:.2} in, {} and {} lb, between the fingers: {}; beams {beams}",
            inches(grip.position),
            grip.left_force,
            grip.right_force,
            grip.felt
        )),
        Text::plain(format!(" Subtask holds: {}", holding(&held))),
        Text::plain(format!(
            " pedestal: table {}, hand {:.2} in, {} and {} lb",
            memory.table.status.position.map_or_else(
                || "not calibrated".to_owned(),
                |tenths| format!("{:.1} deg", f64::from(tenths) / 10.0)
            ),
            inches(memory.hand.status.position),
            memory.hand.status.left_force,
            memory.hand.status.right_force
        )),
    ];
    Section::new("hand", lines)
}

fn holding(held: &interfaces::emove::Holding) -> String {
    use interfaces::emove::Holding;
    match held {
        Holding::Nothing => "nothing".to_owned(),
        Holding::Something => "something unknown".to_owned(),
        Holding::NotKnown => "not known".to_owned(),
        Holding::Object(grip) => format!("{} with grip {}", grip.object, grip.grip),
    }
}

/// The sensors of a holster (V.1.2): bits 0 and 1 see the ears at the rear, 2 and 3 at the seat.
pub(super) fn holster(bits: u8) -> &'static str {
    match (bits & 0b0011, bits & 0b1100) {
        (0, 0) => "empty",
        (0b0011, 0b1100) => "seated",
        _ => "between",
    }
}

fn holsters(devices: &DeviceInputs) -> Section {
    let sensors = &devices.holsters;
    let text = format!(
        " right {}   left {}   centre {}",
        holster(sensors.right),
        holster(sensors.left),
        holster(sensors.centre)
    );
    Section::new("holsters, by their sensors", vec![Text::plain(text)])
}

fn parts(cell: &Cell) -> Section {
    let lines: Vec<Text> = match cell {
        Cell::NotPublished => {
            vec![Text::new(Tone::Faint, " the robot is at a port: no simulated cell shows them")]
        }
        Cell::Recorded(cell) => {
            cell.parts.iter().map(|(part, position)| self::part(part, *position)).collect()
        }
        Cell::Shown(view) => {
            let shown = view.parts.iter().filter(|part| part.id > 0).map(|part| {
                let state = Part {
                    name: part.name.to_string(),
                    location: part.location.to_string(),
                    sector: part.sector.into(),
                    held: part.held,
                    clamped: part.clamped,
                    ..Part::default()
                };
                self::part(&state, part.position)
            });
            shown.collect()
        }
    };
    let none = vec![Text::new(Tone::Faint, " none has been delivered yet")];
    Section::new("parts, as the simulated cell has them", if lines.is_empty() { none } else { lines })
}

fn part(part: &Part, [x, y, z]: [f64; 3]) -> Text {
    let held = match (part.held, part.clamped) {
        (true, _) => ", held by the gripper",
        (_, true) => ", held by the vise",
        _ => "",
    };
    let sector = if part.sector > 0 { format!(" sector {}", part.sector) } else { String::new() };
    let place = format!("{}{sector}{held}", part.location);
    Text::plain(format!(" {:<17} {x:>8.2} {y:>8.2} {z:>8.2} in  {place}", part.name).trim_end())
}

/// E-stops, robot controller and job, then the data that only a live run has, or only a log.
fn surroundings(cell: &Cell) -> Section {
    let faint = |text: &str| Text::new(Tone::Faint, text);
    let mut lines = match cell.controller() {
        Some(controller) => controller_lines(&controller),
        None => vec![faint(" the E-stops are at the robot")],
    };
    lines.extend(cell.job().map(|job| Text::plain(format!(" {}", progress(&job)))));
    match cell {
        Cell::NotPublished => {}
        Cell::Shown(view) => {
            lines.push(Text::plain(format!(" vise {:.2} in", view.vise_opening)));
            lines.push(faint(" clearances are in the log of the run"));
        }
        Cell::Recorded(log) => {
            if log.job.is_none() {
                lines = vec![faint(
                    " the log of an older program has no E-stops, no robot controller and no job",
                )];
            }
            lines.push(match &log.clearance {
                Some(clearance) => Text::plain(format!(" closest in the whole run: {clearance}")),
                None => faint(" the log has no closest clearance"),
            });
            let contacts = log.contacts.iter();
            lines.extend(
                contacts.map(|contacts| Text::new(Tone::Trouble, format!("!! contacts: {contacts}"))),
            );
        }
    }
    Section::new("E-stops, robot controller, job", lines)
}

fn controller_lines(controller: &Controller) -> Vec<Text> {
    let Controller { stage, pressed, cut, screen, screen_tick, .. } = controller;
    let mut lines = vec![match pressed.is_empty() {
        true => Text::plain(" E-stops: all five are out"),
        false => Text::new(Tone::Trouble, format!("!! E-stop is pressed: {}", pressed.join(", "))),
    }];
    if !cut.is_empty() {
        lines.push(Text::new(Tone::Trouble, format!("!! no pressure: {cut}")));
    }
    lines.push(Text::plain(format!(" robot controller: {stage}")));
    if !screen.is_empty() {
        lines.push(Text::new(Tone::Trouble, format!("!! its screen since tick {screen_tick}: {screen}")));
    }
    lines
}

fn progress(job: &JobState) -> String {
    match (job.lines, job.text.as_str()) {
        (_, "") => "job: nothing has begun yet".to_owned(),
        (0, step) => format!("workstation controller: {step}"),
        (lines, step) => format!("job: line {} of {lines}; last {step}", job.index),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rcs_console::source::RecordedCell;
    use executive::memory::{
        Text as MemoryText,
        cell::{CellView, PartView},
    };

    #[test]
    fn angles_are_shifted_into_the_limits() {
        let mut devices = DeviceInputs::default();
        // The joint turns back by 190 degrees, converted to resolver counts.
        devices.resolvers.counts[0] = RESOLVER_COUNTS * 170 / 360;
        let base = angles(&devices)[0].to_degrees();
        assert!((base + 190.0).abs() < 0.01, "{base}");
    }

    #[test]
    fn joint_near_its_limit_is_marked() {
        let mut devices = DeviceInputs::default();
        devices.resolvers.valid = true;
        devices.resolvers.counts[1] = RESOLVER_COUNTS * 45 / 360;
        devices.resolvers.counts[2] = RESOLVER_COUNTS * 270 / 360;
        let lines = joints(&devices).lines;
        let marked = |lines: &[Text]| lines.iter().filter(|line| line.text.starts_with("!!")).count();
        assert_eq!(marked(&lines), 0, "{lines:?}");
        devices.resolvers.counts[1] = RESOLVER_COUNTS * 85 / 360;
        assert_eq!(marked(&joints(&devices).lines), 1);
        devices.resolvers.valid = false;
        assert!(joints(&devices).lines[0].text.contains("no power"));
    }

    #[test]
    fn run_and_log_show_the_same_states_and_parts() {
        let mut view = CellView::default();
        let text =
            |section: Section| section.lines.into_iter().map(|line| line.text).collect::<Vec<_>>().join("\n");
        let shown = |view: &CellView| text(surroundings(&Cell::Shown(Box::new(*view))));
        assert!(shown(&view).contains("all five are out") && !shown(&view).contains("!!"));
        view.controller.estops[3] = true;
        view.job.lines = 3;
        view.job.begun = 2;
        view.job.line = MemoryText::clipped("PAUSE");
        view.parts[0] = PartView { id: 1, held: true, position: [1.0, 2.0, 3.5], ..PartView::default() };
        let live = Cell::Shown(Box::new(view));
        let part = Part { held: true, ..Part::default() };
        let log = RecordedCell {
            job: live.job(),
            controller: live.controller(),
            parts: vec![(part, [1.0, 2.0, 3.5])],
            ..RecordedCell::default()
        };
        let log = Cell::Recorded(Box::new(log));
        for cell in [&live, &log] {
            let said = text(surroundings(cell));
            assert!(said.contains("!! E-stop is pressed: on the joystick box"), "{said}");
            assert!(said.contains("job: line 2 of 3; last PAUSE"), "{said}");
        }
        assert_eq!(text(parts(&live)), text(parts(&log)));
        assert!(text(parts(&log)).contains("3.50 in") && text(parts(&log)).contains("held by the gripper"));
        let old = text(surroundings(&Cell::Recorded(Box::default())));
        assert!(old.contains("older program has no E-stops"), "{old}");
    }

    #[test]
    fn progress_names_the_line_and_the_last_step() {
        let mut job = JobState { lines: 1, index: 1, ..JobState::default() };
        assert_eq!(progress(&job), "job: nothing has begun yet");
        job.text = "PAUSE".into();
        assert_eq!(progress(&job), "job: line 1 of 1; last PAUSE");
        job.lines = 0;
        assert_eq!(progress(&job), "workstation controller: PAUSE");
    }

    #[test]
    fn holster_text_names_the_gripper_position() {
        assert_eq!([0b0000, 0b0011, 0b1111].map(holster), ["empty", "between", "seated"]);
    }
}
