//! The plan of a command: phases, and the points of each.

use geometry::frame::Frame;
use interfaces::emove::EmoveCommand;
use serde::Serialize;
use taskdata::{
    files::{Location, TrajPara},
    load::At,
};

#[derive(Clone, Debug, Serialize)]
pub struct Entry {
    pub what: &'static str,
    pub at: String,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Datum {
    pub name: String,
    #[serde(skip)]
    pub at: At,
}

#[derive(Clone, Debug, Serialize)]
pub struct Leg {
    pub part: &'static str, // depart, trajectory, approach or goal
    pub point: String,
    pub position_in: [f64; 3], // tool point, inches, world
    pub axis: [f64; 3],        // gripper axis, world
    pub acc_fac: i32,
    pub vel_max: i32,
    pub smooth: i32, // `smooth-acc`
    pub brk_dst: i32,
    pub ticks: u32,                  // from the previous point
    pub joint: Option<&'static str>, // nearest to a limit; `None`: out of reach
    pub margin_deg: Option<f64>,     // degrees; negative beyond the limit
    pub entry: Option<String>,       // file, block and line
    #[serde(skip)]
    pub datum: Option<Datum>, // pose, movetable or location point
    #[serde(skip)]
    pub frame: Frame, // tool frame, inches, world
}

impl Leg {
    #[must_use]
    pub const fn parameters(&self) -> TrajPara {
        TrajPara { acc_fac: self.acc_fac, vel_max: self.vel_max, smooth: self.smooth, brk_dst: self.brk_dst }
    }
}

#[derive(Clone, Debug, Serialize)]
pub struct Phase {
    pub what: String,
    pub opening_in: Option<f64>, // inches
    pub entries: Vec<Entry>,
    pub legs: Vec<Leg>,          // empty if the robot does not move
    pub missing: Option<String>, // why it cannot be planned
    #[serde(skip)]
    pub used: Vec<At>, // all records in use
    #[serde(skip)]
    pub start: String,
    #[serde(skip)]
    pub from: Frame, // tool frame, inches, world
    #[serde(skip)]
    pub guarded: bool, // a sensor ends the motion, at an unknown position
}

impl Phase {
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
