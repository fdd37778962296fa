//! The programmable vise: a fixed jaw, a movable jaw, and the clamped part.
//!
//! Both jaws have steps, one for each family of parts; a program is a step with its openings. Openings are measured
//! between the clamping faces of that step, as for the operator; internally the jaw position is the distance of the
//! inner faces. A part stops the jaw in any step.
//!
//! The jaw moves at its speed. It pushes a part along, flush with its face, and stops when the part touches the fixed
//! face. From then on, closing force and friction hold the part. The gripper cannot resist: 500 lb against at most
//! twice the finger force. The jaws push aside a part that is still in the fingers.

use geometry::frame::{Frame, Vector as Inches};
use rapier3d_f64::prelude::*;
use serde::{Deserialize, Serialize};

use crate::{
    convert::{inches, metres, newtons, to_pose},
    description::{Vise as Description, ViseProgram},
    scene::{jaw_blocks, vise_frame},
    squeeze::Pads,
};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Jaws {
    Open,
    Partial, // partially closed, wide enough for a blank to enter
    Closed,  // closed, on a part if there is one
}

impl Jaws {
    /// Distance of the inner faces of the jaws in a program, in.
    #[must_use]
    pub fn gap(self, program: &ViseProgram) -> f64 {
        match self {
            Self::Open => program.opening_open - 2.0 * program.depth,
            Self::Partial => program.opening_partial - 2.0 * program.depth,
            // The inner faces of the jaws touch.
            Self::Closed => 0.0,
        }
    }
}

impl ViseProgram {
    /// Position of the middle of a part of the given size (in, along the axes of the vise: X in, Y left, Z up) that is
    /// seated in the step: on the ledge, at the back, against the fixed face. Vise frame, in.
    #[must_use]
    pub fn seat(&self, size: &Inches) -> Inches {
        Inches::new(self.back - size.x / 2.0, -self.depth + size.y / 2.0, self.ledge + size.z / 2.0)
    }
}

#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct Vise {
    description: Description,
    #[serde(with = "crate::image::frame")]
    frame: Frame,
    program: usize,
    gap: f64, // distance of the inner faces of the jaws, in
    target: f64,
    jaw: RigidBodyHandle,
    stopped: bool,
    pub clamped: Option<Clamped>,
}

/// A part between the jaws. Only a collision is stronger than the vise, so the part moves with the jaws.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub struct Clamped {
    pub part: usize,
    pub step: usize, // the step in which it is clamped
    pub rest: Pose,  // its pose in the frame of the vise, m
}

impl Vise {
    /// Build the movable jaw at the open position of the first program.
    pub fn new(world: &mut PhysicsWorld, description: &Description) -> Self {
        let frame = vise_frame(description);
        let jaw = world.insert_body(RigidBodyBuilder::kinematic_position_based());
        for block in jaw_blocks(description) {
            world.insert_collider(block.collider().friction(description.friction), Some(jaw));
        }
        let mut vise = Self {
            description: description.clone(),
            frame,
            program: 0,
            gap: 0.0,
            target: 0.0,
            jaw,
            stopped: false,
            clamped: None,
        };
        vise.command(Jaws::Open);
        vise.gap = vise.target;
        world.bodies[jaw].set_position(vise.jaw_pose(), false);
        vise
    }

    /// The frame of the vise, in.
    #[must_use]
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    #[must_use]
    pub fn jaw(&self) -> RigidBodyHandle {
        self.jaw
    }

    fn step(&self, step: usize) -> &ViseProgram {
        &self.description.program[step]
    }

    #[must_use]
    pub fn steps(&self) -> core::ops::Range<usize> {
        0..self.description.program.len()
    }

    pub fn select(&mut self, name: &str) {
        let program = self.description.program.iter().position(|program| program.name == name);
        self.program = program.unwrap_or(self.program);
    }

    /// Distance of the clamping faces of the selected program, in.
    #[must_use]
    pub fn opening(&self) -> f64 {
        self.gap + 2.0 * self.step(self.program).depth
    }

    /// Distance of the inner faces of the jaws, in.
    #[must_use]
    pub fn gap(&self) -> f64 {
        self.gap
    }

    /// Distance of the inner faces at which a part of a width (m) stops them in a step, in.
    #[must_use]
    pub fn stop(&self, step: usize, width: Real) -> f64 {
        inches(width) - 2.0 * self.step(step).depth
    }

    #[must_use]
    pub fn location(&self) -> &str {
        &self.description.location
    }

    #[must_use]
    pub fn moving(&self) -> bool {
        !self.stopped && (self.gap - self.target).abs() > 1e-9
    }

    /// The opening of the selected program at which the jaw rests, or closed jaws on a part. `None` while it moves, at
    /// the opening of another program, and where a part stops jaws that are not closing.
    #[must_use]
    pub fn resting(&self) -> Option<Jaws> {
        let program = self.step(self.program);
        let is_at = |gap: f64, jaws: Jaws| (gap - jaws.gap(program)).abs() < 1e-6;
        if self.moving() {
            return None;
        }
        if self.stopped {
            return Some(Jaws::Closed).filter(|jaws| is_at(self.target, *jaws));
        }
        [Jaws::Open, Jaws::Partial, Jaws::Closed].into_iter().find(|jaws| is_at(self.gap, *jaws))
    }

    #[must_use]
    pub fn program(&self) -> &str {
        &self.step(self.program).name
    }

    #[must_use]
    pub fn stopped(&self) -> bool {
        self.stopped
    }

    #[must_use]
    pub fn closing(&self) -> bool {
        self.moving() && self.target < self.gap
    }

    /// Command an opening of the selected program. Before a wider opening the caller must release the clamped part.
    pub fn command(&mut self, jaws: Jaws) {
        self.target = jaws.gap(self.step(self.program));
        self.stopped &= self.target < self.gap;
    }

    /// True if the command would move the jaw away from the fixed jaw.
    #[must_use]
    pub fn opening_commanded(&self) -> bool {
        self.target > self.gap
    }

    /// Move the jaw for `dt` seconds; `stop` is the distance of the inner faces at which a part stops it, in.
    pub fn advance(&mut self, world: &mut PhysicsWorld, dt: f64, stop: Option<f64>) {
        let way = self.description.speed * dt;
        let wanted = self.gap + (self.target - self.gap).clamp(-way, way);
        self.gap = match stop {
            Some(stop) if wanted <= stop && self.target < stop => {
                self.stopped = true;
                stop.min(self.gap)
            }
            _ => wanted,
        };
        world.bodies[self.jaw].set_next_kinematic_position(self.jaw_pose());
    }

    /// Close the jaw at once after machining has made a clamped part smaller.
    pub fn follow(&mut self, world: &mut PhysicsWorld, gap: f64) {
        self.gap = gap.min(self.gap);
        world.bodies[self.jaw].set_position(self.jaw_pose(), true);
    }

    fn jaw_pose(&self) -> Pose {
        to_pose(&self.frame.shifted(Inches::new(0.0, self.gap, 0.0)))
    }

    /// The clamping faces of a step as pads; see [`Vise::fixed_face`] for the position of the fixed one. Deeper steps
    /// cut pieces out of them. Of the two areas that remain next to and below each piece, the larger is used.
    #[must_use]
    pub fn pads(&self, step: usize) -> Pads {
        let step = self.step(step);
        let (mut x, mut z) = ([0.0, step.back], [step.ledge, 0.0]);
        for cut in self.description.program.iter().filter(|cut| cut.depth > step.depth) {
            let beside = [cut.back.clamp(x[0], x[1]), x[1]];
            let below = [z[0], cut.ledge.clamp(z[0], z[1])];
            if (beside[1] - beside[0]) * (z[1] - z[0]) >= (x[1] - x[0]) * (below[1] - below[0]) {
                x = beside;
            } else {
                z = below;
            }
        }
        Pads { x: x.map(metres), z: z.map(metres), groove: None }
    }

    /// Depth of the clamping face of a step behind the inner face, in.
    #[must_use]
    pub fn depth(&self, step: usize) -> f64 {
        self.step(step).depth
    }

    /// Y of the fixed clamping face of a step in the frame of the vise, m.
    #[must_use]
    pub fn fixed_face(&self, step: usize) -> Real {
        -metres(self.step(step).depth)
    }

    /// Y of the movable clamping face of a step in the frame of the vise, m.
    #[must_use]
    pub fn movable_face(&self, step: usize) -> Real {
        metres(self.gap + self.step(step).depth)
    }

    /// The force along the faces that pulls a part out of the closed jaws, N.
    #[must_use]
    pub fn friction_limit(&self) -> Real {
        2.0 * newtons(self.description.force) * self.description.friction
    }

    /// Position of the middle of a part that is seated in a step: see [`ViseProgram::seat`].
    #[must_use]
    pub fn seat(&self, step: usize, size: &Inches) -> Inches {
        self.step(step).seat(size)
    }

    /// The step for a part that is not clamped: the step of the selected program.
    #[must_use]
    pub fn present_step(&self) -> usize {
        self.clamped.map_or(self.program, |clamped| clamped.step)
    }

    /// True if a part whose middle is at a point (vise frame, in) is in the vise.
    #[must_use]
    pub fn contains(&self, point: &Inches) -> bool {
        let [into, _, height] = self.description.jaw;
        let deepest = self.description.program.iter().map(|program| program.depth).fold(0.0, f64::max);
        (-1.0..into).contains(&point.x)
            && (-deepest..self.gap + deepest).contains(&point.y)
            && (-height..height).contains(&point.z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CellDescription;

    #[test]
    fn deeper_step_leaves_the_material_around_and_below_it() {
        let mut cell = CellDescription::from_toml(include_str!("../../../data/cell.toml")).unwrap();
        let step =
            |name: &str| cell.vise.program.iter().find(|program| program.name == name).unwrap().clone();
        let deeper = ViseProgram { back: 0.87, depth: 0.2625, ledge: -0.6, ..step("CLEVIS") };
        cell.vise.program.push(deeper);
        let mut world = PhysicsWorld::new();
        let vise = Vise::new(&mut world, &cell.vise);
        let faces = |step: usize| (vise.pads(step).x.map(inches), vise.pads(step).z.map(inches));
        let is = |(x, z): ([f64; 2], [f64; 2]), expected: [f64; 4]| {
            let found = [x[0], x[1], z[0], z[1]];
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?} {expected:?}");
        };
        // The linkbar's face is cut from above; both other steps cut that of the clevis from the front.
        is(faces(0), [0.0, 0.41, -3.25, -0.6]);
        is(faces(1), [0.87, 1.6, -1.0, 0.0]);
        is(faces(2), [0.0, 0.87, -0.6, 0.0]);
    }
}
