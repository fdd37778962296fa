//! The plan of a command: phases, and the points of each.

use geometry::frame::Frame;
use interfaces::emove::EmoveCommand;
use serde::Serialize;
use taskdata::{
    files::{Location, TrajPara},
    load::At,
};

/// An entry of the task data that a path uses.
#[derive(Clone, Debug, Serialize)]
pub struct Entry {
    pub what: &'static str,
    pub at: String,
}

/// A record of the task data that has a name.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Datum {
    pub name: String,
    #[serde(skip)]
    pub at: At,
}

#[derive(Clone, Debug, Serialize)]
pub struct Leg {
    /// Part of the route: depart, trajectory, approach or goal.
    pub part: &'static str,
    pub point: String,
    /// Tool point, inches, world.
    pub position_in: [f64; 3],
    /// Direction of the gripper axis, world.
    pub axis: [f64; 3],
    pub acc_fac: i32,
    pub vel_max: i32,
    /// `smooth-acc`.
    pub smooth: i32,
    pub brk_dst: i32,
    /// Ticks from the previous point to this one.
    pub ticks: u32,
    /// Name of the joint that is nearest to a limit; `None` if the arm cannot reach the pose.
    pub joint: Option<&'static str>,
    /// Margin of that joint, degrees; negative beyond the limit.
    pub margin_deg: Option<f64>,
    /// File, block and line of the point.
    pub entry: Option<String>,
    /// The pose, movetable or location point that gives the point.
    #[serde(skip)]
    pub datum: Option<Datum>,
    /// Tool frame, inches, world.
    #[serde(skip)]
    pub frame: Frame,
}

impl Leg {
    /// Parameters of the segment that ends at the point.
    #[must_use]
    pub const fn parameters(&self) -> TrajPara {
        TrajPara { acc_fac: self.acc_fac, vel_max: self.vel_max, smooth: self.smooth, brk_dst: self.brk_dst }
    }
}

/// One command of E-move, or of a neighbour.
#[derive(Clone, Debug, Serialize)]
pub struct Phase {
    pub what: String,
    /// Opening commanded during the motion, inches.
    pub opening_in: Option<f64>,
    /// The entries of the task data that it uses.
    pub entries: Vec<Entry>,
    /// The points of its path; empty if the robot does not move.
    pub legs: Vec<Leg>,
    /// Why the phase cannot be planned; `None` if it can.
    pub missing: Option<String>,
    /// The places of all records that it uses.
    #[serde(skip)]
    pub used: Vec<At>,
    /// Name of the point at its start.
    #[serde(skip)]
    pub start: String,
    /// Tool frame at its start, inches, world.
    #[serde(skip)]
    pub from: Frame,
    /// True if a sensor ends the motion, at a position that is not known beforehand.
    #[serde(skip)]
    pub guarded: bool,
}

impl Phase {
    /// A phase without motion.
    #[must_use]
    pub fn standing(what: String) -> Self {
        Self {
            what,
            opening_in: None,
            entries: Vec::new(),
            legs: Vec::new(),
            missing: None,
            used: Vec::new(),
            start: String::new(),
            from: Frame::identity(),
            guarded: false,
        }
    }

    /// Duration of the motion, ticks.
    #[must_use]
    pub fn ticks(&self) -> u32 {
        self.legs.iter().map(|leg| leg.ticks).sum()
    }
}

pub(crate) fn described(command: &EmoveCommand, location: &Location) -> String {
    let sector = location.sector.map_or(String::new(), |sector| format!(" sector {sector}"));
    let verb = command.command.text();
    match command.object {
        None => format!("{verb} {}{sector}", location.name),
        Some(object) => format!("{verb} {object} with grip {:+} at {}{sector}", command.grip, location.name),
    }
}
