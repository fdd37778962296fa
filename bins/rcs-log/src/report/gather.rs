//! Collects the contents of the page from a log, tick by tick.

use std::path::Path;

use closed_loop::{account::Account, failure};
use geometry::pose::WireFrame;
use interfaces::{
    CommonMemory,
    device::{FORCE_COUNTS_PER_LB, FORCE_ZERO},
};
use levels::ladder::{Ladder, ProcessId};
use rcs_core::{
    name::Name16,
    tick::{TICK_S, Tick},
};
use record::{Attachment, Log, proto::foxglove::Level, remarks::is_restart_ordered};

use super::scene::{FROM_ABOVE, FROM_THE_SIDE, Scene};
use crate::{
    Error,
    story::{Chronicle, Moment, walk},
    why::{History, Told, tell},
};

/// Number of levels with a lane in the timeline: the first processes of the ladder, Task to Prim.
pub const LANES: usize = 4;
/// The link whose origin is the tool point.
const TOOL: &str = "quick_change";
/// Greatest number of pictures; with more commands, only every n-th command has a picture.
const PICTURES: usize = 36;

/// Consecutive ticks in which a level had the same command.
#[derive(Clone, Debug, PartialEq)]
pub struct Stretch {
    /// First tick.
    pub from: u64,
    /// Last tick.
    pub to: u64,
    /// The command as text; empty for none.
    pub text: String,
    /// Steps of the command, each with its first tick.
    pub steps: Vec<(u64, String)>,
}

/// A picture of the cell before a tick.
pub struct Picture {
    /// The tick.
    pub tick: u64,
    /// What begins or ends in the tick.
    pub text: String,
    /// The drawing, as SVG.
    pub svg: String,
    /// Close-up drawings around the tool point at the failure, with their titles.
    pub near: Vec<(&'static str, String)>,
}

/// The closest approach of an obstacle to the robot in the run.
#[derive(Clone, Debug, PartialEq)]
pub struct Clearance {
    /// The tick.
    pub tick: u64,
    /// Text of the log about it.
    pub text: String,
}

/// The contents of the page. All series have one value per tick.
#[derive(Default)]
pub struct Run {
    /// Number of each tick.
    pub ticks: Vec<u64>,
    /// Names of the lanes, with their stretches.
    pub lanes: Vec<(&'static str, Vec<Stretch>)>,
    /// Speed of the commanded tool point, in/s.
    pub speed: Vec<f64>,
    /// Angular speed of the commanded tool frame, rad/s.
    pub turning: Vec<f64>,
    /// Commanded tool points, inches.
    pub path: Vec<[f64; 3]>,
    /// Opening of the parts gripper, in.
    pub opening: Vec<f64>,
    /// The greater of the forces of its fingers, lb.
    pub force: Vec<f64>,
    /// Force on the tool gripper's sensor without its bias, lb; 0 without power.
    pub tool_force: Vec<f64>,
    /// NAKs, time-outs, checksum errors and re-starts in the tick.
    pub link_faults: Vec<u32>,
    /// Stretches in which the link was running.
    pub link: Vec<Stretch>,
    /// Time of the controller part of the tick, us; empty in logs of runs in fast clock.
    pub controller: Vec<f64>,
    /// Number of skipped slots of the 40 ms grid.
    pub overruns: u64,
    /// Commands and the failure of the run.
    pub chronicle: Chronicle,
    /// What went wrong first, and what followed.
    pub account: Option<Account>,
    /// The explained failure.
    pub failure: Option<Told>,
    /// Warnings and errors on `/log`.
    pub lines: Vec<(Tick, Level, String, String)>,
    /// Number of all lines on `/log`.
    pub all_lines: usize,
    /// The cell at the start of commands, at the start of the failure, and at the end.
    pub pictures: Vec<Picture>,
    /// The closest approach of an obstacle.
    pub clearance: Option<Clearance>,
}

/// Reads a log.
pub fn gather(log: &Log, path: &Path) -> Result<Run, Error> {
    let names = Ladder::processes().iter().take(LANES).map(|process| (process.name, Vec::new()));
    let mut run = Run { lanes: names.collect(), ..Run::default() };
    let mut history = History::default();
    walk(log, path, |moment| {
        history.note(moment);
        run.note(moment);
        true
    })?;
    if run.ticks.is_empty() {
        return Err(Error::Empty(path.to_owned()));
    }
    run.account = run.chronicle.account(log);
    let reported = run.account.as_ref().map_or(run.chronicle.failure.as_ref(), Account::of_process);
    run.failure = reported.and_then(|failure| tell(log, &history, failure, run.account.as_ref()));
    for line in log.lines() {
        run.all_lines += 1;
        if matches!(line.level, Level::Warning | Level::Error) {
            run.lines.push((line.tick, line.level, line.source, line.text));
        }
    }
    run.pictures = pictures(log, &run);
    run.clearance = log.end.as_ref().and_then(|end| end.get("clearance")).and_then(|text| clearance(text));
    Ok(run)
}

impl Run {
    fn note(&mut self, moment: &Moment) {
        self.chronicle.note(moment);
        let tick = moment.tick.0;
        self.ticks.push(tick);
        for ((_, lane), process) in self.lanes.iter_mut().zip(ProcessId::ALL) {
            let header = moment.after.header(*process);
            let command = |memory| failure::command(*process, &moment.external.hws, memory);
            let text = command(&moment.after);
            // A command written in this tick is read in the next one, so the step still belongs to the previous
            // command.
            let step =
                if text == command(&moment.before) { header.step.unwrap_or_default() } else { Name16::EMPTY };
            extend(lane, tick, text, &step);
        }
        let (speed, turning) = motion(&moment.before, &moment.after);
        self.speed.push(speed);
        self.turning.push(turning);
        let status = &moment.after.t3i.status;
        self.path.push(status.frame_feedback.tool.map(|hundredths| f64::from(hundredths) / 100.0));
        let running = if status.link_running { "the link runs" } else { "" };
        extend(&mut self.link, tick, running.to_owned(), &Name16::EMPTY);
        let grip = &moment.after.grip.status;
        self.opening.push(f64::from(grip.position) / 100.0);
        self.force.push(f64::from(grip.left_force.max(grip.right_force)));
        let sensor = &moment.external.devices.force;
        let axis = |counts: u16| f64::from(i32::from(counts) - FORCE_ZERO) / f64::from(FORCE_COUNTS_PER_LB);
        let force =
            [sensor.x, sensor.y, sensor.z].map(axis).into_iter().fold(0.0, |sum: f64, lb| sum.hypot(lb));
        self.tool_force.push(if sensor.valid { force } else { 0.0 });
        // A re-start ordered by Prim is no fault.
        let restarts = u32::from(!is_restart_ordered(&moment.before));
        let counters = |memory: &CommonMemory| {
            let link = &memory.t3i.status.counters;
            link.naks
                .saturating_add(link.timeouts)
                .saturating_add(link.checksum_errors)
                .saturating_add(link.restarts.saturating_mul(restarts))
        };
        self.link_faults.push(counters(&moment.after).saturating_sub(counters(&moment.before)));
        if let Some(timing) = moment.timing {
            self.controller.push(timing.controller_ns as f64 / 1e3);
            self.overruns = timing.skipped;
        }
    }
}

/// Pictures at the start of commands, at the start of the failure, and after the last tick.
fn pictures(log: &Log, run: &Run) -> Vec<Picture> {
    let Some(urdf) = log.attachment(Attachment::URDF) else { return Vec::new() };
    let commands = &run.chronicle.commands;
    let step = commands.len().div_ceil(PICTURES).max(1);
    let mut wanted: Vec<(u64, String)> =
        commands.iter().step_by(step).map(|command| (command.first_tick, command.text.clone())).collect();
    if let Some(failure) = &run.failure {
        wanted.push((failure.story.tick, "the failure".to_owned()));
    }
    wanted.push((run.ticks.last().copied().unwrap_or_default(), "the end".to_owned()));
    wanted.sort_by_key(|(tick, _)| *tick);
    let mut scene = Scene::new(&String::from_utf8_lossy(&urdf.data));
    let mut places = log.places().peekable();
    let mut pictures = Vec::new();
    for (tick, text) in wanted {
        while let Some((_, moved)) = places.next_if(|(moved, _)| moved.0 <= tick) {
            scene.place(moved);
        }
        let failed = run.failure.as_ref().is_some_and(|failure| failure.story.tick == tick);
        let views = [
            ("near the tool point, from above: +X to the right, +Y up", FROM_ABOVE),
            ("near the tool point, from the operator's side: +X to the right, +Z up", FROM_THE_SIDE),
        ];
        let views = views.into_iter().filter(|_| failed);
        let near = views.filter_map(|(what, eye)| Some((what, scene.near(TOOL, eye)?))).collect();
        pictures.push(Picture { tick, text, svg: scene.draw(), near });
    }
    pictures
}

/// Parses a clearance text, such as "... by 0.157 in at tick 1307, during ...".
fn clearance(text: &str) -> Option<Clearance> {
    let (_, rest) = text.split_once("at tick ")?;
    let digits = rest.split(|c: char| !c.is_ascii_digit()).next()?;
    Some(Clearance { tick: digits.parse().ok()?, text: text.to_owned() })
}

/// Extends the last stretch of a lane, or begins a new one.
fn extend(lane: &mut Vec<Stretch>, tick: u64, text: String, step: &Name16) {
    if lane.last().is_none_or(|last| last.text != text) {
        lane.push(Stretch { from: tick, to: tick, text, steps: Vec::new() });
    }
    let Some(stretch) = lane.last_mut() else { return };
    stretch.to = tick;
    if !step.is_empty() && stretch.steps.last().is_none_or(|(_, last)| last != step.as_str()) {
        stretch.steps.push((tick, step.to_string()));
    }
}

/// Speed in in/s and angular speed in rad/s between two commanded frames; 0 if one is missing.
fn motion(before: &CommonMemory, after: &CommonMemory) -> (f64, f64) {
    let known = |frame: &WireFrame| (*frame != WireFrame::default()).then(|| frame.to_frame().ok()).flatten();
    let (was, is) = (&before.t3i.status, &after.t3i.status);
    if !(was.link_running && is.link_running) {
        return (0.0, 0.0);
    }
    match (known(&was.frame_feedback), known(&is.frame_feedback)) {
        (Some(a), Some(b)) => {
            let distance = a.distance(&b);
            (distance.inches / TICK_S, distance.radians / TICK_S)
        }
        _ => (0.0, 0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lane_has_one_stretch_a_command() {
        let mut lane = Vec::new();
        let ticks = [(1, "", ""), (2, "MOVE", "start"), (3, "MOVE", "moving"), (4, "MOVE", "moving")];
        for (tick, text, step) in ticks.into_iter().chain([(5, "PAUSE", "start")]) {
            extend(&mut lane, tick, text.to_owned(), &Name16::clipped(step));
        }
        let texts: Vec<_> = lane.iter().map(|s| (s.from, s.to, s.text.as_str())).collect();
        assert_eq!(texts, [(1, 1, ""), (2, 4, "MOVE"), (5, 5, "PAUSE")]);
        assert_eq!(lane[1].steps, [(2, "start".to_owned()), (3, "moving".to_owned())]);
    }

    #[test]
    fn the_closest_passage_has_a_tick() {
        let text =
            "right_finger passes UNIT_1_floor by 0.157 in at tick 1307, during GRASP-OBJ of GET-OBJECT";
        assert_eq!(clearance(text), Some(Clearance { tick: 1307, text: text.into() }));
        assert_eq!(clearance("none"), None);
    }

    #[test]
    fn nothing_moves_without_a_link() {
        assert_eq!(motion(&CommonMemory::default(), &CommonMemory::default()), (0.0, 0.0));
    }
}
