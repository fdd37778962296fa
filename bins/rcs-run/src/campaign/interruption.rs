//! The kinds of interruptions, their names on the command line, and the steps that carry them out.

use std::{fmt, path::Path, sync::Arc};

use depc::fault::{ALWAYS, FaultKind, Plan, Rule};
use interfaces::device::{KNOB_FULL, joystick_frame, single_step};
use levels::ladder::ProcessId;
use plant::{
    BoxAction, BoxButton, CellDescription, EStop, Key, WorkstationAction,
    fault::{FaultPlan, What, When, text::FaultFile},
    t3::Stage,
};
use rcs_core::tick::Tick;
use runtime::{StartError, setup::fault_file};

use super::branch::Branch;
use crate::error::Error;

/// Duration of a Hold, ticks: 3 s.
const HOLD: u64 = 75;
/// Ticks for which the box holds a process.
const HELD: u64 = 50;
/// Ticks for which a fault is on.
pub const FAULT: u64 = 20;
/// Ticks between the emergency stop and its release: the time to walk there.
const STOPPED: u64 = 100;
/// Height by which the robot is moved away, in.
const RISE: f64 = 3.0;
/// Distance that a robot continues when the button is released on the way back, in.
const GOES_ON: f64 = 0.8;
/// Longest time for which a button of the joystick box is held down, ticks.
const LED: u64 = 100;
/// Ticks for which a refused key of the panel is tried again.
const PATIENCE: u64 = 2000;
/// Ticks from CYCLE START to the DEPC function: the program makes two short motions.
const REHEARSAL: u64 = 75;
/// Least probability of a random fault, millionths per tick or byte, so that it occurs within [`FAULT`] ticks.
const CHANCE: u32 = 50_000;

/// A kind of interruption.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// None: the branch continues as its parent.
    None,
    /// PAUSE.
    Pause,
    /// PAUSE, and a second PAUSE during the recovery.
    PauseTwice,
    /// A command with a misspelt location.
    Refused,
    /// Another valid command, then the interrupted command again.
    Replaced,
    /// One answer of the robot controller is lost.
    AnswerLost,
    /// One answer of the robot controller is late.
    AnswerLate,
    /// One answer of the robot controller is damaged.
    AnswerDamaged,
    /// Hold of the robot controller for 3 s.
    Hold,
    /// The joystick moves the robot by 0.2 in and back.
    Nudge,
    /// The joystick moves the robot 3 in away and back.
    Away,
    /// A switch on the joystick box holds a process, and releases it again.
    Held(ProcessId),
    /// A process is restarted.
    Restart(ProcessId),
    /// A process writes nothing from now on.
    Lost(ProcessId),
    /// The cable to the robot controller is cut.
    Cut,
    /// Emergency stop, and the start-up at the panel.
    Estop,
    /// The faults of a file for [`FAULT`] ticks, with the name of the file.
    Fault(String, Arc<FaultFile>),
}

/// Kinds without a parameter, with their names.
const PLAIN: [(&str, Kind); 13] = [
    ("none", Kind::None),
    ("pause", Kind::Pause),
    ("pause-twice", Kind::PauseTwice),
    ("refused", Kind::Refused),
    ("replaced", Kind::Replaced),
    ("answer-lost", Kind::AnswerLost),
    ("answer-late", Kind::AnswerLate),
    ("answer-damaged", Kind::AnswerDamaged),
    ("hold", Kind::Hold),
    ("nudge", Kind::Nudge),
    ("away", Kind::Away),
    ("estop", Kind::Estop),
    ("cut", Kind::Cut),
];
/// Processes with a switch on the joystick box.
const SWITCHES: [(ProcessId, u8); 4] = [
    (ProcessId::Task, single_step::TASK),
    (ProcessId::Subtask, single_step::SUBTASK),
    (ProcessId::Emove, single_step::EMOVE),
    (ProcessId::Prim, single_step::PRIM),
];

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Held(process) => write!(f, "held:{}", word(*process)),
            Self::Restart(process) => write!(f, "restart:{}", word(*process)),
            Self::Lost(process) => write!(f, "lost:{}", word(*process)),
            Self::Fault(name, _) => write!(f, "fault:{name}"),
            plain => f.write_str(PLAIN.iter().find(|(_, kind)| kind == plain).map_or("", |(name, _)| name)),
        }
    }
}

/// Name of a process on the command line.
fn word(process: ProcessId) -> &'static str {
    process.field()
}

impl Kind {
    /// The kinds that a word of the command line selects: `restart` selects one per process, `fault` one per file that
    /// can be switched on.
    ///
    /// # Errors
    /// [`Error::Campaign`] for an unknown word; it lists all words.
    pub fn named(text: &str, data: &Path, cell: &CellDescription) -> Result<Vec<Self>, Error> {
        let process = |name: &str| ProcessId::ALL.iter().copied().find(|process| word(*process) == name);
        let found = match text.split_once(':') {
            None if text == "all" => {
                let plain = PLAIN[1..].iter().map(|(_, kind)| kind);
                let mut all: Vec<Self> = plain.filter(|kind| !kind.is_for_good()).cloned().collect();
                for word in ["held", "restart", "fault"] {
                    all.extend(Self::named(word, data, cell)?);
                }
                Some(all)
            }
            None if text == "held" => {
                Some(SWITCHES.iter().map(|(process, _)| Self::Held(*process)).collect())
            }
            None if text == "restart" => Some(ProcessId::ALL.iter().copied().map(Self::Restart).collect()),
            None if text == "lost" => Some(ProcessId::ALL.iter().copied().map(Self::Lost).collect()),
            None if text == "fault" => Some(faults(data, cell)?),
            None => PLAIN.iter().find(|(name, _)| *name == text).map(|(_, kind)| vec![kind.clone()]),
            Some(("held", name)) => process(name)
                .filter(|process| SWITCHES.iter().any(|(one, _)| one == process))
                .map(|process| vec![Self::Held(process)]),
            Some(("restart", name)) => process(name).map(|process| vec![Self::Restart(process)]),
            Some(("lost", name)) => process(name).map(|process| vec![Self::Lost(process)]),
            Some(("fault", name)) => {
                fault(&data.join("faults").join(name).with_added_extension("toml"), cell)?
                    .map(|kind| vec![kind])
            }
            Some(_) => None,
        };
        found.ok_or_else(|| Error::Campaign(format!("no interruption {text}: expected {}", words())))
    }

    /// True if the interrupted command continues by itself unless it fails.
    #[must_use]
    pub const fn leaves_command(&self) -> bool {
        matches!(
            self,
            Self::None
                | Self::AnswerLost
                | Self::AnswerLate
                | Self::AnswerDamaged
                | Self::Hold
                | Self::Held(_)
                | Self::Restart(_)
                | Self::Lost(_)
                | Self::Cut
                | Self::Fault(..)
        )
    }

    /// True if it stops the robot, or changes who controls the robot.
    #[must_use]
    pub const fn is_stop(&self) -> bool {
        matches!(self, Self::Pause | Self::Hold | Self::Estop) || self.is_for_good()
    }

    /// True if nothing ends the interruption.
    #[must_use]
    pub const fn is_for_good(&self) -> bool {
        matches!(self, Self::Cut | Self::Lost(_))
    }

    /// The steps of the interruption.
    #[must_use]
    pub fn script(&self) -> Script {
        let steps = match self {
            Self::None | Self::Pause | Self::PauseTwice | Self::Refused | Self::Replaced => Vec::new(),
            Self::AnswerLost => vec![ScriptStep::Answer(FaultKind::Drop)],
            Self::AnswerLate => vec![ScriptStep::Answer(FaultKind::Delay)],
            Self::AnswerDamaged => vec![ScriptStep::Answer(FaultKind::Flip)],
            Self::Hold => vec![
                ScriptStep::key(Key::Hold(true)),
                ScriptStep::Wait(HOLD),
                ScriptStep::key(Key::Hold(false)),
            ],
            Self::Nudge => nudge(),
            Self::Away => away(),
            Self::Held(process) => {
                let bit = SWITCHES.iter().find(|(one, _)| one == process).map_or(0, |(_, bit)| *bit);
                let hold = |action| ScriptStep::Workstation(WorkstationAction::Joystick(action));
                vec![hold(BoxAction::Hold(bit)), ScriptStep::Wait(HELD), hold(BoxAction::Free(bit))]
            }
            Self::Restart(process) => vec![ScriptStep::Restart(*process)],
            Self::Lost(process) => vec![ScriptStep::Lose(*process)],
            Self::Cut => vec![ScriptStep::Cut],
            Self::Estop => {
                let mut steps = vec![ScriptStep::key(Key::Press(EStop::Pedestal)), ScriptStep::Wait(STOPPED)];
                steps.push(ScriptStep::key(Key::Release(EStop::Pedestal)));
                steps.push(ScriptStep::StartUp);
                steps
            }
            Self::Fault(_, file) => {
                vec![
                    ScriptStep::Faults(Arc::clone(file)),
                    ScriptStep::Wait(FAULT),
                    ScriptStep::Enter,
                    ScriptStep::StartUp,
                ]
            }
        };
        Script { steps, at: 0, until: None, height: 0.0 }
    }
}

/// An action on a control of the joystick box.
const fn at_box(action: BoxAction) -> ScriptStep {
    ScriptStep::Workstation(WorkstationAction::Joystick(action))
}

/// The actions at the box between the two throws of the frame switch.
fn joystick(knob: u16, steps: impl IntoIterator<Item = ScriptStep>) -> Vec<ScriptStep> {
    // A robot in motion ramps down first.
    let mut all = vec![
        at_box(BoxAction::Velocity(knob)),
        at_box(BoxAction::Frame(joystick_frame::WORLD)),
        ScriptStep::Wait(25),
    ];
    all.extend(steps);
    all.extend([at_box(BoxAction::Frame(0)), at_box(BoxAction::Velocity(KNOB_FULL)), ScriptStep::Wait(5)]);
    all
}

/// Deflect the stick along X for some ticks, and back.
fn nudge() -> Vec<ScriptStep> {
    const TICKS: u32 = 11;
    let stick = |x: i16| {
        [at_box(BoxAction::Stick { x, y: 0, ticks: TICKS }), ScriptStep::Wait(u64::from(TICKS) + 10)]
    };
    joystick(100, [1000, -1000].into_iter().flat_map(stick))
}

/// Stop the robot with the box, move it up, and move it back by eye to the height at which it stopped.
fn away() -> Vec<ScriptStep> {
    let stop = [at_box(BoxAction::Press(BoxButton::Up, 2)), ScriptStep::Wait(25)];
    let lead = [ScriptStep::Rise, ScriptStep::Wait(15), ScriptStep::Sink, ScriptStep::Wait(15)];
    joystick(500, stop.into_iter().chain(lead))
}

/// All words of the command line, for messages.
fn words() -> String {
    let plain = PLAIN.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
    let processes = ProcessId::ALL.iter().map(|process| word(*process)).collect::<Vec<_>>().join(", ");
    format!(
        "{plain}, held[:PROCESS], restart[:PROCESS], lost[:PROCESS], fault[:FILE] or all; processes are {processes}"
    )
}

/// All fault files that can be switched on.
fn faults(data: &Path, cell: &CellDescription) -> Result<Vec<Kind>, Error> {
    let directory = data.join("faults");
    let unreadable = |source| StartError::Read { path: directory.clone(), source };
    let mut paths = os_io::files::list(&directory).map_err(unreadable)?;
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    paths.iter().filter_map(|path| fault(path, cell).transpose()).collect()
}

/// The faults of a file; `None` if the file has none that can be limited to a time.
fn fault(path: &Path, cell: &CellDescription) -> Result<Option<Kind>, Error> {
    let (file, _) = fault_file(path, cell)?;
    let lasting = |what: &What| !what.is_delivery() && !matches!(what, What::PedestalMoved { .. });
    let switchable = file.line.is_some() || file.cell.faults.iter().any(|fault| lasting(&fault.what));
    let name = path.file_stem().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    Ok(switchable.then(|| Kind::Fault(name, Arc::new(file))))
}

/// The faults of the cell in a window, with random faults frequent enough to occur in it.
fn cell_faults(plan: &FaultPlan, from: u64) -> FaultPlan {
    let mut plan = plan.clone();
    plan.faults.retain(|fault| !fault.what.is_delivery());
    for fault in &mut plan.faults {
        let rate = fault.when.rate.map(|rate| rate.max(f64::from(CHANCE) / f64::from(ALWAYS)));
        fault.when = When { from, until: from + FAULT, rate, ..fault.when };
    }
    plan
}

/// The faults of the line in a window.
fn line_faults(plan: &Plan, from: u64) -> Plan {
    let mut windowed = Plan::new(plan.seed());
    for rule in plan.rules() {
        let single = rule.rate == 0 && rule.until == rule.from + 1;
        let rule: Rule = match single {
            true => rule.at(from),
            false if rule.rate == 0 => rule.window(from, from + FAULT),
            false => rule.window(from, from + FAULT).rate(rule.rate.max(CHANCE)),
        };
        // Rules that do not fit together in this window, only in their own ones, are left out.
        let _ = windowed.add(rule);
    }
    windowed
}

/// An action between two ticks.
#[derive(Clone, Debug)]
enum ScriptStep {
    Workstation(WorkstationAction),
    Wait(u64),
    Restart(ProcessId),
    Lose(ProcessId),
    Cut,
    Answer(FaultKind),
    Faults(Arc<FaultFile>),
    /// ENTER, if the robot controller shows a warning.
    Enter,
    /// The start-up at the panel, if the robot controller has lost its pressure.
    StartUp,
    /// A key of the panel, as soon as the controller accepts it.
    Key(Key),
    /// Button D of the joystick box, until the robot is [`RISE`] higher or stops rising.
    Rise,
    /// Button E, until the robot is almost back at the height at which it rose.
    Sink,
}

impl ScriptStep {
    const fn key(key: Key) -> Self {
        Self::Workstation(WorkstationAction::T3(key))
    }
}

/// The start-up of IV.3.3 after an emergency stop.
const START_UP: [Key; 6] =
    [Key::FaultReset, Key::Hydraulics(true), Key::Manual(true), Key::Align(None), Key::Auto, Key::CycleStart];

/// The steps of an interruption, tick by tick.
pub struct Script {
    steps: Vec<ScriptStep>,
    at: usize,
    until: Option<Tick>,
    /// Height of the tool before it was moved away, in.
    height: f64,
}

impl Script {
    /// True if no step is left.
    #[must_use]
    pub const fn is_over(&self) -> bool {
        self.at >= self.steps.len()
    }

    /// Carry out the steps that come before the next tick. Returns the message of the cell if it refuses one.
    pub fn step(&mut self, branch: &mut Branch<'_>) -> Option<String> {
        let mut refused = None;
        while let Some(step) = self.steps.get(self.at).cloned() {
            match step {
                ScriptStep::Wait(ticks) => {
                    let now = branch.at();
                    let until = *self.until.get_or_insert(Tick(now.0 + ticks));
                    if now < until {
                        return refused;
                    }
                    self.until = None;
                }
                ScriptStep::Key(key) => {
                    let now = branch.at();
                    let until = *self.until.get_or_insert(Tick(now.0 + PATIENCE));
                    let busy = branch.workstation.cell.t3().busy();
                    if now < until && (busy || branch.workstation.cell.press(key).is_err()) {
                        return refused;
                    }
                    self.until = None;
                }
                ScriptStep::Rise | ScriptStep::Sink => {
                    let (now, height) = (branch.at(), branch.workstation.cell.tool().position.z);
                    if self.until.is_none() && matches!(step, ScriptStep::Rise) {
                        self.height = height;
                    }
                    let until = *self.until.get_or_insert(Tick(now.0 + LED));
                    let (button, there) = match step {
                        ScriptStep::Rise => (BoxButton::Up, height >= self.height + RISE),
                        _ => (BoxButton::Down, height <= self.height + GOES_ON),
                    };
                    if now < until && !there {
                        let press = WorkstationAction::Joystick(BoxAction::Press(button, 1));
                        return branch
                            .workstation
                            .cell
                            .workstation(&press)
                            .err()
                            .map(|error| error.to_string());
                    }
                    self.until = None;
                }
                ScriptStep::Workstation(action) => {
                    refused =
                        branch.workstation.cell.workstation(&action).err().map(|error| error.to_string());
                }
                ScriptStep::Restart(process) => branch.restart(process),
                ScriptStep::Lose(process) => branch.lose(process),
                ScriptStep::Cut => branch.cut(),
                ScriptStep::Answer(kind) => branch.spoil_answer(kind),
                ScriptStep::Faults(file) => {
                    let from = branch.at().0 + 1;
                    let seed = branch.facility().seed;
                    branch.workstation.cell.add_faults(&cell_faults(&file.cell, from), seed);
                    if let Some(plan) = &file.line {
                        branch.spoil_line(&line_faults(plan, from));
                    }
                }
                ScriptStep::Enter => {
                    // Only a warning accepts the key.
                    let _ = branch.workstation.cell.press(Key::Enter);
                }
                ScriptStep::StartUp => self.start_up(branch),
            }
            self.at += 1;
        }
        refused
    }

    fn start_up(&mut self, branch: &Branch<'_>) {
        if branch.workstation.cell.t3().stage() == Stage::Depc {
            return;
        }
        for key in START_UP {
            self.steps.extend([ScriptStep::Key(key), ScriptStep::Wait(1)]);
        }
        self.steps.push(ScriptStep::Wait(REHEARSAL));
    }
}
