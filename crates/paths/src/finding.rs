//! The results of a simulated flight: its segments and its findings.

use serde::Serialize;

use crate::{
    plan::{Datum, Phase},
    survey::Passing,
};

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// `path.joint`, `path.contact`, `path.link`, `path.grip`, `path.place`, `path.gripper` or `path.margin`.
    pub code: &'static str,
    /// True for an error: the motion fails or collides. False for a warning: the motion comes close to that.
    pub error: bool,
    /// Line number in the job, from 1.
    pub line: u32,
    /// Description of the problem: what, where, and by how much.
    pub message: String,
    pub help: Option<String>,
    /// The records that give the two ends of the segment: one of them is probably wrong. Empty if the finding is about
    /// the order of the lines.
    pub data: Vec<Datum>,
    /// Identifies the same finding in other walks.
    #[serde(skip)]
    pub key: String,
    /// Severity: of two findings with the same key, the one with the greater value is kept.
    #[serde(skip)]
    pub depth: f64,
}

#[derive(Clone, Debug, Serialize)]
pub struct Segment {
    pub from: String,
    /// Name of the point at its end.
    pub to: String,
    /// Part of the route: depart, trajectory, approach or goal.
    pub part: &'static str,
    /// Name of the joint that comes nearest to a limit.
    pub joint: &'static str,
    /// Margin of that joint, degrees.
    pub margin_deg: f64,
    /// The closest approach of an obstacle; `None` if none comes within the reported distance.
    pub nearest: Option<Passing>,
}

impl Segment {
    /// Keeps the smaller margins and clearances of this and another flight of the segment.
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

/// A phase with the results of its flight.
#[derive(Clone, Debug, Serialize)]
pub struct Walked {
    pub plan: Phase,
    /// Segments of the phase, up to the end of the flight.
    pub segments: Vec<Segment>,
}

impl Walked {
    /// A phase without a flight.
    #[must_use]
    pub const fn of(plan: Phase) -> Self {
        Self { plan, segments: Vec::new() }
    }
}
