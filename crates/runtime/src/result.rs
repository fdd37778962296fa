//! The result of a run: the JSON object for scripts, and what the page for people is made of.

use std::{collections::BTreeMap, fmt, path::PathBuf};

use ::egm::host::Counters;
use depc::fault::{Counts, FaultKind};
use executive::{boards::coordinator::BoardFigures, failure::Failure, histogram, serial::SerialCounts};
use interfaces::t3i::LinkCounters;
use neighbours::{data_system::Item, workstation::player::Retry};
use plant::{PartState, fault::Struck};
use rcs_core::tick::Tick;
use serde::Serialize;

use crate::{
    contacts::{Collision, NearMiss},
    egm::EgmPort,
    operator::Requests,
    robot::Port,
    workstation::Emergency,
};

/// A command for Task.
#[derive(Clone, Debug, Serialize)]
pub struct CommandResult {
    /// As written in the job.
    pub text: String,
    /// `finished`, `error` or `executing`.
    pub status: &'static str,
    /// From the tick that sent it to the tick that saw its end.
    pub ticks: u64,
}

/// A command that had failed and was sent again.
#[derive(Clone, Debug, Serialize)]
pub struct RetryResult {
    /// The tick in which its failure was seen.
    pub tick: u64,
    /// As written in the job.
    pub text: String,
    /// Why it had failed.
    pub reason: &'static str,
    /// Which retry of the line this was, from 1.
    pub number: u32,
}

impl From<&Retry> for RetryResult {
    fn from(Retry { tick, line, reason, number, .. }: &Retry) -> Self {
        Self { tick: tick.0, text: bare(line), reason: reason.text(), number: *number }
    }
}

/// A line without the sign of a command.
pub fn bare(line: &str) -> String {
    line.trim_start_matches("==").trim_start().to_owned()
}

/// Times of the controller, without the cell, in microseconds.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct TickTimes {
    /// Median.
    pub p50: f64,
    /// 99 of 100 ticks took at most this.
    pub p99: f64,
    /// The longest.
    pub max: f64,
}

impl From<histogram::Summary> for TickTimes {
    fn from(summary: histogram::Summary) -> Self {
        Self { p50: summary.p50, p99: summary.p99, max: summary.max }
    }
}

/// What happened on the DEPC link.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct LinkResult {
    /// Data frames sent, repetitions included.
    pub frames: u32,
    /// NAKs received.
    pub naks: u32,
    /// Frames sent again.
    pub retries: u32,
    /// Reports with a wrong checksum.
    pub checksum_errors: u32,
    /// Points that were scaled back to the velocity limits.
    pub limited: u32,
}

impl From<&LinkCounters> for LinkResult {
    fn from(counters: &LinkCounters) -> Self {
        Self {
            frames: counters.frames,
            naks: counters.naks,
            retries: counters.retries,
            checksum_errors: counters.checksum_errors,
            limited: counters.limited,
        }
    }
}

/// Faults that were injected into the line, both directions together.
#[derive(Clone, Debug, Serialize)]
pub struct FaultsResult {
    /// Faults of all kinds.
    pub total: u64,
    /// Of each kind that happened.
    pub kinds: BTreeMap<&'static str, u64>,
}

impl From<Counts> for FaultsResult {
    fn from(counts: Counts) -> Self {
        let kinds = FaultKind::ALL.iter().map(|kind| (kind.text(), counts.of(*kind)));
        Self { total: counts.faults(), kinds: kinds.filter(|(_, count)| *count > 0).collect() }
    }
}

impl fmt::Display for FaultsResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} injected", self.total)?;
        let mut separator = ": ";
        for (kind, count) in &self.kinds {
            write!(f, "{separator}{kind} {count}")?;
            separator = ", ";
        }
        Ok(())
    }
}

/// A fault of the cell that happened.
#[derive(Clone, Debug, Serialize)]
pub struct CellFaultResult {
    /// Which one of its file, from 1.
    pub number: usize,
    /// In words.
    pub text: String,
    /// How often it began.
    pub times: u64,
    /// The tick in which it began first.
    pub first: u64,
    /// The last tick in which it was there.
    pub last: u64,
}

impl From<Struck> for CellFaultResult {
    fn from(Struck { number, text, times, first, last }: Struck) -> Self {
        Self { number, text, times, first, last }
    }
}

impl fmt::Display for CellFaultResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}, ", self.number, self.text)?;
        match self.times {
            1 if self.first == self.last => write!(f, "in tick {}", self.first),
            1 => write!(f, "ticks {} to {}", self.first, self.last),
            times => write!(f, "{times} times, ticks {} to {}", self.first, self.last),
        }
    }
}

/// What went over a serial port.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct PortResult {
    /// Bytes received.
    pub received: u64,
    /// Bytes sent.
    pub sent: u64,
    /// Bytes that the port did not take.
    pub unsent: u64,
    /// How often the port disappeared.
    pub losses: u32,
    /// By how much the time between two data commands differed from 40 ms.
    pub deviation_us: TickTimes,
}

impl From<&Port> for PortResult {
    fn from(port: &Port) -> Self {
        let SerialCounts { received, sent, unsent, losses, .. } = port.counts();
        Self { received, sent, unsent, losses, deviation_us: port.deviations().into() }
    }
}

/// What went over the line to a robot with EGM.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct EgmResult {
    /// Messages received that were new.
    pub received: u64,
    /// Messages that were old when they came.
    pub old: u64,
    /// Datagrams that were no message of a robot.
    pub refused: u64,
    /// Targets sent.
    pub sent: u64,
    /// Points that became a path.
    pub points: u64,
    /// Motions that were ended because no point, or no message, came in time.
    pub interrupted: u64,
    /// Targets that were held back at the limits.
    pub beyond: u64,
    /// Root mean square of the distance from the robot to its target, mm.
    pub error_rms_mm: f64,
    /// The greatest.
    pub error_max_mm: f64,
    /// Times between two messages of the robot.
    pub cycle_us: TickTimes,
    /// Times from a message to its answer.
    pub answer_us: TickTimes,
}

impl From<&EgmPort> for EgmResult {
    fn from(port: &EgmPort) -> Self {
        let Counters { received, old, refused, sent, points, interrupted, beyond } = port.counters();
        let [error_rms_mm, error_max_mm] = port.errors();
        let (cycle_us, answer_us) = (port.cycles().into(), port.answers().into());
        Self {
            received,
            old,
            refused,
            sent,
            points,
            interrupted,
            beyond,
            error_rms_mm,
            error_max_mm,
            cycle_us,
            answer_us,
        }
    }
}

/// Two things that have run into each other.
#[derive(Clone, Debug, Serialize)]
pub struct ContactResult {
    /// What moved.
    pub mover: String,
    /// What it has met.
    pub obstacle: String,
    /// How deep at the most, inches.
    pub depth_in: f64,
}

/// The last loss of hydraulic pressure in an emergency, and what became of the arm.
#[derive(Clone, Debug, Serialize)]
pub struct EmergencyResult {
    /// Tick in which the pressure went.
    pub tick: u64,
    /// Who stopped the robot, or what failed.
    pub cause: String,
    /// Where the tool point was, inches.
    pub position_in: [f64; 3],
    /// The arm has come to rest.
    pub at_rest: bool,
    /// The shot pin has stopped the shoulder.
    pub on_shot_pin: bool,
    /// What the sagging arm has run into, the deepest first.
    pub touched: Vec<ContactResult>,
}

impl From<&Emergency> for EmergencyResult {
    fn from(Emergency { tick, droop }: &Emergency) -> Self {
        let touched = droop.touched.iter().map(|contact| ContactResult {
            mover: contact.mover.clone(),
            obstacle: contact.obstacle.clone(),
            depth_in: contact.depth,
        });
        Self {
            tick: tick.0,
            cause: droop.cause.to_string(),
            position_in: droop.position,
            at_rest: droop.at_rest,
            on_shot_pin: droop.on_shot_pin,
            touched: touched.collect(),
        }
    }
}

/// Where a part ended.
#[derive(Clone, Debug, Serialize)]
pub struct PartResult {
    /// Its name at the end.
    pub name: String,
    /// A unit, the vise's location, `gripper`, `floor` or `elsewhere`.
    pub location: String,
    /// Sector of the unit, 0 elsewhere.
    pub sector: u16,
    /// The gripper holds it.
    pub held: bool,
    /// Its middle in world coordinates, inches.
    pub position_in: [f64; 3],
    /// From the centre of its sector, or from its seat in the vise, inches.
    pub error_in: Option<f64>,
}

impl From<PartState> for PartResult {
    fn from(part: PartState) -> Self {
        Self {
            name: part.name,
            location: part.location,
            sector: part.sector,
            held: part.held,
            position_in: part.position,
            error_in: part.error,
        }
    }
}

impl fmt::Display for PartResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} at {}", self.name, self.location)?;
        if self.sector > 0 {
            write!(f, " sector {}", self.sector)?;
        }
        if let Some(error) = self.error_in {
            let from = if self.sector > 0 { "the sector's centre" } else { "its seat" };
            write!(f, ", {error:.2} in from {from}")?;
        }
        let [x, y, z] = self.position_in;
        write!(f, " ({x:.2} {y:.2} {z:.2})")
    }
}

/// Where the Data System believes that an item is.
#[derive(Clone, Debug, Serialize)]
pub struct ItemResult {
    /// Its name.
    pub item: String,
    /// Its serial number; empty if the commands gave none.
    pub serial: String,
    /// A location, or `H_ROBOT` while the robot holds it.
    pub position: String,
    /// Sector there, 0 for none.
    pub sector: u8,
}

impl From<Item> for ItemResult {
    fn from(item: Item) -> Self {
        Self { item: item.name, serial: item.number, position: item.position, sector: item.sector }
    }
}

impl fmt::Display for ItemResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.item)?;
        if !self.serial.is_empty() {
            write!(f, " {}", self.serial)?;
        }
        write!(f, " at {}", self.position)?;
        if self.sector == 0 { Ok(()) } else { write!(f, " sector {}", self.sector) }
    }
}

/// What a board with control processes did.
#[derive(Clone, Debug, Serialize)]
pub struct BoardResult {
    /// Its number.
    pub board: u8,
    /// What runs on it.
    pub processes: String,
    /// Its process in the operating system.
    pub pid: u32,
    /// From its wake-up to its stamp.
    pub tick_us: TickTimes,
    /// Heap allocations in its ticks.
    pub allocations: u64,
}

impl From<BoardFigures<'_>> for BoardResult {
    fn from(figures: BoardFigures<'_>) -> Self {
        Self {
            board: figures.board.number(),
            processes: figures.board.process_names(),
            pid: figures.pid,
            tick_us: figures.times.summary().into(),
            allocations: figures.allocations,
        }
    }
}

/// Why a run failed.
#[derive(Clone, Debug, Serialize)]
pub struct FailureResult {
    /// Tick in which it began.
    pub tick: u64,
    /// The line of the job, or the command, that was under way then.
    pub line: Option<String>,
    /// The process that knows why.
    pub process: String,
    /// Its decision table, if one was used.
    pub table: Option<String>,
    /// The row that fired.
    pub row: Option<u8>,
    /// The whole in one sentence.
    pub text: String,
    /// What a person has to do before the job can go on; none if PAUSE and the same command may be enough.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub remedy: Option<&'static str>,
}

impl FailureResult {
    /// A failure in a line, and what a person has to do.
    #[must_use]
    pub fn new(failure: &Failure, line: Option<&str>, remedy: Option<&'static str>) -> Self {
        Self {
            tick: failure.tick.0,
            line: line.map(str::to_owned),
            process: failure.process.clone(),
            table: failure.table.clone(),
            row: failure.row,
            text: failure.text.clone(),
            remedy,
        }
    }
}

/// What has happened, and when.
#[derive(Clone, Debug, Serialize)]
pub struct EventResult {
    /// The tick.
    pub tick: u64,
    /// In words.
    pub text: String,
}

impl fmt::Display for EventResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "tick {}: {}", self.tick, self.text)
    }
}

/// Events that a run remembers; the log has all. A run of a year must not fill the memory.
const REMEMBERED: usize = 1000;

/// What has happened in a run beside what was commanded: in the cell, and with the neighbours.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Events {
    /// How many events there were.
    pub count: usize,
    /// The first thousand of them.
    pub first: Vec<EventResult>,
}

impl Events {
    /// Something has happened in a tick.
    pub fn push(&mut self, tick: Tick, what: &str) {
        self.count += 1;
        if self.first.len() < REMEMBERED {
            self.first.push(EventResult { tick: tick.0, text: what.to_owned() });
        }
    }
}

/// What a run with a robot at a port says of a cell that only follows the robot.
pub const SIMULATED: &str =
    "parts, contacts, clearance and events are those of the simulated cell, which follows the robot";

/// The result of a run. The names of the fields are those of the JSON object.
#[derive(Clone, Debug, Serialize)]
pub struct RunResult {
    /// Name of the job.
    pub job: String,
    /// Commands that were sent to Task.
    pub commands: Vec<CommandResult>,
    /// Commands that had failed and were sent again, after a PAUSE (`--retry`).
    pub retries: Vec<RetryResult>,
    /// What operators have asked for; none if nobody has.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub operator: Option<Requests>,
    /// Ticks that were run, without those in which the robot was brought to rest.
    pub ticks: u64,
    /// Ticks in which the robot was brought to rest at the end.
    pub ramp_ticks: u32,
    /// The time that the cell went through.
    pub simulated_s: f64,
    /// The time that it took.
    pub wall_s: f64,
    /// How often the first is the second.
    pub realtime_factor: f64,
    /// Slots of the 40 ms grid that were skipped.
    pub overruns: u64,
    /// The same by what is to blame: a part of the tick before, or `waking` if the system woke the thread late.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub overruns_by: BTreeMap<String, u64>,
    /// Heap allocations of the controller after the start.
    pub allocations_after_start: Option<u64>,
    /// Times of the controller.
    pub tick_us: TickTimes,
    /// Times of all parts of a tick: control processes by their names, and what the executive does.
    pub part_us: BTreeMap<String, TickTimes>,
    /// How late ticks began.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub late_us: Option<TickTimes>,
    /// What the system granted for real time, and what it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub realtime: Option<String>,
    /// The boards, if there is more than one; `tick_us` above is from the pulse to the last stamp then.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub boards: Option<Vec<BoardResult>>,
    /// The link.
    pub link: LinkResult,
    /// Faults of the line of `--faults`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub faults: Option<FaultsResult>,
    /// Faults of the cell that happened, in the order of the file; none without `--faults`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub cell_faults: Vec<CellFaultResult>,
    /// The serial port.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub port: Option<PortResult>,
    /// The line to a robot with EGM.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub egm: Option<EgmResult>,
    /// The last emergency, if there was one, also if the robot was started again after it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub emergency_stop: Option<EmergencyResult>,
    /// Fingerprint of all output buffers of all ticks.
    pub digest: String,
    /// The same without the ticks in which the robot was brought to rest: the clock does not change it.
    pub digest_before_ramp: String,
    /// Which of the statements are about the simulated cell, if the robot is not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub simulated: Option<&'static str>,
    /// Where the parts are.
    pub parts: Vec<PartResult>,
    /// What the Data System was told of items of the MBD.
    pub data_base: Vec<ItemResult>,
    /// What was touched that may not be touched.
    pub contacts: Vec<Collision>,
    /// The nearest miss, if something was passed nearer than 2 in.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clearance: Option<NearMiss>,
    /// What has happened beside.
    pub events: Events,
    /// The log that was written.
    pub log: Option<PathBuf>,
    /// Why it failed, if it did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<FailureResult>,
}

impl RunResult {
    /// What the log says of the end of the run. Nothing here differs between two equal runs in fast clock.
    #[must_use]
    pub fn facts(&self) -> BTreeMap<String, String> {
        let list = |items: Vec<String>| items.join("; ");
        let mut facts = vec![
            ("overruns", self.overruns.to_string()),
            ("parts", list(self.parts.iter().map(ToString::to_string).collect())),
            ("data_base", list(self.data_base.iter().map(ToString::to_string).collect())),
        ];
        if let Some(nearest) = &self.clearance {
            facts.push(("clearance", nearest.to_string()));
        }
        if !self.contacts.is_empty() {
            facts.push(("contacts", list(self.contacts.iter().map(ToString::to_string).collect())));
        }
        if let Some(allocations) = self.allocations_after_start {
            facts.push(("allocations", allocations.to_string()));
        }
        if let Some(faults) = &self.faults {
            facts.push(("faults", faults.to_string()));
        }
        if !self.cell_faults.is_empty() {
            facts.push(("cell_faults", list(self.cell_faults.iter().map(ToString::to_string).collect())));
        }
        if let Some(failure) = &self.failure {
            facts.push(("failed_at", failure.tick.to_string()));
            facts.extend(failure.line.iter().map(|line| ("line", line.clone())));
        }
        if let Some(verdict) = &self.realtime {
            facts.push(("real_time", verdict.clone()));
        }
        facts.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
    }
}
