//! The programmable vise: a fixed jaw, a movable jaw, and what is clamped between them.
//!
//! The jaw moves at its speed to an opening. When it reaches a part on its way it takes the part along, flush with its
//! face, and is stopped when the part lies against the fixed face; from then on the closing force and friction hold it. The
//! gripper does not resist that: 500 lb against at most twice the finger force. A part that is still between the fingers is
//! pushed aside in them.

use rapier3d_f64::prelude::*;
use rcs_core::frame::{Frame, Vector as Inches};

use crate::{
    convert::{metres, newtons, to_pose},
    description::Vise as Description,
    scene::{jaw_blocks, vise_frame},
    squeeze::Pads,
};

/// Openings that the workstation commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Jaws {
    /// Open.
    Open,
    /// Partially closed: wide enough to let a blank in.
    Partial,
    /// Closed on what is there.
    Closed,
}

/// The vise.
#[derive(Debug)]
pub struct Vise {
    description: Description,
    frame: Frame,
    opening: f64,
    target: f64,
    jaw: RigidBodyHandle,
    stopped: bool,
    /// What the jaws have.
    pub clamped: Option<Clamped>,
}

/// A part between the jaws: nothing in the cell but a crash is stronger than the vise, so it is led and does not give way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clamped {
    /// Index of the part.
    pub part: usize,
    /// Where it is in the frame of the vise, m.
    pub rest: Pose,
}

impl Vise {
    /// Build the movable jaw, open; `base` is the body that the rest of the vise belongs to.
    pub fn new(world: &mut PhysicsWorld, description: &Description) -> Self {
        let frame = vise_frame(description);
        let opening = description.opening_open;
        let pose = to_pose(&jaw_frame(description, &frame, opening));
        let jaw = world.insert_body(RigidBodyBuilder::kinematic_position_based().pose(pose));
        for block in jaw_blocks(description) {
            world.insert_collider(block.collider().friction(description.friction), Some(jaw));
        }
        Self {
            description: description.clone(),
            frame,
            opening,
            target: opening,
            jaw,
            stopped: false,
            clamped: None,
        }
    }

    /// The frame of the vise, in.
    #[must_use]
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// The movable jaw.
    #[must_use]
    pub fn jaw(&self) -> RigidBodyHandle {
        self.jaw
    }

    /// Distance of the clamping faces, in.
    #[must_use]
    pub fn opening(&self) -> f64 {
        self.opening
    }

    /// Name of its location.
    #[must_use]
    pub fn location(&self) -> &str {
        &self.description.location
    }

    /// True while the jaw is on its way.
    #[must_use]
    pub fn moving(&self) -> bool {
        !self.stopped && (self.opening - self.target).abs() > 1e-9
    }

    /// True if a part stops the jaw.
    #[must_use]
    pub fn stopped(&self) -> bool {
        self.stopped
    }

    /// True while the jaw is on its way to the fixed jaw.
    #[must_use]
    pub fn closing(&self) -> bool {
        self.moving() && self.target < self.opening
    }

    /// Command an opening. Who commands one that is wider must first let go of what is clamped.
    pub fn command(&mut self, jaws: Jaws) {
        self.target = match jaws {
            Jaws::Open => self.description.opening_open,
            Jaws::Partial => self.description.opening_partial,
            // The inner faces of the jaws meet.
            Jaws::Closed => 2.0 * self.description.notch_depth,
        };
        self.stopped &= self.target < self.opening;
    }

    /// True if the jaw would move away from the fixed jaw.
    #[must_use]
    pub fn opening_commanded(&self) -> bool {
        self.target > self.opening
    }

    /// Move the jaw for `dt` seconds; `stop` is the opening at which a part between the faces stops it.
    pub fn advance(&mut self, world: &mut PhysicsWorld, dt: f64, stop: Option<f64>) {
        let way = self.description.speed * dt;
        let wanted = self.opening + (self.target - self.opening).clamp(-way, way);
        self.opening = match stop {
            Some(stop) if wanted <= stop && self.target < stop => {
                self.stopped = true;
                stop.min(self.opening)
            }
            _ => wanted,
        };
        let pose = to_pose(&jaw_frame(&self.description, &self.frame, self.opening));
        world.bodies[self.jaw].set_next_kinematic_position(pose);
    }

    /// Close the jaw at once by what machining has taken off a clamped part.
    pub fn follow(&mut self, world: &mut PhysicsWorld, opening: f64) {
        self.opening = opening.min(self.opening);
        let pose = to_pose(&jaw_frame(&self.description, &self.frame, self.opening));
        world.bodies[self.jaw].set_position(pose, true);
    }

    /// The clamping faces as pads; see [`Vise::fixed_face`] for where the fixed one is.
    #[must_use]
    pub fn pads(&self) -> Pads {
        Pads { x: [0.0, metres(self.description.notch_back)], z: [-metres(self.description.jaw[2]), 0.0] }
    }

    /// Y of the fixed clamping face in the frame of the vise, m.
    #[must_use]
    pub fn fixed_face(&self) -> Real {
        -metres(self.description.notch_depth)
    }

    /// The force along the faces that draws a part out of the closed jaws, N.
    #[must_use]
    pub fn friction_limit(&self) -> Real {
        2.0 * newtons(self.description.force) * self.description.friction
    }

    /// Where the middle of a part of the given size (in, part frame axes parallel to the vise: X in, Y left, Z up) is when
    /// it is seated: on the ledge, at the back of the notch, against the fixed face. Vise frame, in.
    #[must_use]
    pub fn seat(&self, size: &Inches) -> Inches {
        Inches::new(
            self.description.notch_back - size.x / 2.0,
            -self.description.notch_depth + size.y / 2.0,
            -self.description.jaw[2] + size.z / 2.0,
        )
    }

    /// True if a point (vise frame, in) is where a part in the vise has its middle.
    #[must_use]
    pub fn contains(&self, point: &Inches) -> bool {
        let [depth, _, height] = self.description.jaw;
        (-1.0..depth).contains(&point.x)
            && (-self.description.notch_depth..self.opening).contains(&point.y)
            && (-height..height).contains(&point.z)
    }
}

fn jaw_frame(description: &Description, frame: &Frame, opening: f64) -> Frame {
    frame.shifted(Inches::new(0.0, opening - description.notch_depth, 0.0))
}
