//! The result of a run: the JSON object from which the text is made.

mod cell;
mod data;
mod field;
mod robot;
mod timing;

use std::{collections::BTreeMap, path::PathBuf};

use closed_loop::{
    account::Account,
    chain::Chain,
    contacts::{Collision, NearMiss},
    truth::TruthResult,
};
use neighbours::workstation::player::Retry;
use plant::PartState;
use record::{Log, explanation};
use serde::{Deserialize, Serialize};

pub use self::{
    cell::{CellFaultResult, ContactResult, EmergencyResult, EventResult, Events, ItemResult},
    data::DataResult,
    field::{FieldDevice, FieldResult},
    robot::{EgmResult, FaultsResult, LinkResult, PortResult},
    timing::{BoardResult, TickTimes},
};
use crate::operator::Requests;

#[derive(Clone, Debug, Serialize)]
pub struct CommandResult {
    pub text: String,
    pub status: &'static str, // `finished`, `error` or `executing`
    /// The unconfirmed goals of a finished command; not written if the sensors confirm them.
    #[serde(skip_serializing_if = "str::is_empty")]
    pub unconfirmed: &'static str,
    pub ticks: u64, // ticks from sending the command to detecting its end
}

#[derive(Clone, Debug, Serialize)]
pub struct RetryResult {
    pub tick: u64, // tick in which the failure was detected
    pub text: String,
    pub reason: &'static str,
    pub number: u32,
}

impl From<&Retry> for RetryResult {
    fn from(Retry { tick, line, reason, number, .. }: &Retry) -> Self {
        Self { tick: tick.0, text: bare(line), reason: reason.text(), number: *number }
    }
}

pub fn bare(line: &str) -> String {
    line.trim_start_matches("==").trim_start().to_owned()
}

#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct FailureResult {
    #[serde(flatten)]
    pub account: Account,
    pub line: Option<String>, // the line of the job, or the command, in progress at the first failure
    /// The operator's action before the job can continue; `None` if PAUSE and the same command may be enough.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub remedy: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub chain: Option<Chain>, // what led to the failure; `None` in a log of an older program
}

impl FailureResult {
    /// The failure attached to a log: `Some(None)` for a successful run, `None` for a killed one.
    #[must_use]
    pub fn of_log(log: &Log) -> Option<Option<Self>> {
        if let Some(file) = log.attachment(explanation::FAILURE)
            && let Ok(failure) = serde_json::from_slice(&file.data)
        {
            return Some(Some(failure));
        }
        let account = log.end.as_ref().and_then(Account::of_facts)?;
        Some(account.map(|account| Self { account, line: None, remedy: None, chain: None }))
    }
}

/// Note in the result of a run with a robot at a port, whose cell only follows the robot.
pub const SIMULATED: &str =
    "parts, contacts, clearance and events are those of the simulated cell, which follows the robot";

#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct RunResult {
    /// Why the run cannot be resumed from its journal; not written without trouble.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub journal_trouble: Option<String>,
    pub job: String,
    pub ending: &'static str, // how the run ended: `finished`, `stopped` or `failed`
    pub data: DataResult,
    pub commands: Vec<CommandResult>,
    pub retries: Vec<RetryResult>, // commands that failed and were repeated after a PAUSE (`--retry`)
    #[serde(skip_serializing_if = "Option::is_none")]
    pub operator: Option<Requests>, // requests of operators, if any
    #[serde(skip_serializing_if = "Option::is_none")]
    pub field: Option<FieldResult>, // the couplers between controller and cell; `None` without `--field`
    pub ticks: u64,                // number of ticks, without those in which the robot was brought to rest
    pub ramp_ticks: u32,           // number of ticks in which the robot was brought to rest at the end
    pub simulated_s: f64,
    pub wall_s: f64,
    pub realtime_factor: f64, // ratio of simulated time to wall-clock time
    pub overruns: u64,        // number of skipped slots of the 40 ms grid
    /// The same by cause: a part of the tick before, or `waking` if the system woke the thread late.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub overruns_by: BTreeMap<String, u64>,
    pub allocations_after_start: Option<u64>, // heap allocations of the controller after the start
    pub tick_us: TickTimes,
    /// Times of all parts of a tick: control processes by name, and the parts of the executive.
    pub part_us: BTreeMap<String, TickTimes>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub late_us: Option<TickTimes>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub realtime: Option<String>, // the real-time settings that the system granted, and the system
    /// The boards, if there is more than one; `tick_us` is then the time from the pulse to the last stamp.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub boards: Option<Vec<BoardResult>>,
    pub link: LinkResult,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub faults: Option<FaultsResult>, // injected faults of the line from `--faults`
    /// Faults of the cell that occurred, in the order of the file; empty without `--faults`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub cell_faults: Vec<CellFaultResult>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub port: Option<PortResult>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub egm: Option<EgmResult>, // counts and times of the line to a robot with EGM
    /// The last emergency, if any, even if the robot was restarted after it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub emergency_stop: Option<EmergencyResult>,
    pub digest: String, // fingerprint of all output buffers of all ticks
    /// The same without the ticks in which the robot was brought to rest; it does not depend on the clock.
    pub digest_before_ramp: String,
    /// Note about the statements that refer to the simulated cell, if the robot is not simulated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub simulated: Option<&'static str>,
    pub parts: Vec<PartState>,
    pub data_base: Vec<ItemResult>, // items of the MBD in the Data System
    /// Number of commands of all levels that were reported as finished, and the false reports.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub truth: Option<TruthResult>,
    pub contacts: Vec<Collision>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clearance: Option<NearMiss>, // the nearest miss, if a distance was less than 2 in
    pub events: Events,
    /// Path of the log; `None` without a log, or if the log ended before the run did.
    pub log: Option<PathBuf>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<FailureResult>,
}

impl RunResult {
    /// Metadata of the end of the run. Two equal runs in fast clock have equal metadata.
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
            facts.push(("failed_at", failure.account.first.tick.to_string()));
            facts.extend(failure.line.iter().map(|line| ("line", line.clone())));
        }
        if let Some(verdict) = &self.realtime {
            facts.push(("real_time", verdict.clone()));
        }
        facts.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
    }
}
