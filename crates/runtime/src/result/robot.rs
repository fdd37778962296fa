use std::{collections::BTreeMap, fmt};

use ::egm::host::Counters;
use depc::fault::{Counts, FaultKind};
use executive::egm::Refusals;
use executive::serial::SerialCounts;
use interfaces::t3i::LinkCounters;
use serde::Serialize;

use super::timing::TickTimes;
use crate::{egm::EgmPort, robot::Port};

#[derive(Clone, Copy, Debug, Serialize)]
pub struct LinkResult {
    pub frames: u32,
    pub naks: u32,
    pub retries: u32,
    pub checksum_errors: u32,
    pub limited: u32, // points scaled back to the velocity limits
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

/// Number of faults injected into the line, both directions together.
#[derive(Clone, Debug, Serialize)]
pub struct FaultsResult {
    pub total: u64,
    pub kinds: BTreeMap<&'static str, u64>, // by kind
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

#[derive(Clone, Copy, Debug, Serialize)]
pub struct PortResult {
    pub received: u64,
    pub sent: u64,
    pub unsent: u64,
    /// Number of times that the port disappeared.
    pub losses: u32,
    /// Deviation of the time between two data commands from 40 ms.
    pub deviation_us: TickTimes,
}

impl From<&Port> for PortResult {
    fn from(port: &Port) -> Self {
        let SerialCounts { received, sent, unsent, losses, .. } = port.counts();
        Self { received, sent, unsent, losses, deviation_us: port.deviations().into() }
    }
}

#[derive(Clone, Debug, Serialize)]
pub struct EgmResult {
    pub received: u64,
    pub old: u64,                     // received too late or twice
    pub refused: u64,                 // not valid messages of a robot
    pub elsewhere: u64,               // from other addresses than the robot's
    pub last_refused: Option<String>, // address and reason
    pub sent: u64,
    /// Points that were added to a path.
    pub points: u64,
    /// Motions that were stopped because no point, or no message, arrived in time.
    pub interrupted: u64,
    pub beyond: u64,
    pub error_rms_mm: f64, // root mean square of the distance from the robot to its target, mm
    pub error_max_mm: f64, // greatest distance, mm
    /// Times between two messages of the robot.
    pub cycle_us: TickTimes,
    pub answer_us: TickTimes,
}

impl From<&EgmPort> for EgmResult {
    fn from(port: &EgmPort) -> Self {
        let Counters { received, old, sent, points, interrupted, beyond, .. } = port.counters();
        let Refusals { invalid, elsewhere, last } = port.refusals();
        let [error_rms_mm, error_max_mm] = port.errors();
        let (cycle_us, answer_us) = (port.cycles().into(), port.answers().into());
        Self {
            received,
            old,
            refused: invalid,
            elsewhere,
            last_refused: last.map(|last| last.to_string()),
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
