//! Parts: movable boxes and cylinders, and their reports.

use std::fmt;

use geometry::frame::{Frame, Vector as Inches, rotation_from_x_y};
use rapier3d_f64::prelude::*;
use serde::{Deserialize, Serialize};

use crate::{
    convert::{KILOGRAMS_PER_POUND, to_frame, to_pose},
    description::PartType,
    hold::Load,
    scene::{PART, groups},
    solid::Solid,
};

const FRICTION: Real = 0.30; // coefficient of friction of a part's surface
/// Angular damping of a part that can roll, 1/s: floor and trays are slightly soft and uneven.
const ROLLING: Real = 2.0;

#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct Part {
    pub kind: PartType,
    pub id: u32, // from 1; machining keeps it
    pub body: RigidBodyHandle,
    pub collider: ColliderHandle,
    pub fallen: bool, // lay on the floor at the last check
    /// Sides that were machined in the vise, as unit vectors along the part's axes.
    pub machined: Vec<[i8; 3]>,
}

impl Part {
    pub fn new(world: &mut PhysicsWorld, id: u32, kind: &PartType, frame: &Frame) -> Self {
        let rolls = Solid::of(kind).cylinder().is_some();
        let damping = if rolls { ROLLING } else { 0.0 };
        let builder = RigidBodyBuilder::dynamic().pose(to_pose(frame)).angular_damping(damping);
        let body = world.insert_body(builder);
        let collider = world.insert_collider(collider(kind), Some(body));
        Self { kind: kind.clone(), id, body, collider, fallen: false, machined: Vec::new() }
    }

    /// Change it to another kind of part; its middle moves by `shift` (in its own axes, in).
    pub fn become_kind(&mut self, world: &mut PhysicsWorld, kind: &PartType, shift: Inches) {
        let frame = self.frame(world).shifted(shift);
        world.remove_collider(self.collider);
        self.collider = world.insert_collider(collider(kind), Some(self.body));
        world.bodies[self.body].set_position(to_pose(&frame), true);
        self.kind = kind.clone();
    }

    #[must_use]
    pub fn solid(&self) -> Solid {
        Solid::of(&self.kind)
    }

    /// Half its size, metres.
    #[must_use]
    pub fn half(&self) -> Vector {
        self.solid().half()
    }

    /// Its pose, metres.
    #[must_use]
    pub fn pose(&self, world: &PhysicsWorld) -> Pose {
        *world.bodies[self.body].position()
    }

    #[must_use]
    pub fn frame(&self, world: &PhysicsWorld) -> Frame {
        to_frame(&self.pose(world))
    }

    #[must_use]
    pub fn load(&self) -> Load {
        let mass = mass(&self.kind);
        Load { mass, inertia: mass * self.solid().inertia() }
    }

    pub fn set_holders(&self, world: &mut PhysicsWorld, holders: Group) {
        if let Some(collider) = world.colliders.get_mut(self.collider) {
            collider.set_collision_groups(groups(PART, Group::ALL & !holders));
        }
        if let Some(body) = world.bodies.get_mut(self.body) {
            body.wake_up(true);
        }
    }

    /// Radius of a sphere around its middle that contains it, metres.
    #[must_use]
    pub fn radius(&self) -> Real {
        self.half().length()
    }
}

fn mass(kind: &PartType) -> Real {
    kind.weight * KILOGRAMS_PER_POUND
}

fn collider(kind: &PartType) -> ColliderBuilder {
    Solid::of(kind).collider().mass(mass(kind)).friction(FRICTION).collision_groups(groups(PART, Group::ALL))
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PartState {
    #[serde(skip)]
    pub id: u32, // from 1
    pub name: String,
    /// A location: a unit, the location of the vise, the drum or the pedestal, `gripper`, `floor` or `elsewhere`.
    pub location: String,
    pub sector: u16, // 0 if not in a unit
    pub held: bool,
    pub clamped: bool,
    /// Its middle in world coordinates, in.
    #[serde(rename = "position_in")]
    pub position: [f64; 3],
    /// Distance of its middle from the centre of its sector (x and y) or from its seat in the vise, in.
    #[serde(rename = "error_in")]
    pub error: Option<f64>,
}

impl fmt::Display for PartState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let place = match self.location.as_str() {
            "gripper" => "in the gripper".to_owned(),
            "floor" => "on the floor".to_owned(),
            "elsewhere" => "at none of the cell's places".to_owned(),
            vise if self.clamped => format!("clamped in {vise}"),
            location => format!("at {location}"),
        };
        write!(f, "{} is {place}", self.name)?;
        if self.sector > 0 {
            write!(f, " sector {}", self.sector)?;
        }
        if let Some(error) = self.error {
            let from = if self.sector > 0 { "the sector's centre" } else { "its seat" };
            write!(f, ", {error:.2} in from {from}")?;
        }
        let [x, y, z] = self.position;
        write!(f, " ({x:.2} {y:.2} {z:.2} in)")
    }
}

/// True if the segment from `from` to `to` meets the box around a part at `pose`, metres.
#[must_use]
pub fn segment_meets_box(from: Vector, to: Vector, pose: &Pose, half: Vector) -> bool {
    let start = pose.inverse_transform_point(from).to_array();
    let end = pose.inverse_transform_point(to).to_array();
    let half = half.to_array();
    let (mut enters, mut leaves) = (0.0_f64, 1.0_f64);
    for axis in 0..3 {
        let way = end[axis] - start[axis];
        if way.abs() < 1e-12 {
            if start[axis].abs() > half[axis] {
                return false;
            }
            continue;
        }
        let (a, b) = ((-half[axis] - start[axis]) / way, (half[axis] - start[axis]) / way);
        enters = enters.max(a.min(b));
        leaves = leaves.min(a.max(b));
    }
    enters <= leaves
}

#[must_use]
pub fn sizes_along(here: &Frame, kind: &PartType) -> Inches {
    let square = nearest_square(here);
    let sizes = square.rotation * Inches::from(kind.size);
    sizes.map(f64::abs)
}

/// The frame with its axes aligned to the nearest axes of the frame in which it is given.
#[must_use]
pub fn nearest_square(here: &Frame) -> Frame {
    let snapped = |v: Inches| {
        let longest = (0..3).max_by(|a, b| v[*a].abs().total_cmp(&v[*b].abs())).unwrap_or(0);
        let mut axis = Inches::zeros();
        axis[longest] = v[longest].signum();
        axis
    };
    rotation_from_x_y(&snapped(here.x()), &snapped(here.y()))
        .map_or(*here, |rotation| Frame { position: here.position, rotation })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::Shape;

    #[test]
    fn part_sizes_are_along_the_vise_axes() {
        let kind = PartType {
            name: "P".into(),
            size: [1.0, 2.0, 3.0],
            weight: 1.0,
            shape: Shape::Box,
            vision_id: 0,
            reflectance: 0.5,
            tool: false,
            other_side: false,
        };
        // Part X down, Y along vise X, slightly tilted.
        let upright =
            geometry::frame::rotation_from_x_y(&Inches::new(0.02, 0.01, -1.0), &Inches::x()).unwrap();
        let here = Frame { position: Inches::zeros(), rotation: upright };
        assert!((sizes_along(&here, &kind) - Inches::new(2.0, 3.0, 1.0)).norm() < 1e-12);
    }

    #[test]
    fn crossing_body_breaks_the_beam() {
        let half = Vector::new(0.01, 0.01, 0.05);
        let across = |z: Real| {
            segment_meets_box(Vector::new(0.0, -0.1, z), Vector::new(0.0, 0.1, z), &Pose::IDENTITY, half)
        };
        assert!(across(0.049) && !across(0.051));
        let short = segment_meets_box(
            Vector::new(0.0, -0.1, 0.0),
            Vector::new(0.0, -0.02, 0.0),
            &Pose::IDENTITY,
            half,
        );
        assert!(!short, "the part is behind the receiver");
    }
}
