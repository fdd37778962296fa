//! Results of a flight: its segments and its findings.

use serde::Serialize;

use crate::{plan::Phase, survey::Passing};

/// A problem of a path.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// `path.joint`, `path.contact`, `path.link`, `path.grip`, `path.place` or `path.margin`.
    pub code: &'static str,
    /// An error: the motion fails or collides; otherwise a warning that it comes near to that.
    pub error: bool,
    /// Line of the job, from 1.
    pub line: u32,
    /// The problem, where, and by how much.
    pub message: String,
    /// What to do.
    pub help: Option<String>,
    /// Key of equal findings in other walks.
    #[serde(skip)]
    pub key: String,
    /// Of two equal findings the deeper one is kept.
    #[serde(skip)]
    pub depth: f64,
}

/// A flown segment.
#[derive(Clone, Debug, Serialize)]
pub struct Segment {
    /// The point before.
    pub from: String,
    /// The point.
    pub to: String,
    /// depart, trajectory, approach or goal.
    pub part: &'static str,
    /// The joint that comes nearest to a limit, and how near, degrees.
    pub joint: &'static str,
    /// How near, degrees.
    pub margin_deg: f64,
    /// The closest passing.
    pub nearest: Option<Passing>,
}

impl Segment {
    /// Keep the smaller margins and clearances of this and another flight.
    pub fn merge(&mut self, other: &Self) {
        if other.margin_deg < self.margin_deg {
            (self.joint, self.margin_deg) = (other.joint, other.margin_deg);
        }
        let clearance = |one: &Self| one.nearest.as_ref().map_or(f64::INFINITY, |near| near.clearance_in);
        if clearance(other) < clearance(self) {
            self.nearest.clone_from(&other.nearest);
        }
    }
}

/// A flown phase.
#[derive(Clone, Debug, Serialize)]
pub struct Walked {
    /// The phase.
    pub plan: Phase,
    /// Its segments, as far as they were flown.
    pub segments: Vec<Segment>,
}

impl Walked {
    /// A phase that is not flown.
    #[must_use]
    pub const fn of(plan: Phase) -> Self {
        Self { plan, segments: Vec::new() }
    }
}
