//! The judge of confirmations: checks that a command reported as finished has its effect in the simulated cell.
//!
//! Task, Subtask, E-move and Prim report each command as finished. The command and the task data alone determine the
//! required state: its [`Claim`]s, which the judge collects when the command appears. It compares them with the bodies
//! of the cell when the status becomes *finished*, without regard to sensors, statuses or estimates.
//!
//! ```text
//!   command of a level ──► its claims                          when its number appears
//!   status becomes finished ──► claims ──compare──► the cell   true, false, or not sensed
//! ```
//!
//! An untrue claim is *not sensed* only for the reasons of [`NotSensed`]. Every other one is *false*, and the run has
//! failed. The judge never rejects an error: `rcs-run campaign --truth` shows that its remedy leads to a finished job.

mod claim;
mod contradiction;
mod emove;
mod history;
mod parts;
pub mod placement;
mod prim;
mod robot;
mod seen;
mod subtask;
mod task;
#[cfg(test)]
mod tests;
pub mod tolerance;

use std::fmt;

use crate::{account::Kind, failure::Failure};
use interfaces::{CommonMemory, HwsCommand, StatusReport, Unconfirmed, hws::HwsReport, prim::PrimReport};
use plant::Cell;
use rcs_core::tick::Tick;
use serde::{Deserialize, Serialize};
use taskdata::files::TaskData;

use self::history::History;
pub use self::{claim::Claim, contradiction::Contradiction};

#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub enum Level {
    Task,
    Subtask,
    #[serde(rename = "E-move")]
    Emove,
    Prim,
}

impl Level {
    /// Ticks from the resolvers to the process: the hops of the ladder, and one for the line.
    const fn hops(self) -> u64 {
        match self {
            Self::Prim => 2,
            Self::Emove => 3,
            Self::Subtask => 4,
            Self::Task => 5,
        }
    }

    pub const ALL: [Self; 4] = [Self::Task, Self::Subtask, Self::Emove, Self::Prim];
}

impl fmt::Display for Level {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Task => "Task",
            Self::Subtask => "Subtask",
            Self::Emove => "E-move",
            Self::Prim => "Prim",
        })
    }
}

/// Why no sensor can contradict an untrue confirmation. The list is closed: a new entry must say why the machine of the
/// manual has no sensor for it.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum NotSensed {
    /// Another part of the same width is between the fingers, and no picture distinguishes it. The fingers measure one
    /// width; the camera recognises an outline.
    EqualPart,
    /// An operator changed the part after the last look: the picture of a part to fetch, or the opening for a part to
    /// put down. Or the arm failed too recently for the process to have read it.
    ChangedAfterLook,
    /// An operator moved the part at a nest, the vise or the drum. The fingers centre it and measure its width, but
    /// nothing measures its position along the fingers.
    NoPicture,
    /// An operator put a part at the destination of another one, or in its way, and no picture is taken of that place.
    Occupied,
    /// The status names this part of the goal as unconfirmed, because the machine has no sensor for it.
    Unconfirmed,
}

impl NotSensed {
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::EqualPart => "a part of equal size and picture",
            Self::ChangedAfterLook => "changed after the last look",
            Self::NoPicture => "moved where no picture is taken",
            Self::Occupied => "its place was occupied by a person",
            Self::Unconfirmed => "reported as unconfirmed",
        }
    }
}

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    True,
    /// An untrue claim that no sensor could show.
    NotSensed(NotSensed),
    False,
}

/// The field names are those of the JSON object.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Confirmation {
    /// Tick in which the status became *finished*.
    pub tick: u64,
    pub level: Level,
    pub command: String,
    pub verdict: Verdict,
    /// The actual state as a sentence; empty if the confirmation is true.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub truth: String,
}

impl Confirmation {
    #[must_use]
    pub const fn is_false(&self) -> bool {
        matches!(self.verdict, Verdict::False)
    }
}

impl fmt::Display for Confirmation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { level, command, verdict, truth, .. } = self;
        match verdict {
            Verdict::True => write!(f, "{level} reports {command} as finished, which is true"),
            Verdict::False => write!(f, "{level} reports {command} as finished, but {truth}"),
            Verdict::NotSensed(why) => {
                write!(f, "{level} reports {command} as finished, but {truth} (not sensed: {})", why.text())
            }
        }
    }
}

#[derive(Clone, Copy)]
pub struct Scene<'a> {
    pub tick: Tick,
    pub hws: &'a HwsCommand,
    pub memory: &'a CommonMemory,
    pub data: &'a TaskData<'a>,
    pub cell: &'a Cell,
}

#[derive(Clone, Debug, Default)]
struct Order {
    number: u32,
    text: String,
    claims: Vec<Claim>,
}

#[derive(Clone, Debug, Default)]
struct Watched {
    /// The present command and its predecessor: a status in the tick of a new command belongs to the old one.
    orders: [Order; 2],
    finished: Option<u32>, // number of the command that is reported as finished, if any
}

/// The field names are those of the JSON object.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct TruthResult {
    pub judged: u64,
    #[serde(rename = "false")]
    pub lies: Vec<Confirmation>,
    /// Untrue confirmations that no sensor could contradict.
    pub not_sensed: Vec<Confirmation>,
}

#[derive(Clone, Debug, Default)]
pub struct TruthCheck {
    levels: [Watched; 4],
    history: History,
    result: TruthResult,
}

impl TruthCheck {
    /// Note that an operator added, moved or removed these parts before the next tick.
    pub fn note_changed(&mut self, tick: Tick, parts: impl IntoIterator<Item = u32>) {
        self.history.note_changed(tick, parts);
    }

    /// Note that the workstation has delivered these parts in this tick.
    pub fn note_delivered(&mut self, tick: Tick, parts: impl IntoIterator<Item = u32>) {
        self.history.note_delivered(tick, parts);
    }

    /// Judge a finished tick. Returns the untrue confirmations.
    pub fn look(&mut self, scene: &Scene<'_>) -> Vec<Confirmation> {
        self.history.look(scene);
        let mut untrue = Vec::new();
        for (level, watched) in Level::ALL.into_iter().zip(&mut self.levels) {
            if number(level, scene) != watched.orders[0].number {
                watched.orders.swap(0, 1);
                watched.orders[0] = order(level, scene);
            }
            let finished = finished(level, scene);
            if finished == watched.finished {
                continue;
            }
            watched.finished = finished;
            let Some(order) = watched.orders.iter().find(|order| Some(order.number) == finished) else {
                continue;
            };
            self.result.judged += 1;
            let mut found = order
                .claims
                .iter()
                .filter_map(|claim| Some((claim, claim.check(scene, &self.history).err()?)));
            let Some((claim, Contradiction { text, not_sensed })) = found.next() else {
                if order.claims.iter().any(Claim::is_of_grasp) {
                    self.history.note_in_place(scene.cell);
                }
                continue;
            };
            let unconfirmed = unconfirmed(level, scene);
            let holds = scene.cell.held().is_some();
            let covered = claim.is_covered(unconfirmed, holds).then_some(NotSensed::Unconfirmed);
            let failed = self.history.has_just_failed(scene.tick, level);
            let lasting = not_sensed.or(covered.filter(|_| unconfirmed == Unconfirmed::PartInFingers));
            if let (Some(why), true) = (lasting, claim.is_of_part()) {
                self.history.note_displaced(scene.cell, why);
            }
            let not_sensed = not_sensed.or(covered).or(failed.then_some(NotSensed::ChangedAfterLook));
            let verdict = not_sensed.map_or(Verdict::False, Verdict::NotSensed);
            let command = order.text.clone();
            untrue.push(Confirmation { tick: scene.tick.0, level, command, verdict, truth: text });
        }
        for one in &untrue {
            let list = if one.is_false() { &mut self.result.lies } else { &mut self.result.not_sensed };
            list.push(one.clone());
        }
        untrue
    }

    #[must_use]
    pub const fn result(&self) -> &TruthResult {
        &self.result
    }

    /// The failure of a finished job: the first false confirmation, if any.
    #[must_use]
    pub fn verdict(&self) -> Option<Failure> {
        let (first, rest) = self.result.lies.split_first()?;
        let more = if rest.is_empty() { String::new() } else { format!("; and {} more", rest.len()) };
        let text = format!("a confirmation is false: {first}{more}");
        Some(Failure::outside(Tick(first.tick), Kind::FalseReport, "cell", text))
    }
}

const fn number(level: Level, scene: &Scene<'_>) -> u32 {
    let Scene { hws, memory, .. } = scene;
    match level {
        Level::Task => hws.number,
        Level::Subtask => memory.task.subtask.number,
        Level::Emove => memory.subtask.emove.number,
        Level::Prim => memory.emove.prim.number,
    }
}

fn order(level: Level, scene: &Scene<'_>) -> Order {
    let Scene { hws, memory, .. } = scene;
    let (text, claims) = match level {
        Level::Task => (hws.to_string(), task::claims(hws, scene)),
        Level::Subtask => (memory.task.subtask.to_string(), subtask::claims(&memory.task.subtask, scene)),
        Level::Emove => (memory.subtask.emove.to_string(), emove::claims(&memory.subtask.emove, scene)),
        Level::Prim => (memory.emove.prim.to_string(), prim::claims(&memory.emove.prim, scene)),
    };
    Order { number: number(level, scene), text, claims }
}

/// Number of the command that a level reports as finished, if any.
fn finished(level: Level, scene: &Scene<'_>) -> Option<u32> {
    let memory = scene.memory;
    let (task, prim) = (&memory.task.status, &memory.prim.status);
    let (subtask, emove) = (&memory.subtask.status, &memory.emove.status);
    let (echo, is_finished) = match level {
        Level::Task => (task.echo, task.report == HwsReport::Finished),
        Level::Subtask => (subtask.echo, subtask.report == StatusReport::Done),
        Level::Emove => (emove.echo, emove.report == StatusReport::Done),
        Level::Prim => (prim.echo, prim.report == PrimReport::Done),
    };
    (is_finished && echo != 0).then_some(echo)
}

const fn unconfirmed(level: Level, scene: &Scene<'_>) -> Unconfirmed {
    match level {
        Level::Task => scene.memory.task.status.unconfirmed,
        Level::Subtask => scene.memory.subtask.status.unconfirmed,
        Level::Emove => scene.memory.emove.status.unconfirmed,
        Level::Prim => Unconfirmed::None,
    }
}
