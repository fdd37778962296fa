//! The verdict on a branch, and its result.

use closed_loop::truth::Confirmation;
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    Done,
    Stranded,
    /// An arm without pressure or a person has touched something, or let a part slide in the fingers.
    Apart,
    /// A commanded point has done damage, or a finished command has not had its effect.
    Hurt,
    False,
}

#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
pub struct OutageResult {
    /// True if a person released a device, or began a line of the workstation again.
    pub attended: bool,
    /// Ticks by which a finished branch ended later than the undisturbed run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub late: Option<u64>,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct BranchResult {
    /// Tick after which the branch was interrupted.
    pub at: u64,
    /// The interruptions, as on the command line.
    pub interruption: String,
    /// The smallest series of interruptions with the same verdict and reason, if there were several.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub smallest: Option<String>,
    pub verdict: Verdict,
    /// Reason of a verdict other than done, without numbers, by which branches are counted.
    pub reason: String,
    /// The reason with numbers, the tick in which it began, and the process that reported it.
    pub detail: String,
    pub line: String,
    /// True if that line is a command.
    pub met_command: bool,
    /// The command of each process at the interruption.
    pub doing: Vec<String>,
    /// The commands that have ended since: tick, command and result.
    pub ended: Vec<String>,
    pub until: u64,
    /// Ticks from the interruption to the last motion, if the branch is judged at rest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rest_after: Option<u64>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub untrue: Vec<Confirmation>,
    #[serde(default)]
    pub judged: u64,
    /// True if a command failed, a person applied the remedy or undid the disturbance, and the job continued.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub remedied: bool,
    /// True if the branch was to run to the end of the job.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub whole: bool,
    /// How the branch got over the outage of a coupler, if there was one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outage: Option<OutageResult>,
    /// Digest of its last state.
    pub state: String,
    /// Digest of all ticks of a branch without interruption, which equals the digest of the ordinary run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub digest: Option<String>,
}
