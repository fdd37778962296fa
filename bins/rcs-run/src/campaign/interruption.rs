//! The kinds of interruptions, their names on the command line, and the steps that carry them out.

use std::{fmt, path::Path, sync::Arc};

use depc::fault::FaultKind;
use diagnostics::{FAULTS, nearest};
use interfaces::station::Stepped;
use levels::ladder::ProcessId;
use plant::{
    BoxAction, CellDescription, EStop, Key, WorkstationAction,
    fault::{FaultSubject, text::FaultFile},
};
use runtime::{StartError, setup::fault_file};

use super::{
    disturbance::{self, Disturbance},
    outage::{self, Outage},
    script::{FAULT, Script, ScriptStep, away, lead, nudge},
};
use crate::rcs_run::error::Error;

const HOLD: u64 = 75; // duration of a Hold, ticks: 3 s
const HELD: u64 = 50; // ticks for which the box holds a process: 2 s
/// Ticks between the last entry of the journal and the loss of power: the time of a write.
const LATE_ENTRY: u64 = 1;
const OUTAGE: u64 = 50; // ticks without power: 2 s
const RESTART: u64 = 25; // ticks between power and the first action of the operator
const STOPPED: u64 = 100; // ticks between the emergency stop and its release: the time to walk there

#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    None,
    Pause,
    PauseTwice,
    Refused,  // a command with a misspelt location
    Replaced, // another valid command, then the interrupted command again
    AnswerLost,
    AnswerLate,
    AnswerDamaged,
    Hold,
    Nudge,           // the joystick moves the robot by 0.2 in and back
    Away,            // the joystick moves the robot 3 in away and back
    Held(ProcessId), // a switch on the joystick box holds a process, and then releases it
    Restart(ProcessId),
    Lost(ProcessId),               // a process writes nothing from now on
    Power(Loss),                   // the controller loses its power, and everything but its journal
    Cut,                           // the cable to the robot controller is cut
    Estop,                         // emergency stop, and the start-up at the panel
    Fault(String, Arc<FaultFile>), // the faults of a file for [`FAULT`] ticks, with the name of the file
    Disturbed(Disturbance),        // a person moves the robot aside, or changes the parts in the cell
    Outage(Outage),                // the connections of couplers are cut for a time
}

/// What fails in a loss of power, in addition to the controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loss {
    Controller, // the controller alone: the arm stands, the air holds
    Arm,        // the hydraulics of the robot: the arm sinks
    Air,        // the supply of air
}

impl Loss {
    const NAMED: [(&str, Self); 2] = [("arm", Self::Arm), ("air", Self::Air)];

    fn script(self) -> Vec<ScriptStep> {
        let (mut off, mut on) = (vec![ScriptStep::PowerOff], vec![ScriptStep::PowerOn]);
        match self {
            Self::Controller => {}
            Self::Arm => {
                off.push(ScriptStep::key(Key::Press(EStop::ControlPanel)));
                on.push(ScriptStep::key(Key::Release(EStop::ControlPanel)));
            }
            Self::Air => off.push(ScriptStep::AirLost(OUTAGE)),
        }
        let written = [ScriptStep::Journal, ScriptStep::Wait(LATE_ENTRY)];
        let begin = [ScriptStep::Wait(RESTART), ScriptStep::Enter, ScriptStep::StartUp];
        let outage = [ScriptStep::Wait(OUTAGE)];
        written.into_iter().chain(off).chain(outage).chain(on).chain(begin).collect()
    }
}

/// Kinds without a parameter, with their names.
const PLAIN: [(&str, Kind); 14] = [
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
    ("power", Kind::Power(Loss::Controller)),
    ("cut", Kind::Cut),
];
const OF_PROCESS: [&str; 3] = ["held", "restart", "lost"]; // interruptions of a process, `WORD:PROCESS`

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Held(process) => write!(f, "held:{}", word_of(*process)),
            Self::Restart(process) => write!(f, "restart:{}", word_of(*process)),
            Self::Lost(process) => write!(f, "lost:{}", word_of(*process)),
            Self::Fault(name, _) => write!(f, "fault:{name}"),
            Self::Power(loss @ (Loss::Arm | Loss::Air)) => {
                let (name, _) = Loss::NAMED[usize::from(*loss == Loss::Air)];
                write!(f, "power:{name}")
            }
            Self::Disturbed(disturbance) => disturbance.fmt(f),
            Self::Outage(outage) => outage.fmt(f),
            plain => f.write_str(PLAIN.iter().find(|(_, kind)| kind == plain).map_or("", |(name, _)| name)),
        }
    }
}

fn word_of(process: ProcessId) -> &'static str {
    process.field()
}

impl Kind {
    /// `restart` selects one kind per process, `fault` one per fault file that can be used. An error lists all words.
    pub fn named(text: &str, data: &Path, cell: &CellDescription) -> Result<Vec<Self>, Error> {
        let process = |name: &str| ProcessId::ALL.iter().copied().find(|process| word_of(*process) == name);
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
                Some(Stepped::ALL.iter().map(|process| Self::Held(process.process())).collect())
            }
            None if text == "restart" => Some(ProcessId::ALL.iter().copied().map(Self::Restart).collect()),
            None if text == "lost" => Some(ProcessId::ALL.iter().copied().map(Self::Lost).collect()),
            None if text == "fault" => Some(faults(data, cell)?),
            None => PLAIN.iter().find(|(name, _)| *name == text).map(|(_, kind)| vec![kind.clone()]),
            Some(("held", name)) => process(name)
                .filter(|process| Stepped::ALL.iter().any(|one| one.process() == *process))
                .map(|process| vec![Self::Held(process)]),
            Some(("power", name)) => {
                let loss = Loss::NAMED.iter().find(|(known, _)| *known == name);
                loss.map(|(_, loss)| vec![Self::Power(*loss)])
            }
            Some(("restart", name)) => process(name).map(|process| vec![Self::Restart(process)]),
            Some(("lost", name)) => process(name).map(|process| vec![Self::Lost(process)]),
            Some((word, _)) if disturbance::WORDS.contains(&word) => {
                Disturbance::named(text).map(|disturbance| vec![Self::Disturbed(disturbance)])
            }
            Some((outage::WORD, of)) => {
                Outage::named(of).map(|outages| outages.into_iter().map(Self::Outage).collect())
            }
            Some(("fault", name)) => {
                let path = FAULTS.find(Path::new(name), data).map_err(StartError::from)?;
                fault(&path, cell)?.map(|kind| vec![kind])
            }
            Some(_) => None,
        };
        found.ok_or_else(|| {
            let (word, of) = text.split_once(':').unwrap_or((text, ""));
            let near = if OF_PROCESS.contains(&word) {
                nearest(of, ProcessId::ALL.iter().map(|process| word_of(*process)))
            } else {
                nearest(word, first_words().filter(|known| *known != word))
            };
            let help =
                near.map_or_else(|| format!("expected {}", words()), |near| format!("the nearest is {near}"));
            Error::Campaign(format!("no interruption {text}: {help}"))
        })
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
                | Self::Outage(_)
        )
    }

    /// True if the interruption stops the robot, or changes who controls the robot.
    #[must_use]
    pub const fn is_stop(&self) -> bool {
        matches!(self, Self::Pause | Self::Hold | Self::Estop) || self.is_for_good()
    }

    /// True if the interruption never ends.
    #[must_use]
    pub const fn is_for_good(&self) -> bool {
        matches!(self, Self::Cut | Self::Lost(_))
    }

    #[must_use]
    pub const fn disturbance(&self) -> Option<&Disturbance> {
        match self {
            Self::Disturbed(disturbance) => Some(disturbance),
            _ => None,
        }
    }

    #[must_use]
    pub const fn outage(&self) -> Option<&Outage> {
        match self {
            Self::Outage(outage) => Some(outage),
            _ => None,
        }
    }

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
                let bit =
                    Stepped::ALL.iter().find(|one| one.process() == *process).map_or(0, |one| one.bit());
                let hold = |action| ScriptStep::Workstation(WorkstationAction::Joystick(action));
                vec![hold(BoxAction::Hold(bit)), ScriptStep::Wait(HELD), hold(BoxAction::Free(bit))]
            }
            Self::Restart(process) => vec![ScriptStep::Restart(*process)],
            Self::Lost(process) => vec![ScriptStep::Lose(*process)],
            Self::Cut => vec![ScriptStep::Cut],
            Self::Power(loss) => loss.script(),
            Self::Estop => {
                let mut steps = vec![ScriptStep::key(Key::Press(EStop::Pedestal)), ScriptStep::Wait(STOPPED)];
                steps.push(ScriptStep::key(Key::Release(EStop::Pedestal)));
                steps.extend([ScriptStep::StartUp, ScriptStep::Release]);
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
            Self::Disturbed(Disturbance { what: disturbance::DisturbanceKind::Jog(way), .. }) => lead(*way),
            Self::Disturbed(Disturbance { what, .. }) => vec![ScriptStep::Change(what.clone())],
            Self::Outage(outage) => outage.steps(),
        };
        Script::new(steps)
    }
}

pub fn first_words() -> impl Iterator<Item = &'static str> {
    let plain = PLAIN.iter().map(|(name, _)| *name);
    plain.chain(OF_PROCESS).chain(["fault", "all", outage::WORD]).chain(disturbance::WORDS)
}

fn words() -> String {
    let plain = PLAIN.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
    let processes = ProcessId::ALL.iter().map(|process| word_of(*process)).collect::<Vec<_>>().join(", ");
    format!(
        "{plain}, held[:PROCESS], restart[:PROCESS], lost[:PROCESS], power[:arm|:air], fault[:FILE], \
         outage:DEVICE[/DEVICE][:SECONDS], jog:X:Y:Z, take:PART, move:PART:X:Y, swap:PART:KIND, \
         add:KIND:PLACE:SECTOR or all; processes are {processes}"
    )
}

fn faults(data: &Path, cell: &CellDescription) -> Result<Vec<Kind>, Error> {
    FAULTS.all(data).iter().filter_map(|path| fault(path, cell).transpose()).collect()
}

/// The faults of a file; `None` if the file has none that can be limited to a time.
fn fault(path: &Path, cell: &CellDescription) -> Result<Option<Kind>, Error> {
    let (file, _) = fault_file(path, cell)?;
    let lasting =
        |what: &FaultSubject| !what.is_delivery() && !matches!(what, FaultSubject::PedestalMoved { .. });
    let switchable = file.line.is_some() || file.cell.faults.iter().any(|fault| lasting(&fault.what));
    let name = path.file_stem().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    Ok(switchable.then(|| Kind::Fault(name, Arc::new(file))))
}
