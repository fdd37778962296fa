//! The size of a blank as text: three sides of a box, or length and diameter of a cylinder.

use std::{fmt, str::FromStr};

use crate::pages::length;
use os_io::units;
use plant::description::{PartType, Shape};

const GREATEST: f64 = 20.0; // greatest side of a part, in

/// The size of a blank, in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Size {
    /// Box: length, width and height in the orientation in which it lies.
    Box {
        length: f64,
        width: f64,
        height: f64,
    },
    Round {
        length: f64,
        diameter: f64,
    },
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let sides: Option<Vec<f64>> = text.split('x').map(|side| length(side).ok()).collect();
        let sides = sides.filter(|sides| sides.iter().all(|side| (0.1..=GREATEST).contains(side)));
        match sides.as_deref() {
            Some([length, width, height]) => {
                Ok(Self::Box { length: *length, width: *width, height: *height })
            }
            Some([length, diameter]) => Ok(Self::Round { length: *length, diameter: *diameter }),
            _ => {
                let most = units::shown(&format!("0.10 to {GREATEST:.2} in")).into_owned();
                Err(format!(
                    "a length x width x height such as 3x1.5x1, or length x diameter such as 4x1.5, was expected, \
                     each {most}; found {text}"
                ))
            }
        }
    }
}

impl Size {
    /// Lengths of the sides along the axes of a part with the shape of `part`, in.
    pub fn like(&self, part: &PartType) -> Result<[f64; 3], String> {
        match (*self, part.shape) {
            (Self::Box { length, width, height }, Shape::Box) => Ok([height, width, length]),
            (Self::Round { length, diameter }, Shape::CylinderX) => Ok([length, diameter, diameter]),
            (Self::Round { length, diameter }, Shape::CylinderZ) => Ok([diameter, diameter, length]),
            (_, Shape::Box) => {
                Err(format!("{} is a box: length x width x height was expected, such as 3x1.5x1", part.name))
            }
            (_, Shape::CylinderX | Shape::CylinderZ) => {
                Err(format!("{} is a cylinder: length x diameter was expected, such as 4x1.5", part.name))
            }
        }
    }

    pub fn of(part: &PartType) -> Self {
        let [x, y, z] = part.size;
        match part.shape {
            Shape::Box => Self::Box { length: z, width: y, height: x },
            Shape::CylinderX => Self::Round { length: x, diameter: y },
            Shape::CylinderZ => Self::Round { length: z, diameter: y },
        }
    }
}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Box { length, width, height } => write!(f, "{length:.2} x {width:.2} x {height:.2} in"),
            Self::Round { length, diameter } => write!(f, "{length:.2} x {diameter:.2} in"),
        }
    }
}
