//! The fingers of a gripper with an air servo, with or without a part, for the processes of Grip. They are at one
//! of a few places, and move from one to the next in a tick.

use interfaces::{
    device::{GripSensors, valve},
    grip::{Calibration, Scale},
};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fingers {
    /// At the opening of the last order to open.
    Open,
    /// Narrower by 0.3 in.
    Drifted,
    /// One finger touches the part.
    Touching,
    /// The fingers hold the part with the commanded force.
    Holding,
    /// The fingers are as wide, and the part is gone.
    Emptied,
    /// The fingers are below the grasp size, and empty.
    Passed,
}

/// The places: opening and width of the part, 0.01 in, and force, lb.
#[derive(Clone, Copy, Debug)]
pub struct Sizes {
    pub open: u16,
    pub part: u16,
    pub force: u16,
}

/// Counts of the potentiometer at 0 and per hundredth of an inch; of a strain gage at 0 and per pound.
const POTENTIOMETER: (u16, u16) = (200, 7);
const STRAIN: (u16, u16) = (300, 40);

pub fn calibration() -> Calibration {
    let scale =
        |(zero, counts): (u16, u16), unit: f64| Scale { zero: zero.into(), gain: unit / f64::from(counts) };
    let strain = scale(STRAIN, 1.0);
    Calibration { potentiometer: scale(POTENTIOMETER, 0.01), left: strain, right: strain }
}

pub const fn flow(bits: u8) -> (bool, bool) {
    let opens = valve::OPEN_FINE | valve::OPEN_MEDIUM | valve::OPEN_COARSE;
    let closes = valve::CLOSE_FINE | valve::CLOSE_MEDIUM | valve::CLOSE_COARSE;
    (bits & opens != 0, bits & closes != 0)
}

impl Fingers {
    /// Next states, and whether they are prompt: moving fingers arrive.
    pub fn next(self, bits: u8) -> Vec<(Self, bool)> {
        match (flow(bits), self) {
            ((true, _), now) => vec![(now, false), (Self::Open, true)],
            ((_, true), now) => {
                vec![(now, false), (Self::Touching, false), (Self::Holding, true), (Self::Passed, true)]
            }
            (_, Self::Open) => vec![(Self::Open, true), (Self::Drifted, false)],
            (_, Self::Holding) => vec![(Self::Holding, true), (Self::Emptied, false)],
            (_, now) => vec![(now, true)],
        }
    }

    pub const fn sensors(self, sizes: &Sizes) -> GripSensors {
        let Sizes { open, part, force } = *sizes;
        let (opening, left, right) = match self {
            Self::Open => (open, 0, 0),
            Self::Drifted => (open - 30, 0, 0),
            Self::Touching => (part + 5, 4, 0),
            Self::Holding => (part, force, force),
            Self::Emptied => (part, 0, 0),
            Self::Passed => (part - 12, 0, 0),
        };
        GripSensors {
            potentiometer: POTENTIOMETER.0 + POTENTIOMETER.1 * opening,
            strain_left: STRAIN.0 + STRAIN.1 * left,
            strain_right: STRAIN.0 + STRAIN.1 * right,
            beams: 0,
        }
    }
}
