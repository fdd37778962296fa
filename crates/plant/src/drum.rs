//! The tool drum of the machine tool at its transfer position: the place of a tool, fingers, and a strike plate.
//!
//! The drum's frame is the tool frame of TOOL-TRNS: X into the drum. Near the end of the insertion, detents resist with
//! a rising force. In the inserted position they hold the tool with a smaller force. Closed fingers stop it with a
//! hundred pounds. The fingers hold a tool more strongly than the robot, whose hold slides first.
//!
//! Detents and obstacles are one spring along X whose far end slides at the limit of the force: a tool comes to rest,
//! and a force sensor reads a steady value.
//!
//! The strike plate is next to the tool. Its front stops the fingertips of an open gripper; its shoulders stop open
//! fingers that slide to the right (tool -Z) or arrive from there.

use geometry::frame::{Frame, Rotation, Vector};
use rapier3d_f64::math::Real;
use serde::{Deserialize, Serialize};

use crate::{
    cell::WorkstationError,
    convert::{metres, newtons},
    description::{Drum as Description, Kind},
    scene::Block,
};

const STIFFNESS: Real = 1.0e5; // stiffness of detents and obstacles, N/m
/// Damping of detents and obstacles, N·s/m: about critical for a tool of 6 lb.
const DAMPING: Real = 1.0e3;
const MAX_RADIUS: f64 = 2.0; // greatest distance from the axis at which a tool is in front of the drum, in

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entering {
    pub left: f64,
    pub aside: f64,
    pub angle: f64, // angle of its axis to the drum's, radians
}

impl Entering {
    pub(crate) fn not_in_place(self, tool: String) -> WorkstationError {
        let distance = libm::hypot(self.left, self.aside);
        WorkstationError::NotInPlace { tool, distance, degrees: self.angle.to_degrees() }
    }
}

#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub struct Pocketed {
    pub part: usize,
    anchor: Real, // position of the anchor of the spring along X, m
    barred: bool, // true if it arrived while the fingers were closed
    /// True if the drum fixes it: by its fingers, or by the detents alone.
    pub fast: bool,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct Drum {
    #[serde(with = "crate::image::frame")]
    frame: Frame,
    description: Description,
    closed: bool,
    pub tool: Option<Pocketed>,
}

impl Drum {
    /// An empty drum with open fingers; `frame` is that of the location, in.
    #[must_use]
    pub fn new(frame: Frame, description: &Description) -> Self {
        Self { frame, description: description.clone(), closed: false, tool: None }
    }

    #[must_use]
    pub fn location(&self) -> &str {
        &self.description.location
    }

    #[must_use]
    pub fn closed(&self) -> bool {
        self.closed
    }

    pub fn set_closed(&mut self, closed: bool) {
        self.closed = closed;
        if let Some(tool) = self.tool.as_mut().filter(|_| !closed) {
            tool.barred = false;
        }
    }

    /// Unit vector into the drum, world.
    #[must_use]
    pub fn axis(&self) -> Vector {
        self.frame.x()
    }

    /// Frame of a tool in its place, with the axes of the drum.
    #[must_use]
    pub fn seat(&self) -> Frame {
        self.frame.shifted(Vector::new(self.description.middle, 0.0, 0.0))
    }

    /// Frame of a tool in its place that keeps its present roll about its axis.
    #[must_use]
    pub fn place(&self, tool: &Frame) -> Frame {
        let here = self.frame.inverse().compose(tool).rotation;
        // The smallest rotation that aligns the tool's axis with the drum's.
        let upright = Rotation::rotation_between(&(here * Vector::x()), &Vector::x());
        let rotation = self.frame.rotation * upright.map_or(Rotation::identity(), |turn| turn * here);
        Frame { rotation, ..self.seat() }
    }

    /// Position of a tool relative to its place; `None` if it is not in front of the drum.
    #[must_use]
    pub fn entering(&self, tool: &Frame) -> Option<Entering> {
        let here = self.frame.inverse().compose(tool);
        let left = self.description.middle - here.position.x;
        let aside = libm::hypot(here.position.y, here.position.z);
        let angle = libm::acos(here.rotation.matrix()[(0, 0)].clamp(-1.0, 1.0));
        let before = left.abs() < self.description.finger_reach && aside < MAX_RADIUS;
        before.then_some(Entering { left, aside, angle })
    }

    pub fn admit(&mut self, part: usize, entering: &Entering) {
        self.tool = Some(Pocketed { part, anchor: metres(-entering.left), barred: self.closed, fast: false });
    }

    /// True if the fingers can close on a tool there, and centre it.
    #[must_use]
    pub fn can_grip(&self, entering: &Entering) -> bool {
        let Description { seated, seated_degrees, .. } = self.description;
        entering.left.abs() <= seated
            && entering.aside <= seated
            && entering.angle <= seated_degrees.to_radians()
    }

    #[must_use]
    pub fn grips(&self, pocketed: &Pocketed) -> bool {
        self.closed && !pocketed.barred
    }

    /// True if the detents keep a tool that nothing else holds.
    #[must_use]
    pub fn keeps(&self, pocketed: &Pocketed, entering: &Entering) -> bool {
        !pocketed.barred
            && entering.left <= self.description.detent_length
            && entering.aside <= self.description.seated
    }

    /// Greatest forces against insertion and against extraction, N.
    fn limits(&self, pocketed: &Pocketed, entering: &Entering) -> (Real, Real) {
        let Description { detent_length, insertion_force, extraction_force, stop_force, .. } =
            self.description;
        if pocketed.barred || entering.left <= 0.0 {
            return (newtons(stop_force), newtons(if pocketed.barred { 0.0 } else { extraction_force }));
        }
        let share = (1.0 - entering.left / detent_length).clamp(0.0, 1.0);
        (newtons(insertion_force * share), newtons(extraction_force * share))
    }

    /// Force along X, N, on a tool that the robot moves at `speed` m/s along X.
    pub fn resist(&mut self, entering: &Entering, speed: Real) -> Real {
        let Some(mut pocketed) = self.tool else { return 0.0 };
        let at = metres(-entering.left);
        let (inward, outward) = self.limits(&pocketed, entering);
        let spring = (STIFFNESS * (pocketed.anchor - at)).clamp(-inward, outward);
        pocketed.anchor = at + spring / STIFFNESS;
        self.tool = Some(pocketed);
        (spring - DAMPING * speed).clamp(-inward, outward)
    }

    /// Fix the tool in the drum, or release it. The spring along X then rests at the tool's position.
    pub fn lead(&mut self, fast: bool, entering: &Entering) {
        if let Some(pocketed) = &mut self.tool {
            pocketed.fast = fast;
            pocketed.anchor = metres(-entering.left);
        }
    }
}

#[must_use]
pub fn strike_plate(frame: &Frame, drum: &Description) -> Vec<Block> {
    let block = |plate: &crate::description::Plate| {
        let (low, high) = (Vector::from(plate.low), Vector::from(plate.high));
        let block = Block::between(&plate.name, Kind::Drum, low, high).moved(frame);
        Block { friction: Some(drum.friction), ..block }
    };
    drum.plate.iter().map(block).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::CellDescription;

    fn drum() -> Drum {
        let cell = CellDescription::from_toml(include_str!("../../../data/cell.toml")).unwrap();
        Drum::new(cell.drum.pose.frame().unwrap(), &cell.drum)
    }

    fn before(drum: &Drum, left: f64) -> Entering {
        let tool = drum.frame.shifted(Vector::new(drum.description.middle - left, 0.0, 0.0));
        drum.entering(&tool).unwrap()
    }

    /// Pushes a tool from `from` to `to` inches in front of its place and returns the force in pounds.
    fn push(drum: &mut Drum, from: f64, to: f64) -> f64 {
        let mut force = 0.0;
        for step in 0..=100 {
            let left = from + (to - from) * f64::from(step) / 100.0;
            force = drum.resist(&before(drum, left), 0.0);
        }
        force / newtons(1.0)
    }

    #[test]
    fn detents_resist_insertion_more_than_removal() {
        let mut drum = drum();
        drum.admit(0, &before(&drum, 1.0));
        assert_eq!(push(&mut drum, 1.0, 0.35), 0.0);
        assert!((push(&mut drum, 0.35, 0.15) + 15.0).abs() < 0.5);
        let full = push(&mut drum, 0.15, 0.001);
        assert!((full + 30.0).abs() < 1.0, "{full}");
        assert!((push(&mut drum, 0.001, 0.10) - 10.0).abs() < 1e-6, "out it goes more lightly");
        assert!((push(&mut drum, 0.10, 0.29) - 0.5).abs() < 1e-6);
    }

    #[test]
    fn tool_is_stopped_at_its_place_and_by_closed_fingers() {
        let mut drum = drum();
        drum.admit(0, &before(&drum, 1.0));
        assert!((push(&mut drum, 1.0, -0.2) + 100.0).abs() < 1e-6, "the bottom");
        drum.set_closed(true);
        drum.admit(0, &before(&drum, 1.3));
        let stopped = push(&mut drum, 1.3, 1.1);
        assert!((stopped + 100.0).abs() < 1e-6, "closed fingers: {stopped}");
        assert!(!drum.grips(&drum.tool.unwrap()));
    }

    #[test]
    fn tool_is_centred_without_a_change_of_roll() {
        let drum = drum();
        let turn = geometry::frame::rotation_by(&Vector::new(0.7, 0.0, 0.0));
        let tool = drum.place(&drum.frame.turned(&turn));
        let rolled = drum.frame.inverse().compose(&tool);
        assert!((rolled.position.x - drum.description.middle).abs() < 1e-12);
        assert!((rolled.rotation.matrix() - turn.matrix()).norm() < 1e-9);
        let entering = drum.entering(&tool).unwrap();
        assert!(drum.can_grip(&entering) && entering.left.abs() < 1e-9);
    }
}
