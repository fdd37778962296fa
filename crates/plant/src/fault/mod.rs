//! Faults in the cell, described in a file: sensors, valves, air, wrong or misplaced parts.
//!
//! A [`FaultPlan`] is a seed and [`Fault`]s; an [`Injector`] applies it tick by tick to the words between cell and
//! controller, and to deliveries. [`text`] describes the notation; [`depc::fault`] the faults of the line.

mod inject;
pub mod text;
mod valve;

use std::fmt;

use geometry::units::Length;
use rcs_core::tick::TICK_S;
use serde::{Deserialize, Serialize};

pub(crate) use inject::Change;
pub use inject::{Delivery, FaultResult, Injector};
use interfaces::point::{Input, Output};

use crate::description::CellDescription;

#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct FaultPlan {
    pub seed: u64, // combined with the seed of the run
    pub faults: Vec<Fault>,
}

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Fault {
    pub number: usize,
    pub what: FaultSubject,
    pub when: When,
}

#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub struct When {
    /// First tick of the window; 0 is before the first tick of the run.
    pub from: u64,
    /// First tick after the window.
    pub until: u64,
    /// Probability of beginning in each tick of the window, or in each delivery; `None` if always present.
    pub rate: Option<f64>,
    /// Duration in ticks, if it has a rate.
    pub ticks: u64,
}

impl When {
    /// All ticks of a run.
    pub const ALWAYS: Self = Self { from: 0, until: u64::MAX, rate: None, ticks: 1 };

    #[must_use]
    pub const fn covers(&self, tick: u64) -> bool {
        self.from <= tick && tick < self.until
    }
}

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub enum FaultSubject {
    Sensor(#[serde(with = "crate::named")] Input, Disorder),
    Valve(#[serde(with = "crate::named")] Output, bool),
    AirLost,
    /// The hydraulics of the robot have failed, and can be switched on again only after the end of the fault (III.6).
    HydraulicsLost,
    RingStuck,
    JawStuck,
    CameraBlind,
    /// A device of the field I/O has no connection.
    FieldCut(String),
    /// Deliveries to a tray go wrong: all, or those of one part.
    Delivery(Option<String>, DeliveryFault),
    /// The stand of the pedestal is not on its mark on the floor (II.1.2.3): inches in x and y, degrees.
    PedestalMoved {
        x: f64,     // along world X, in
        y: f64,     // along world Y, in
        angle: f64, // about its own axis, degrees, positive to the left
    },
}

/// The error of a sensor; values are in counts of its word.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub enum Disorder {
    /// No signal: 0, not detected, or no power.
    Off,
    /// Stuck at a given value, or at the present one.
    Stuck(Option<i64>),
    /// Noise of up to this many counts.
    Noisy(f64),
    /// Delay: the value of this many ticks ago.
    Slow(u16),
    /// Offset, counts.
    Offset(f64),
    /// Drift, counts per second.
    Drift(f64),
}

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub enum DeliveryFault {
    Missing,
    /// The part lies off its place: offset along world X and Y, in.
    Misplaced {
        x: f64,
        y: f64,
    },
    /// The part is turned: right-hand roll about the tool's X (down), degrees.
    Turned(f64),
    WrongPart(String),
}

impl FaultSubject {
    /// True if it acts on deliveries instead of for a time.
    #[must_use]
    pub const fn is_delivery(&self) -> bool {
        matches!(self, Self::Delivery(..))
    }
}

impl FaultPlan {
    /// The description with the displacements of the plan, such as a moved pedestal.
    #[must_use]
    pub fn displaced(&self, description: &CellDescription) -> CellDescription {
        displaced(self.faults.iter(), description)
    }
}

fn displaced<'f>(faults: impl Iterator<Item = &'f Fault>, description: &CellDescription) -> CellDescription {
    let mut cell = description.clone();
    for fault in faults {
        if let FaultSubject::PedestalMoved { x, y, angle } = fault.what {
            let stand = cell.pedestal.stand.clone();
            cell.pedestal.position[0] += x;
            cell.pedestal.position[1] += y;
            cell.pedestal.azimuth += angle;
            if let Some(stand) = cell.fixture.iter_mut().find(|fixture| fixture.name == stand) {
                stand.centre[0] += x;
                stand.centre[1] += y;
                stand.azimuth += angle;
            }
        }
    }
    cell
}

impl fmt::Display for Disorder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Off => f.write_str("is off"),
            Self::Stuck(None) => f.write_str("is stuck"),
            Self::Stuck(Some(value)) => write!(f, "is stuck at {value}"),
            Self::Noisy(by) => write!(f, "is noisy by {by} counts"),
            Self::Slow(ticks) => write!(f, "is {:.2} s late", f64::from(*ticks) * TICK_S),
            Self::Offset(by) => write!(f, "is off by {by:+} counts"),
            Self::Drift(by) => write!(f, "drifts by {by:+} counts a second"),
        }
    }
}

impl fmt::Display for FaultSubject {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Sensor(sensor, disorder) => write!(f, "{} {disorder}", sensor.name()),
            Self::Valve(valve, true) => write!(f, "valve {} is stuck open", valve.name()),
            Self::Valve(valve, false) => write!(f, "valve {} is stuck closed", valve.name()),
            Self::AirLost => f.write_str("the air is lost"),
            Self::HydraulicsLost => f.write_str("the hydraulics are lost"),
            Self::RingStuck => f.write_str("the locking ring is stuck"),
            Self::JawStuck => f.write_str("the jaw of the vise is stuck"),
            Self::CameraBlind => f.write_str("the camera is blind"),
            Self::FieldCut(device) => write!(f, "{device} has no connection"),
            Self::Delivery(object, mishap) => {
                let object = object.as_deref().unwrap_or("the part");
                match mishap {
                    DeliveryFault::Missing => write!(f, "{object} is not delivered"),
                    DeliveryFault::Misplaced { x, y } => {
                        write!(f, "{object} lies {}, {} from its place", Length(*x), Length(*y))
                    }
                    DeliveryFault::Turned(angle) => write!(f, "{object} is turned by {angle} degrees"),
                    DeliveryFault::WrongPart(part) => write!(f, "{part} is delivered instead of {object}"),
                }
            }
            Self::PedestalMoved { x, y, angle } => {
                write!(f, "the pedestal is {}, {}, {angle} degrees from its mark", Length(*x), Length(*y))
            }
        }
    }
}
