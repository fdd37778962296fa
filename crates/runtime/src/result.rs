//! The result of a run: the JSON object for scripts, from which the text for people is made.

mod cell;
mod robot;
mod timing;

use std::{collections::BTreeMap, path::PathBuf};

use executive::failure::Failure;
use neighbours::workstation::player::Retry;
use serde::Serialize;

pub use self::{
    cell::{CellFaultResult, ContactResult, EmergencyResult, EventResult, Events, ItemResult, PartResult},
    robot::{EgmResult, FaultsResult, LinkResult, PortResult},
    timing::{BoardResult, TickTimes},
};
use crate::{
    contacts::{Collision, NearMiss},
    operator::Requests,
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

/// Why a run failed.
#[derive(Clone, Debug, Serialize)]
pub struct FailureResult {
    /// Tick in which it began.
    pub tick: u64,
    /// The line of the job, or the command, in progress then.
    pub line: Option<String>,
    /// The process that reports the reason.
    pub process: String,
    /// Its decision table, if one was used.
    pub table: Option<String>,
    /// The row that fired.
    pub row: Option<u8>,
    /// The failure in one sentence.
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

/// Note in the result of a run with a robot at a port, whose cell only follows the robot.
pub const SIMULATED: &str =
    "parts, contacts, clearance and events are those of the simulated cell, which follows the robot";

/// The result of a run. The names of the fields are those of the JSON object.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
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
    /// Simulated time, s.
    pub simulated_s: f64,
    /// Wall-clock time, s.
    pub wall_s: f64,
    /// Ratio of the two.
    pub realtime_factor: f64,
    /// Slots of the 40 ms grid that were skipped.
    pub overruns: u64,
    /// The same by cause: a part of the tick before, or `waking` if the system woke the thread late.
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
    /// What the system granted for real time, and which system it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub realtime: Option<String>,
    /// The boards, if there is more than one; `tick_us` is then the time from the pulse to the last stamp.
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
    /// Items of the MBD in the Data System.
    pub data_base: Vec<ItemResult>,
    /// Contacts that are not permitted.
    pub contacts: Vec<Collision>,
    /// The nearest miss, if something was passed nearer than 2 in.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clearance: Option<NearMiss>,
    /// Other events.
    pub events: Events,
    /// The log that was written.
    pub log: Option<PathBuf>,
    /// Why it failed, if it did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<FailureResult>,
}

impl RunResult {
    /// Metadata of the end of the run. They are the same for two equal runs in fast clock.
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
