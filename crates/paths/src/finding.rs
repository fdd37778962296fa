//! The results of a simulated flight: its segments and its findings.

use serde::Serialize;

use crate::{
    plan::{Datum, Phase},
    survey::Passing,
};

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    pub code: &'static str, // `path.joint`, `.contact`, `.link`, `.grip`, `.place`, `.gripper` or `.margin`
    /// True if the motion fails or collides; false if it only comes close to that.
    pub error: bool,
    pub line: u32, // from 1
    pub message: String,
    pub help: Option<String>,
    /// The records of the two ends, of which one is probably wrong. Empty if the order of the lines is wrong.
    pub data: Vec<Datum>,
    #[serde(skip)]
    pub key: String, // identifies the same finding in other walks
    #[serde(skip)]
    pub depth: f64, // severity: the greater of two findings with one key is kept
}

#[derive(Clone, Debug, Serialize)]
pub struct Segment {
    pub from: String,
    pub to: String,
    pub part: &'static str, // depart, trajectory, approach or goal
    pub joint: &'static str,
    pub margin_deg: f64,
    pub nearest: Option<Passing>, // `None`: no obstacle within the reported distance
}

impl Segment {
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

#[derive(Clone, Debug, Serialize)]
pub struct Walked {
    pub plan: Phase,
    pub segments: Vec<Segment>, // up to the end of the flight
}

impl Walked {
    #[must_use]
    pub const fn of(plan: Phase) -> Self {
        Self { plan, segments: Vec::new() }
    }
}
