//! The coding of a position on the line.
//!
//! VI.1 says that the "12 bytes of world coordinates" of appendix A are those of the end plate, in Cartesian and Euler
//! form. ASSUMED (SPECNOTES): six signed words, X, Y, Z in 0.01 in and D, E, R in 0.01 degree, with
//!
//! ```text
//! rotation = Rz(D) Ry(E - 90) Rx(R)      D: azimuth of the gripper axis about world +Z
//!                                        E: angle of the gripper axis from world +Z: 0 up, 90 level, 180 down
//!                                        R: roll about the gripper axis
//! ```
//!
//! A vertical gripper is the pole of the angles, about which the manual warns. E is between 0 and 180 degrees. D and R
//! continue without jumps of 360 degrees. Before a word overflows it changes by 360, and both ends compare modulo 360.
//! At the pole D has no meaning and keeps its value.

use core::f64::consts::PI;

use geometry::{
    frame::{Frame, Rotation, Vector},
    kinematics::Arm,
    units::{hundredths, hundredths_of_degree, inches, radians},
};
use nalgebra::Rotation3;
use rcs_core::Plain;

use crate::Error;

const TURN: i32 = 36_000; // 0.01 degree
/// Half a turn, 0.01 degree; also the E of a gripper that points straight down.
pub const HALF_TURN: i32 = 18_000;

/// A position of the end plate on the line: X, Y, Z in 0.01 in, D, E, R in 0.01 degree (ASSUMED coding).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Plate {
    /// X, Y, Z, D, E, R.
    pub words: [i16; 6],
}

/// The shortest rotation between two angle words, modulo 360 degrees: -18000 to 17999, 0.01 degree.
#[must_use]
pub fn angle_between(from: i16, to: i16) -> i32 {
    shortest(i32::from(to).saturating_sub(i32::from(from)))
}

fn shortest(difference: i32) -> i32 {
    difference.saturating_add(HALF_TURN).rem_euclid(TURN).saturating_sub(HALF_TURN)
}

/// The word of `angle` (0.01 degree) nearest to `near`; if it is out of range, the word one full turn away.
#[must_use]
pub fn angle_word(angle: i32, near: i16) -> i16 {
    let near = i32::from(near);
    let word = near.saturating_add(shortest(angle.saturating_sub(near)));
    [word, word.saturating_sub(TURN), word.saturating_add(TURN)]
        .into_iter()
        .find_map(|word| i16::try_from(word).ok())
        .unwrap_or_default()
}

/// Rz(D) Ry(E - 90): the rotation without roll. 0.01 degree.
fn pointing(d: i32, e: i32) -> Rotation {
    Rotation3::from_axis_angle(&Vector::z_axis(), radians(d))
        * Rotation3::from_axis_angle(&Vector::y_axis(), radians(e) - PI / 2.0)
}

impl Plate {
    /// The words of an end-plate frame (inches, world), with D and R near those of `near`. Errors:
    /// [`Error::OutOfRange`] if X, Y or Z exceeds a word, [`Error::NotFinite`].
    pub fn from_frame(plate: &Frame, near: &Self) -> Result<Self, Error> {
        if !plate.is_finite() {
            return Err(Error::NotFinite);
        }
        let word = |axis: usize, inches: f64| {
            i16::try_from(hundredths(inches)).map_err(|_| Error::OutOfRange { axis, inches })
        };
        let [.., near_d, _, near_r] = near.words;
        let axis = plate.x();
        let across = libm::hypot(axis.x, axis.y);
        let e = hundredths_of_degree(libm::atan2(across, axis.z));
        let d = if e == 0 || e == HALF_TURN {
            near_d
        } else {
            angle_word(hundredths_of_degree(libm::atan2(axis.y, axis.x)), near_d)
        };
        // The roll is the rest after the rounded D and E, so their errors do not accumulate near the pole.
        let rolled_y = (pointing(i32::from(d), e).inverse() * plate.rotation) * Vector::y();
        let r = angle_word(hundredths_of_degree(libm::atan2(rolled_y.z, rolled_y.y)), near_r);
        let (x, y, z) = (word(0, plate.position.x)?, word(1, plate.position.y)?, word(2, plate.position.z)?);
        Ok(Self { words: [x, y, z, d, i16::try_from(e).unwrap_or_default(), r] })
    }

    /// The words of a tool frame, one tool length before the end plate of `arm`; see [`Plate::from_frame`].
    pub fn from_tool(tool: &Frame, arm: &Arm, near: &Self) -> Result<Self, Error> {
        Self::from_frame(&tool.shifted(Vector::new(-arm.plate_to_tool, 0.0, 0.0)), near)
    }

    /// The end-plate frame, inches, world.
    #[must_use]
    pub fn to_frame(&self) -> Frame {
        let [x, y, z, d, e, r] = self.words.map(i32::from);
        Frame {
            position: Vector::new(inches(x), inches(y), inches(z)),
            rotation: pointing(d, e) * Rotation3::from_axis_angle(&Vector::x_axis(), radians(r)),
        }
    }

    /// The tool frame, inches, world.
    #[must_use]
    pub fn to_tool(&self, arm: &Arm) -> Frame {
        self.to_frame().shifted(Vector::new(arm.plate_to_tool, 0.0, 0.0))
    }

    /// True if E is within 0 to 180 degrees, as in every position of this coding.
    #[must_use]
    pub fn is_canonical(&self) -> bool {
        let [.., e, _] = self.words;
        (0..=HALF_TURN).contains(&i32::from(e))
    }

    /// True if both are the same position on the line: equal words, with the angles modulo 360 degrees.
    #[must_use]
    pub fn same(&self, other: &Self) -> bool {
        let ([x, y, z, d, e, r], [ox, oy, oz, od, oe, or]) = (self.words, other.words);
        [x, y, z] == [ox, oy, oz]
            && [(d, od), (e, oe), (r, or)].iter().all(|(a, b)| angle_between(*a, *b) == 0)
    }

    /// True if each word is between those of `before` and `last`, within `counts`; angles modulo 360 degrees.
    #[must_use]
    pub fn is_between(&self, before: &Self, last: &Self, counts: i32) -> bool {
        let within = |way: i32, here: i32| {
            (way.min(0).saturating_sub(counts)..=way.max(0).saturating_add(counts)).contains(&here)
        };
        let by = |from: i16, to: i16| i32::from(to).saturating_sub(i32::from(from));
        let words = self.words.iter().zip(before.words.iter().zip(&last.words));
        words.enumerate().all(|(word, (here, (from, to)))| {
            let way: fn(i16, i16) -> i32 = if word < 3 { by } else { angle_between };
            within(way(*from, *to), way(*from, *here))
        })
    }

    /// The twelve bytes, each word high byte first.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; 12] {
        let mut bytes = [0; 12];
        for (pair, word) in bytes.chunks_exact_mut(2).zip(self.words) {
            pair.copy_from_slice(&word.to_be_bytes());
        }
        bytes
    }

    /// The position of twelve bytes; any twelve bytes are valid.
    #[must_use]
    pub fn from_bytes(bytes: &[u8; 12]) -> Self {
        let mut words = [0; 6];
        let (pairs, _) = bytes.as_chunks::<2>();
        for (word, pair) in words.iter_mut().zip(pairs) {
            *word = i16::from_be_bytes(*pair);
        }
        Self { words }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::{
        kinematics::T3,
        pose::{Pose, WireFrame},
    };
    use proptest::prelude::*;

    const HOME: WireFrame =
        WireFrame { tool: [0, -7145, -1483], wrist_to_tool: [0, -2123, -2119], tool_to_finger: [3000, 0, 0] };

    #[test]
    fn position_is_between_if_each_word_is() {
        let (before, last) = (plate([10, 0, 0, 17_990, 9000, 0]), plate([14, 0, 0, -17_990, 9000, 0]));
        for (words, between) in [
            ([10, 0, 0, 17_990, 9000, 0], true),
            ([12, 0, 0, 18_000, 9000, 0], true),
            ([8, 2, -2, 17_988, 9002, 36], false),
            ([8, 2, -2, 17_988, 9002, 2], true),
            ([16, 0, 0, -17_988, 8998, -2], true),
            ([7, 0, 0, 17_990, 9000, 0], false),
            ([17, 0, 0, 17_990, 9000, 0], false),
            ([10, 3, 0, 17_990, 9000, 0], false),
            ([10, 0, 0, -17_987, 9000, 0], false),
            ([10, 0, 0, 17_987, 9000, 0], false),
        ] {
            assert_eq!(plate(words).is_between(&before, &last, 2), between, "{words:?}");
            assert_eq!(plate(words).is_between(&last, &before, 2), between, "{words:?}");
        }
    }

    #[test]
    fn angles_are_between_across_half_a_turn_and_coordinates_are_not() {
        let (before, last) =
            (plate([-20_000, 0, 0, 0, 9000, 17_990]), plate([20_000, 0, 0, 0, 9000, -17_990]));
        assert!(plate([0, 0, 0, 0, 9000, 18_000]).is_between(&before, &last, 2));
        assert!(!plate([0, 0, 0, 0, 9000, 0]).is_between(&before, &last, 2));
        assert!(!plate([-21_000, 0, 0, 0, 9000, 18_000]).is_between(&before, &last, 2));
    }

    fn plate(words: [i16; 6]) -> Plate {
        Plate { words }
    }

    #[test]
    fn home_has_the_worked_words() {
        let home = Plate::from_tool(&HOME.to_frame().unwrap(), &T3, &Plate::default()).unwrap();
        assert_eq!(home, plate([0, -6296, -635, -9000, 13495, 0]));
        assert_eq!(home.to_bytes(), [0, 0, 0xE7, 0x68, 0xFD, 0x85, 0xDC, 0xD8, 0x34, 0xB7, 0, 0]);
        assert_eq!(Plate::from_bytes(&home.to_bytes()), home);
    }

    #[test]
    fn tool_trns_has_the_worked_angles() {
        let pose =
            Pose { wrist: [6497, -2366, 1569], tool: [9495, -2475, 1595], finger: [9523, -1460, -1228] };
        let [.., d, e, r] =
            Plate::from_tool(&pose.to_frame().unwrap(), &T3, &Plate::default()).unwrap().words;
        assert_eq!([d, e, r], [-208, 8950, -7022]);
    }

    #[test]
    fn angles_continue_and_step_back_at_the_end_of_the_word() {
        assert_eq!(angle_word(-17_900, 17_900), 18_100);
        assert_eq!(angle_word(17_900, -17_900), -18_100);
        assert_eq!(angle_word(-3_000, 32_700), -3_000);
        assert_eq!(angle_between(32_767, -3_233), 0);
        assert_eq!(angle_between(17_900, -17_900), 200);
    }

    #[test]
    fn wrong_sizes_are_refused() {
        let mut frame = Frame::identity();
        frame.position.y = 327.68;
        assert_eq!(
            Plate::from_frame(&frame, &Plate::default()),
            Err(Error::OutOfRange { axis: 1, inches: 327.68 })
        );
        frame.position.y = f64::NAN;
        assert_eq!(Plate::from_frame(&frame, &Plate::default()), Err(Error::NotFinite));
    }

    #[test]
    fn at_the_pole_d_stays_and_the_roll_follows() {
        let down = plate([100, 200, 300, 4000, 18_000, 1000]);
        assert_eq!(Plate::from_frame(&down.to_frame(), &down), Ok(down));
        let near = plate([0, 0, 0, 5000, 0, 0]); // straight down only R - D matters, straight up only R + D
        assert_eq!(
            Plate::from_frame(&down.to_frame(), &near).unwrap().words,
            [100, 200, 300, 5000, 18_000, 2000]
        );
        let up = plate([100, 200, 300, 4000, 0, 1000]);
        assert_eq!(Plate::from_frame(&up.to_frame(), &near).unwrap().words, [100, 200, 300, 5000, 0, 0]);
    }

    proptest! {
        #[test]
        fn words_survive_conversion_to_a_frame(words: [i16; 6], e in 0_i16..=18_000) {
            let mut here = plate(words);
            here.words[4] = e;
            prop_assert_eq!(Plate::from_frame(&here.to_frame(), &here), Ok(here));
            prop_assert!(here.is_canonical() && here.same(&here));
            prop_assert_eq!(Plate::from_bytes(&here.to_bytes()), here);
        }

        #[test]
        fn a_rounded_position_is_near(words: [i16; 6], near: [i16; 6], dx in -0.005_f64..0.005) {
            let mut frame = plate(words).to_frame();
            frame.position.x = (frame.position.x + dx).clamp(-327.0, 327.0);
            let back = Plate::from_frame(&frame, &plate(near)).unwrap();
            let off = back.to_frame().distance(&frame);
            prop_assert!(off.inches < 0.0051 && off.radians < 2.7e-4, "{:?}", off);
            prop_assert!(back.is_canonical());
        }
    }
}
