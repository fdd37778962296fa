//! Holsters: a gripper that is not on the robot hangs in one by its ears.
//!
//! A released gripper drops until its ears lie on the cheeks. It then slides forward (tool +Z) to the seat, where lips
//! prevent lifting and a detent keeps it. Four proximity sensors detect the ears (III.3.4).
//!
//! Coordinates are in the frame of the holster: the tool frame of a gripper that rests on it and has not slid forward,
//! X down. All grippers have the same ears, so any of them fits.

use geometry::frame::{Frame, Rotation, Vector, rotation_vector};
use serde::{Deserialize, Serialize};

use crate::{
    description::{CellDescription, Gripper, Holsters, Kind, Points},
    scene::Block,
};

const GRAVITY: f64 = 386.1;
const UNDER_PLATE: f64 = 1.0; // distance of the ears under the B plate, in
const GAP: f64 = 0.25; // gap between the body of a gripper and the cheeks, and between ears and lips, in
const THICK: f64 = 1.0; // thickness of cheeks and lips, in
/// Distance of a lip behind the front end of the ears in the seat, in.
const LIP: f64 = 0.75;
/// Greatest tilt of a released gripper that still lands on the cheeks, radians (3 degrees).
const ASKEW: f64 = 0.052_36;
const PRESSED: f64 = 0.10; // greatest depth under its rest to which the robot can press a gripper, in
const NEAR: f64 = 6.0; // greatest distance from the rest of a gripper at this holster, in
const LIP_PLAY: f64 = 0.15; // travel of a gripper under the lips before they stop it, in

#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct Holster {
    name: String,
    #[serde(with = "crate::image::frame")]
    frame: Frame,
    description: Holsters,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Offset {
    pub up: f64,
    pub aside: f64,
    pub forward: f64,
    pub angle: f64, // radians
}

#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub struct HolsterSeat {
    pub up: f64,
    pub speed: f64, // in/s
    pub forward: f64,
}

impl HolsterSeat {
    /// Fall for `dt` seconds, as far as there is room.
    pub fn fall(&mut self, dt: f64) {
        self.speed += GRAVITY * dt;
        self.up -= self.speed * dt;
        if self.up <= 0.0 {
            (self.up, self.speed) = (0.0, 0.0);
        }
    }

    #[must_use]
    pub fn rests(&self) -> bool {
        self.up <= 0.0
    }
}

impl Holster {
    /// A holster at the tool frame of a gripper that rests on it.
    #[must_use]
    pub fn new(name: &str, frame: Frame, description: &Holsters) -> Self {
        Self { name: name.into(), frame, description: description.clone() }
    }

    #[must_use]
    pub fn is_near(&self, gripper: &Frame) -> bool {
        (gripper.position - self.frame.position).norm() < NEAR
    }

    #[must_use]
    pub fn offset(&self, gripper: &Frame) -> Offset {
        let here = self.frame.inverse().compose(gripper);
        Offset {
            up: -here.position.x,
            aside: here.position.y,
            forward: here.position.z,
            angle: rotation_vector(&here.rotation).norm(),
        }
    }

    #[must_use]
    pub fn gripper(&self, perch: &HolsterSeat) -> Frame {
        self.frame.shifted(Vector::new(-perch.up, 0.0, perch.forward))
    }

    #[must_use]
    pub fn seated(&self) -> HolsterSeat {
        HolsterSeat { up: 0.0, speed: 0.0, forward: self.description.seat }
    }

    /// Landing place of a released gripper; `None` if it misses the cheeks.
    #[must_use]
    pub fn catch(&self, offset: &Offset) -> Option<HolsterSeat> {
        let Holsters { catch_height, catch_aside, seat, .. } = self.description;
        let over = (-PRESSED..=catch_height).contains(&offset.up)
            && offset.aside.abs() <= catch_aside
            && (-catch_aside..=seat + catch_aside).contains(&offset.forward)
            && offset.angle <= ASKEW;
        over.then(|| HolsterSeat { up: offset.up.max(0.0), speed: 0.0, forward: self.slide(offset.forward) })
    }

    /// Position of a gripper that is moved to `forward`: at most at the seat, and drawn to it within the detent.
    #[must_use]
    pub fn slide(&self, forward: f64) -> f64 {
        let Holsters { seat, detent, .. } = self.description;
        if forward >= seat - detent { seat } else { forward }
    }

    /// True if the lips are over the ears of a gripper there.
    fn under_lips(&self, offset: &Offset) -> bool {
        let beside = self.description.ears[1] + self.description.catch_aside;
        (self.description.seat - LIP..=self.description.seat + LIP).contains(&offset.forward)
            && offset.aside.abs() <= beside
    }

    #[must_use]
    pub fn holds_down(&self, offset: &Offset) -> bool {
        self.under_lips(offset) && offset.up.abs() <= LIP_PLAY
    }

    /// True if a gripper that was held down is being lifted off the ring.
    #[must_use]
    pub fn tears(&self, offset: &Offset) -> bool {
        self.under_lips(offset) && offset.up > LIP_PLAY
    }

    /// Distance of the ears of a gripper beyond the ranges of the four sensors (bits of
    /// [`interfaces::device::HolsterSensors`]), in; negative within range.
    #[must_use]
    pub fn beyond(&self, gripper: &Frame, ears: &[Frame; 2]) -> [f64; 4] {
        let Holsters { large_range, small_range, seat, .. } = self.description;
        let here = self.frame.inverse();
        let [left, right] = ears.map(|ear| {
            let rest = Vector::new(ear.position.x, ear.position.y, 0.0);
            let away = here.compose(&gripper.compose(&ear)).position - rest;
            let most = |axes: [f64; 3]| axes.into_iter().fold(f64::NEG_INFINITY, f64::max);
            let along = (-away.z).max(away.z - seat);
            let large = most([away.x.abs(), away.y.abs(), along]) - large_range;
            let small = most([away.x.abs(), away.y.abs() / 2.0, (away.z - seat).abs()]) - small_range;
            [large, small]
        });
        [left[0], right[0], left[1], right[1]]
    }

    /// Blocks of cheeks, lips and foot, world.
    #[must_use]
    pub fn blocks(&self, gripper: &Gripper) -> Vec<Block> {
        let [thick, wide, long] = self.description.ears;
        let [plate, body] = [gripper.plate(), gripper.body[1] / 2.0];
        let rest = -plate + UNDER_PLATE + thick;
        let (inner, outer) = (body + GAP, body + GAP + THICK.max(wide));
        let (back, front) = (-long / 2.0 - GAP, self.description.seat + long / 2.0 + GAP);
        let lip = self.description.seat + long / 2.0 - LIP;
        let mut blocks = Vec::with_capacity(5);
        for (side, sign) in [("left", 1.0), ("right", -1.0)] {
            let mut part = |what: &str, x: [f64; 2], z: [f64; 2]| {
                let name = format!("{}_{side}_{what}", self.name);
                let (low, high) =
                    (Vector::new(x[0], sign * inner, z[0]), Vector::new(x[1], sign * outer, z[1]));
                blocks.push(self.block(&name, low, high));
            };
            part("cheek", [rest, 1.0], [back, front]);
            part("lip", [rest - thick - GAP - THICK / 2.0, rest - thick - GAP], [lip, front]);
        }
        let foot = format!("{}_foot", self.name);
        blocks.push(self.block(
            &foot,
            Vector::new(1.0, -outer, back),
            Vector::new(1.0 + THICK, outer, front),
        ));
        blocks
    }

    fn block(&self, name: &str, low: Vector, high: Vector) -> Block {
        Block::between(name, Kind::Holster, low, high).moved(&self.frame)
    }
}

/// The holsters: right, left, centre. The description has been validated: its points span frames.
#[must_use]
pub fn holsters(cell: &CellDescription) -> [Holster; 3] {
    let Holsters { right, left, centre, .. } = &cell.holsters;
    let holster = |name, points: &Points| {
        Holster::new(name, points.frame().unwrap_or_else(Frame::identity), &cell.holsters)
    };
    [holster("holster_right", right), holster("holster_left", left), holster("holster_centre", centre)]
}

/// Frames of the middles of the left and the right ear in a gripper's tool frame, in.
#[must_use]
pub fn ears(holsters: &Holsters, gripper: &Gripper) -> [Frame; 2] {
    let [thick, wide, _] = holsters.ears;
    [1.0, -1.0].map(|side| Frame {
        position: Vector::new(
            -gripper.plate() + UNDER_PLATE + thick / 2.0,
            side * (gripper.body[1] + wide) / 2.0,
            0.0,
        ),
        rotation: Rotation::identity(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::CellDescription;
    use geometry::frame::rotation_by;

    fn cell() -> CellDescription {
        CellDescription::from_toml(include_str!("../../../data/cell.toml")).unwrap()
    }

    fn holster() -> Holster {
        let cell = cell();
        Holster::new("holster_right", cell.holsters.right.frame().unwrap(), &cell.holsters)
    }

    fn seen(up: f64, forward: f64) -> u8 {
        let cell = cell();
        let holster = holster();
        let gripper = holster.gripper(&HolsterSeat { up, speed: 0.0, forward });
        let beyond = holster.beyond(&gripper, &ears(&cell.holsters, &cell.gripper.parts));
        beyond.iter().enumerate().fold(0, |bits, (bit, beyond)| bits | u8::from(*beyond <= 0.0) << bit)
    }

    #[test]
    fn large_sensors_detect_the_height_and_small_ones_the_seat() {
        assert_eq!(seen(0.55, 0.0), 0);
        assert_eq!(seen(0.45, 0.0), 0b0011);
        assert_eq!(seen(0.0, 0.0), 0b0011);
        assert_eq!(seen(0.0, 1.38), 0b0011);
        assert_eq!(seen(0.0, 1.45), 0b1111);
        assert_eq!(seen(0.2, 1.5), 0b0011);
    }

    #[test]
    fn gripper_lands_on_the_cheeks_or_misses_them() {
        let holster = holster();
        let at = |up: f64, aside: f64, roll: f64| {
            let gripper = holster
                .gripper(&HolsterSeat { up, speed: 0.0, forward: 0.1 })
                .shifted(Vector::new(0.0, aside, 0.0))
                .turned(&rotation_by(&Vector::new(roll, 0.0, 0.0)));
            holster.catch(&holster.offset(&gripper))
        };
        let landed = at(0.4, 0.1, 0.01).unwrap();
        assert!((landed.up - 0.4).abs() < 1e-9 && (landed.forward - 0.1).abs() < 1e-9);
        assert_eq!(at(0.7, 0.0, 0.0), None, "too high");
        assert_eq!(at(0.4, 0.6, 0.0), None, "beside it");
        assert_eq!(at(0.4, 0.0, 0.1), None, "askew");
        let mut dropping = landed;
        for _ in 0..24 {
            dropping.fall(0.0025);
        }
        assert!(dropping.rests(), "0.4 in in 60 ms: {dropping:?}");
    }

    #[test]
    fn detent_draws_to_the_seat_and_lips_hold_down() {
        let holster = holster();
        assert_eq!([holster.slide(1.30), holster.slide(1.42), holster.slide(1.7)], [1.30, 1.5, 1.5]);
        let held = |up, forward| {
            let offset = Offset { up, aside: 0.0, forward, angle: 0.0 };
            (holster.holds_down(&offset), holster.tears(&offset))
        };
        assert_eq!(held(0.0, 1.5), (true, false));
        assert_eq!(held(0.2, 1.5), (false, true));
        assert_eq!(held(0.2, 0.0), (false, false), "slid back it is free");
    }

    #[test]
    fn gripper_in_its_holster_touches_only_its_supports() {
        let cell = cell();
        let holster = holster();
        let [thick, ..] = cell.holsters.ears;
        let blocks = holster.blocks(&cell.gripper.parts);
        let cheek = blocks.iter().find(|block| block.name.ends_with("left_cheek")).unwrap();
        let here = holster.frame.inverse().compose(&cheek.frame);
        let [ear, _] = ears(&cell.holsters, &cell.gripper.parts);
        let top = here.position.x - cheek.size.x / 2.0;
        assert!((ear.position.x + thick / 2.0 - top).abs() < 1e-9, "ears lie on the cheek");
        assert!(here.position.y - cheek.size.y / 2.0 > cell.gripper.parts.body[1] / 2.0);
    }
}
