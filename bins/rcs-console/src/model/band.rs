//! The state band: the state of the robot in one word, its reason, the operator's next step, and the main facts.

use closed_loop::{account::Kind, failure::Failure};
use interfaces::{
    Fault, ProcessId,
    device::{FieldHealth, GroupHealth, KNOB_FULL},
    emove::Holding,
    hws::HwsReport,
    operator::BOARDS,
    station::BoxFrame,
};
use os_io::units::shown;
use rcs_core::tick::TICK_S;
use record::views::{Controller, JobState};

use super::{Model, Place};
use crate::rcs_console::{
    picture::{Absence, Picture},
    source::{About, Source, State},
    story::process_named,
};

const PAUSE: &str = "PAUSE";
const FINISHED: &str = "finished";
const WAITS: &str = "waits";
const SPEED_TICKS: u64 = 5; // ticks over which the speed of the hand is measured
const AT_REST: f64 = 0.05; // a hand that is slower is at rest, in/s

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Condition {
    Running,
    Paused,  // waiting at rest for a command or a person
    Stopped, // unable to move, because a person or a switch stops the robot
    EStop,
    Fault,
    Finished,
    Ended,
    NoData,
}

impl Condition {
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Running => "RUNNING",
            Self::Paused => "PAUSED",
            Self::Stopped => "STOPPED",
            Self::EStop => "E-STOP",
            Self::Fault => "FAULT",
            Self::Finished => "FINISHED",
            Self::Ended => "ENDED",
            Self::NoData => "NO DATA",
        }
    }

    /// A sign for the word that requires neither colour nor a special font.
    #[must_use]
    pub const fn shape(self) -> &'static str {
        match self {
            Self::Running => ">>",
            Self::Paused => "||",
            Self::Stopped => "[]",
            Self::EStop => "XX",
            Self::Fault => "!!",
            Self::Finished => "==",
            Self::Ended => "--",
            Self::NoData => "??",
        }
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
struct Finding {
    condition: Condition,
    why: String,
    next: String,
}

impl Finding {
    fn new(condition: Condition, why: impl Into<String>, next: impl Into<String>) -> Self {
        Self { condition, why: why.into(), next: next.into() }
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Band {
    pub condition: Condition,
    pub why: String,  // the reason, or the command in progress
    pub next: String, // the operator's next step; empty if none is needed
    /// Job, hand, knob, tick, time, speed of the hand, name, and who commands; the most important comes first.
    pub facts: Vec<String>,
    pub role: &'static str, // `OPERATOR`, `VIEWER`, `ENDED` or `RECORDED`
    pub is_recorded: bool,  // true for a log, whose state is not the present state of a robot
}

struct Scene<'a> {
    model: &'a Model,
    source: &'a dyn Source,
    about: &'a About<'a>,
    picture: &'a Picture,
    job: Option<JobState>,
    commander: Option<String>,
    controller: Option<Controller>,
    failure: Option<Failure>, // what went wrong up to this tick, unless work has continued since
}

/// The checks in the order of their importance. The first that applies gives the state.
const CHECKS: [fn(&Scene<'_>) -> Option<Finding>; 7] =
    [no_data, finished, emergency, failed, ended, stopped, paused];

#[must_use]
pub fn band(model: &Model, source: &dyn Source) -> Band {
    let about = source.about();
    let is_recorded = about.state == State::Log;
    let latest = if model.is_frozen(source) {
        source.range().and_then(|(_, last)| source.picture(last))
    } else {
        None
    };
    let role = match about.state {
        State::Log => "RECORDED",
        State::Over => "ENDED",
        _ if model.operates() => "OPERATOR",
        _ => "VIEWER",
    };
    let Some(picture) = latest.as_ref().or(model.picture.as_ref()) else {
        let why = "the run has published no tick yet".to_owned();
        let (next, facts) = (String::new(), vec![about.name.to_owned()]);
        return Band { condition: Condition::NoData, why, next, facts, role, is_recorded };
    };
    let tick = picture.tick.0;
    let (cell, failure) = (source.cell(tick), source.story().failure(tick));
    let (job, commander, controller) = (cell.job(), cell.commander(), cell.controller());
    let scene = Scene { model, source, about: &about, picture, job, commander, controller, failure };
    let Finding { condition, why, next } =
        CHECKS.iter().find_map(|check| check(&scene)).unwrap_or_else(|| running(&scene));
    let next = match role {
        // A log has no next step, except for failures.
        "RECORDED" if matches!(condition, Condition::Stopped | Condition::Paused) => String::new(),
        "VIEWER" if !next.is_empty() && condition != Condition::NoData => {
            format!("{next} (with --operate)")
        }
        _ => next,
    };
    let in_units = |text: String| shown(&text).into_owned();
    Band { condition, why: in_units(why), next: in_units(next), facts: scene.facts(), role, is_recorded }
}

fn no_data(scene: &Scene<'_>) -> Option<Finding> {
    let (why, next) = match scene.about.state {
        State::Silent(seconds) => (
            format!("no new tick for {seconds} s: the robot may still move"),
            "look at the robot, then at the program of the run",
        ),
        State::Torn => ("TORN: the buffers are not of one tick".to_owned(), "the console reads them again"),
        State::Log | State::Runs | State::Over => return None,
    };
    Some(Finding::new(Condition::NoData, why, next))
}

fn finished(scene: &Scene<'_>) -> Option<Finding> {
    let is_last = scene.source.range().is_some_and(|(_, last)| scene.picture.tick.0 == last);
    let is_finished = is_last && scene.about.result == Some(FINISHED);
    is_finished.then(|| Finding::new(Condition::Finished, "the job is finished", ""))
}

fn emergency(scene: &Scene<'_>) -> Option<Finding> {
    const NEXT: &str = "7, procedure III.6: release the button, then start the robot again";
    let failure = scene.failure.as_ref().filter(|failure| failure.kind == Kind::EmergencyStop);
    let next = match failure {
        _ if scene.is_live() => NEXT.to_owned(),
        Some(failure) => scene.next_in_log(failure),
        None => String::new(),
    };
    if let Some(site) = scene.controller.as_ref().and_then(|controller| controller.pressed.first()) {
        return Some(Finding::new(Condition::EStop, format!("the E-stop {site} is pressed"), next));
    }
    let failure = failure.filter(|_| scene.lacks_pressure())?;
    Some(Finding::new(Condition::EStop, failure.text.clone(), next))
}

fn failed(scene: &Scene<'_>) -> Option<Finding> {
    let failure = scene.failure.as_ref()?;
    let task = &scene.picture.memory.task.status;
    let is_reported = task.report == HwsReport::Error || scene.source.story().is_ended_by(failure);
    let is_present = match failure.kind {
        Kind::EmergencyStop | Kind::Power => scene.lacks_pressure(),
        Kind::RobotController | Kind::Link => is_reported || !scene.picture.memory.t3i.status.link_running,
        Kind::Process | Kind::OffPath | Kind::Job => is_reported,
        Kind::Collision | Kind::Lost | Kind::Device | Kind::FalseReport | Kind::Misplaced | Kind::Program => {
            true
        }
    };
    is_present.then(|| {
        let next = if scene.is_live() { scene.next_in_run(failure) } else { scene.next_in_log(failure) };
        Finding::new(Condition::Fault, failure.text.clone(), next)
    })
}

fn ended(scene: &Scene<'_>) -> Option<Finding> {
    let is_last = scene.source.range().is_some_and(|(_, last)| scene.picture.tick.0 == last);
    match (scene.about.state, scene.about.result) {
        (State::Over, _) => {
            let why = format!("last command: {}", scene.command());
            Some(Finding::new(Condition::Ended, why, "o opens its log, which has the result"))
        }
        (State::Log, Some(result)) if is_last => Some(Finding::new(Condition::Ended, result, "")),
        (State::Log, None) if is_last => {
            Some(Finding::new(Condition::Ended, "the log has no end: its program was killed", ""))
        }
        _ => None,
    }
}

fn stopped(scene: &Scene<'_>) -> Option<Finding> {
    let external = &scene.picture.external;
    let stopped = |why: String, next: String| Some(Finding::new(Condition::Stopped, why, next));
    if let Some(board) = BOARDS.iter().find(|board| external.operator.is_stopped(**board)) {
        let (what, word) = match board {
            0 => ("the pulse is stopped".to_owned(), "SSGO"),
            board => (format!("board {board} is stopped"), "GO"),
        };
        return stopped(what, format!("5, Tab to board {board}, `{word}` starts it"));
    }
    if scene.picture.absence(ProcessId::Prim) == Some(Absence::Held) && !scene.is_recording() {
        return stopped("Prim is held at the joystick box".to_owned(), "h releases it".to_owned());
    }
    if let Some(devices) = late_devices(&external.devices.field) {
        let next = match external.devices.field.any {
            GroupHealth::Tripped => "5: `io go DEVICE`, then `job go`",
            _ => "the robot waits for the device: 3, then v shows it",
        };
        return stopped(devices, next.to_owned());
    }
    if external.devices.joystick.velocity == 0 {
        return stopped("the velocity knob is at 0".to_owned(), "Space turns it back".to_owned());
    }
    let controller = scene.controller.as_ref()?;
    match controller.cut.as_str() {
        "" if controller.lamps.hold => {
            stopped("HOLD is on at the robot controller".to_owned(), "6: `panel hold off`".to_owned())
        }
        "" => None,
        cut => stopped(format!("no pressure: {cut}"), "7: the procedures start the robot".to_owned()),
    }
}

/// The devices behind field I/O without fresh values, as text; `None` if all values are fresh.
#[must_use]
pub fn late_devices(field: &FieldHealth) -> Option<String> {
    if field.any == GroupHealth::Fresh {
        return None;
    }
    let word = |health: GroupHealth| health.to_string().to_uppercase();
    let groups: Vec<String> =
        field.late().map(|(group, health)| format!("{group} {}", word(health))).collect();
    let groups = if groups.is_empty() { format!("a device {}", word(field.any)) } else { groups.join(", ") };
    Some(format!("field I/O: {groups}"))
}

fn paused(scene: &Scene<'_>) -> Option<Finding> {
    let paused = |why: String, next: &str| Some(Finding::new(Condition::Paused, why, next));
    let external = &scene.picture.external;
    if scene.is_recording() {
        let why = "a pose is recorded: E-move and Prim are suspended until carriage return";
        return paused(why.to_owned(), "6: M is the carriage return");
    }
    if external.devices.joystick.frame != 0 {
        let frame = BoxFrame::from_bits(external.devices.joystick.frame).map_or("several", BoxFrame::text);
        return paused(format!("the joystick box is on, frame {frame}"), "6: x switches it off");
    }
    let before = scene.failure.as_ref().map_or_else(String::new, |failure| format!("; {}", failure.text));
    let waiting = scene.job.as_ref().filter(|job| job.phase == WAITS);
    if scene.model.job_waits() || waiting.is_some() {
        let reason = waiting.map(|job| &job.reason).filter(|reason| before.is_empty() && !reason.is_empty());
        let before = reason.map_or(before, |reason| format!(": {reason}"));
        return paused(format!("the job waits{before}"), "`:job go` continues the job");
    }
    match (external.hws.number, external.hws.command.as_str()) {
        (0, _) => paused("no command yet".to_owned(), ""),
        (_, PAUSE) => paused(format!("{PAUSE} {}{before}", scene.picture.memory.task.status.report), ""),
        _ => None,
    }
}

fn running(scene: &Scene<'_>) -> Finding {
    Finding::new(Condition::Running, scene.command(), "")
}

impl Scene<'_> {
    fn is_live(&self) -> bool {
        matches!(self.about.state, State::Runs)
    }

    fn is_recording(&self) -> bool {
        self.picture.memory.prim.status.recording
    }

    fn command(&self) -> String {
        self.picture.external.hws.in_words().to_string()
    }

    /// True if the robot has no pressure, or if no data show it.
    fn lacks_pressure(&self) -> bool {
        match &self.controller {
            Some(controller) => !controller.cut.is_empty(),
            None => true,
        }
    }

    /// The action that the operator must take before the same command can succeed, if known.
    fn to_do(&self, failure: &Failure) -> Option<&'static str> {
        failure.kind.remedy().or_else(|| {
            let process = process_named(&failure.process)?;
            let picture = self.source.picture(self.source.story().shown_at(failure))?;
            match picture.fault(process)? {
                Fault::Reason(reason) => reason.remedy(),
                Fault::Link(_) => None,
            }
        })
    }

    fn next_in_run(&self, failure: &Failure) -> String {
        match failure.kind {
            Kind::Power => return "7, procedure III.6: start the robot again".to_owned(),
            Kind::RobotController => return "7: the procedures recover the robot".to_owned(),
            _ => {}
        }
        let first = self.to_do(failure).map_or_else(String::new, |first| format!("{first}; "));
        format!("{first}`:job go` sends PAUSE and the command again")
    }

    fn next_in_log(&self, failure: &Failure) -> String {
        let remedy = self.to_do(failure).map_or_else(String::new, |remedy| format!("; to do: {remedy}"));
        let shown = self.source.story().shown_at(failure);
        let look = match (self.about.state, self.picture.tick.0 == shown) {
            (State::Over, _) => "o opens its log at the first cause".to_owned(),
            (_, false) => format!("c goes to the first cause, tick {shown}"),
            (_, true) if failure.table.is_some() => "c, then 2 shows the row that decided".to_owned(),
            (_, true) => "4, v shows the cell; n the next change".to_owned(),
        };
        format!("{look}{remedy}")
    }

    fn facts(&self) -> Vec<String> {
        let external = &self.picture.external;
        let mut facts = Vec::new();
        match &self.job {
            Some(job) if job.lines > 0 => facts.push(format!("line {} of {}", job.index, job.lines)),
            _ => facts.push(format!("command {}", external.hws.number)),
        }
        facts.push(match self.picture.memory.subtask.status.held {
            Holding::Nothing => "holds nothing".to_owned(),
            Holding::Something => "holds something".to_owned(),
            Holding::NotKnown => "holding not known".to_owned(),
            Holding::Object(grip) => format!("holds {}", grip.object),
        });
        facts.push(format!(
            "speed {} %",
            u32::from(external.devices.joystick.velocity) * 100 / u32::from(KNOB_FULL)
        ));
        let tick = self.picture.tick.0;
        facts.push(match (self.about.state, self.model.place, self.source.range()) {
            (State::Log, _, Some((_, last))) => format!("tick {tick} of {last}"),
            (State::Log, ..) | (_, Place::Last, _) => format!("tick {tick}"),
            (_, Place::At(_), _) => format!("tick {tick}, SHOWN {}", self.model.tick()),
        });
        facts.push(format!("{:.2} s", tick as f64 * TICK_S));
        if let Some(speed) = self.hand_speed() {
            facts.push(match speed {
                speed if speed < AT_REST => "hand at rest".to_owned(),
                speed => shown(&format!("hand {speed:.1} in/s")).into_owned(),
            });
        }
        facts.push(self.about.name.to_owned());
        let asked = || self.model.operating.as_ref().and_then(|operating| operating.commander());
        let who = self.commander.clone().or_else(|| asked().map(str::to_owned));
        facts.extend(who.map(|who| format!("{who} commands")));
        facts
    }

    /// Speed of the tool point by the resolvers, in/s; `None` if unknown.
    fn hand_speed(&self) -> Option<f64> {
        let before = self.source.picture(self.picture.tick.0.checked_sub(SPEED_TICKS)?)?;
        let seconds =
            self.picture.tick.0.checked_sub(before.tick.0).filter(|ticks| *ticks > 0)? as f64 * TICK_S;
        let place = |picture: &Picture| picture.memory.t3i.status.resolver_frame.map(|frame| frame.tool);
        let (now, was) = (place(self.picture)?, place(&before)?);
        let square = now.iter().zip(was).map(|(now, was)| f64::from(now - was).powi(2)).sum::<f64>();
        Some(square.sqrt() / 100.0 / seconds)
    }
}
