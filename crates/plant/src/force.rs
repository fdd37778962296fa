//! The force sensor of the tool gripper (III.3.8): the force of the springs between hand and fingers, the weight of its
//! own load, an offset of the bridges, and noise. CAL-SENSOR must determine the reading without contact (V.1.1). Only
//! four of the six axes are connected.

use geometry::frame::Vector;
use interfaces::device::{FORCE_COUNTS_PER_LB, FORCE_ZERO, ForceSensor, MOMENT_COUNTS_PER_IN_LB};

use crate::{description::ForceGages, noise::Noise, sensor::Analog};

/// A force and a moment about the tool point, in the axes of the tool: lb and in·lb.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    pub force: Vector,  // lb
    pub moment: Vector, // moment about the tool point, right-hand, in·lb
}

impl Wrench {
    /// A force at a point of the tool frame (in), and an additional moment.
    #[must_use]
    pub fn at(point: &Vector, force: Vector, moment: Vector) -> Self {
        Self { force, moment: moment + point.cross(&force) }
    }

    #[must_use]
    pub fn and(&self, other: &Self) -> Self {
        Self { force: self.force + other.force, moment: self.moment + other.moment }
    }

    #[must_use]
    pub fn about(&self, point: &Vector) -> Vector {
        self.moment - point.cross(&self.force)
    }
}

/// Reading of the sensor under a load on the fingers; `down` is the direction of gravity in the axes of the tool.
pub fn read(gages: &ForceGages, load: &Wrench, down: &Vector, noise: &mut Noise) -> ForceSensor {
    let middle = Vector::new(-gages.behind_tool, 0.0, 0.0);
    let weight = down * gages.weight;
    let all = load.and(&Wrench::at(&Vector::new(-gages.weight_at, 0.0, 0.0), weight, Vector::zeros()));
    let mut counts = |value: f64, per_unit: i32, offset: f64| {
        let offset = f64::from(FORCE_ZERO) + offset;
        Analog { offset, scale: f64::from(per_unit), noise: gages.noise }.counts(value, noise)
    };
    // Tool X, Y, Z are sensor Z, -Y, X.
    let [x, y, z, moment] = gages.offsets;
    ForceSensor {
        x: counts(all.force.z, FORCE_COUNTS_PER_LB, x),
        y: counts(-all.force.y, FORCE_COUNTS_PER_LB, y),
        z: counts(all.force.x, FORCE_COUNTS_PER_LB, z),
        moment: counts(all.about(&middle).y, MOMENT_COUNTS_PER_IN_LB, moment),
        valid: true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::Stream;

    const GAGES: ForceGages = ForceGages {
        behind_tool: 8.0,
        weight: 20.0,
        weight_at: 4.0,
        offsets: [10.0, 20.0, 30.0, 40.0],
        noise: 0.0,
    };

    fn reading(load: &Wrench, down: Vector) -> [i32; 4] {
        let sensor = read(&GAGES, load, &down, &mut Noise::new(1, Stream::Force));
        [sensor.x, sensor.y, sensor.z, sensor.moment].map(i32::from)
    }

    #[test]
    fn measured_weight_turns_with_the_robot() {
        assert_eq!(reading(&Wrench::default(), Vector::x()), [2058, 2068, 2078 + 320, 2088], "pointing down");
        // With the tool level, 20 lb act along tool -Z at 4 in from the sensor, a moment about +Y.
        assert_eq!(reading(&Wrench::default(), -Vector::z()), [2058 - 320, 2068, 2078, 2088 + 320]);
    }

    #[test]
    fn push_on_the_fingers_has_its_axis_and_lever() {
        let free = reading(&Wrench::default(), Vector::x());
        let push = |point: [f64; 3], force: [f64; 3]| {
            let load = Wrench::at(&Vector::from(point), Vector::from(force), Vector::zeros());
            let read = reading(&load, Vector::x());
            [0, 1, 2, 3].map(|axis: usize| read[axis] - free[axis])
        };
        assert_eq!(push([0.0, 0.0, 0.0], [-10.0, 0.0, 0.0]), [0, 0, -160, 0]);
        assert_eq!(push([0.0, 0.0, 0.0], [0.0, 5.0, 0.0]), [0, -80, 0, 0]);
        assert_eq!(push([0.0, 0.0, 0.0], [0.0, 0.0, 10.0]), [160, 0, 0, -320], "8 in of lever");
    }

    #[test]
    fn force_sensor_saturates_beyond_its_range() {
        let load = Wrench::at(&Vector::zeros(), Vector::new(-500.0, 0.0, 500.0), Vector::zeros());
        assert_eq!(reading(&load, Vector::x()), [4095, 2068, 0, 0]);
    }
}
