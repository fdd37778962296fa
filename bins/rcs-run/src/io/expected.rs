//! What a person can do to a sensor, and which values it then has.

use field::{InPoint, Target};
use interfaces::{
    device::FORCE_ZERO,
    point::{Kind, Station},
};
use levels::jaws::POTENTIOMETER_OFFSET;

/// How a person works a sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Work {
    /// On, and off.
    Switch,
    /// To its highest value, and to its lowest one.
    Range(Limits),
    /// To any other value: a number, or a resolver.
    Change,
}

/// Counts of an analog sensor that a person has moved through its range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    pub lowest: Option<Near>,
    pub highest: Option<Near>,
    pub span: i64, // least difference between highest and lowest value
}

/// A value that must be within a tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Near {
    pub value: i64,
    pub tolerance: i64,
}

impl Near {
    pub const fn contains(self, value: i64) -> bool {
        value.abs_diff(self.value) <= self.tolerance.unsigned_abs()
    }
}

/// Closed fingers: the offset of the potentiometer, with the tolerance beyond which a gripper takes it as failed.
const CLOSED: Near = Near { value: POTENTIOMETER_OFFSET as i64, tolerance: 90 };
const OPENED: i64 = 600; // least change of a potentiometer when the fingers open: an inch
const FELT: i64 = 40; // least change of a strain gage or force sensor by a push: about a pound
const TURNED: i64 = 50; // least change of the table's potentiometer: 5 degrees

/// How a person works the sensor of an input.
pub fn work(point: &InPoint) -> Work {
    let range = match point.target {
        Target::Word(word) => word.range(),
        Target::Station => Station::read(&point.name).map_or(0..=1, |word| word.range()),
    };
    if range == (0..=1) {
        return Work::Switch;
    }
    let Target::Word(word) = point.target else { return Work::Change };
    match word.kind() {
        Kind::Knob => {
            let tolerance = (range.end() - range.start()) / 20;
            let near = |value| Some(Near { value, tolerance });
            Work::Range(Limits {
                lowest: near(*range.start()),
                highest: near(*range.end()),
                span: (range.end() - range.start()) / 2,
            })
        }
        Kind::Force => Work::Range(Limits { lowest: None, highest: None, span: FELT }),
        Kind::Converter if point.name.starts_with("table.") => {
            Work::Range(Limits { lowest: None, highest: None, span: TURNED })
        }
        Kind::Converter if point.name.ends_with(".potentiometer") => {
            Work::Range(Limits { lowest: Some(CLOSED), highest: None, span: OPENED })
        }
        Kind::Converter => Work::Range(Limits { lowest: None, highest: None, span: FELT }),
        _ => Work::Change,
    }
}

/// Counts of a sensor at rest, where they are known.
pub fn at_rest(point: &InPoint) -> Option<Near> {
    let Target::Word(word) = point.target else { return None };
    (word.kind() == Kind::Force)
        .then_some(Near { value: FORCE_ZERO.into(), tolerance: i64::from(FORCE_ZERO) / 4 })
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn every_input_of_the_cell_can_be_worked() {
        let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../data/field/station.toml"));
        let mapping = runtime::field::read(path).unwrap();
        let of = |name: &str| work(mapping.inputs.iter().find(|point| point.name == name).unwrap());
        assert_eq!(of("beam.1"), Work::Switch);
        assert_eq!(of("vise.PFIXTURE.clamped"), Work::Switch);
        assert_eq!(of("vise.PFIXTURE.program"), Work::Change);
        assert_eq!(of("resolver.base"), Work::Change);
        let Work::Range(stick) = of("joystick.x") else { panic!("a range") };
        assert!(stick.lowest.unwrap().contains(-950) && !stick.lowest.unwrap().contains(-850));
        let Work::Range(fingers) = of("pedestal.potentiometer") else { panic!("a range") };
        assert!(fingers.lowest.unwrap().contains(198) && !fingers.lowest.unwrap().contains(26));
        let rest = mapping.inputs.iter().find(|point| point.name == "force.z").map(at_rest).unwrap();
        assert!(rest.unwrap().contains(2000) && !rest.unwrap().contains(1024));
    }
}
