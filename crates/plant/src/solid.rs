//! The shape of a part: a box, or a cylinder along one of the axes of the part.

use core::f64::consts::FRAC_PI_2;

use geometry::frame::{Frame, Rotation as Turn, Vector as Inches};
use rapier3d_f64::prelude::*;

use crate::{
    convert::metres,
    description::{PartType, Shape},
};

/// The shape of a part, metres, in the axes of the part, its middle at their origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solid {
    half: Vector,
    axis: Option<usize>, // axis of a cylinder; `None` for a box
}

impl Solid {
    #[must_use]
    pub fn of(kind: &PartType) -> Self {
        let axis = match kind.shape {
            Shape::Box => None,
            Shape::CylinderX => Some(0),
            Shape::CylinderZ => Some(2),
        };
        Self { half: Vector::from_array(kind.size.map(|size| metres(size / 2.0))), axis }
    }

    #[must_use]
    pub const fn cuboid(half: Vector) -> Self {
        Self { half, axis: None }
    }

    #[must_use]
    pub const fn cylinder_z(radius: Real, half_length: Real) -> Self {
        Self { half: Vector::new(radius, radius, half_length), axis: Some(2) }
    }

    /// Half the sizes of its bounding box.
    #[must_use]
    pub const fn half(&self) -> Vector {
        self.half
    }

    /// Direction, radius and half length of a cylinder; `None` for a box.
    #[must_use]
    pub fn cylinder(&self) -> Option<(Vector, Real, Real)> {
        let axis = self.axis?;
        let half = self.half.to_array();
        Some((Vector::AXES[axis], half[(axis + 1) % 3], half[axis]))
    }

    /// The shape, and its pose in the axes of the part: a cylinder of the simulation lies along its Y.
    #[must_use]
    pub fn shape(&self) -> (SharedShape, Pose) {
        let Some((direction, radius, half_length)) = self.cylinder() else {
            return (SharedShape::cuboid(self.half.x, self.half.y, self.half.z), Pose::IDENTITY);
        };
        let turn = Rotation::from_rotation_arc(Vector::Y, direction);
        (SharedShape::cylinder(half_length, radius), Pose::from_rotation(turn))
    }

    pub fn collider(&self) -> ColliderBuilder {
        let (shape, turn) = self.shape();
        ColliderBuilder::new(shape).position(turn)
    }

    /// Greatest principal moment of inertia for a mass of 1 kg.
    #[must_use]
    pub fn inertia(&self) -> Real {
        match self.cylinder() {
            None => {
                let squares = self.half * self.half;
                (squares.element_sum() - squares.min_element()) / 3.0
            }
            Some((_, radius, half_length)) => {
                let across = radius * radius / 4.0 + half_length * half_length / 3.0;
                across.max(radius * radius / 2.0)
            }
        }
    }
}

/// Frame whose X is the axis of a cylinder, for URDF, and its radius and length; inches. `None` for a box.
#[must_use]
pub fn along(kind: &PartType) -> Option<(Frame, f64, f64)> {
    let [x, y, z] = kind.size;
    let (turn, diameter, length) = match kind.shape {
        Shape::Box => return None,
        Shape::CylinderX => (Turn::identity(), y, x),
        Shape::CylinderZ => (Turn::from_axis_angle(&Inches::y_axis(), -FRAC_PI_2), x, z),
    };
    Some((Frame { position: Inches::zeros(), rotation: turn }, diameter / 2.0, length))
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    Tool,
    Round,
    /// A box thicker than an inch.
    Block,
    Bar,
}

impl Family {
    #[must_use]
    pub fn of(kind: &PartType) -> Self {
        match kind.shape {
            _ if kind.tool => Self::Tool,
            Shape::CylinderX | Shape::CylinderZ => Self::Round,
            Shape::Box if kind.size[0] > 1.0 => Self::Block,
            Shape::Box => Self::Bar,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kind(shape: Shape, size: [f64; 3]) -> PartType {
        PartType {
            name: "P".into(),
            shape,
            size,
            weight: 1.0,
            vision_id: 0,
            reflectance: 0.5,
            tool: false,
            other_side: false,
        }
    }

    #[test]
    fn cylinder_lies_along_its_axis() {
        let tool = Solid::of(&kind(Shape::CylinderX, [3.30, 1.75, 1.75]));
        let (shape, turn) = tool.shape();
        let aabb = shape.compute_aabb(&turn);
        assert!((aabb.half_extents() - tool.half()).length() < 1e-9, "{aabb:?}");
        let shaft = Solid::of(&kind(Shape::CylinderZ, [1.5, 1.5, 4.0]));
        assert_eq!(shaft.cylinder(), Some((Vector::Z, metres(0.75), metres(2.0))));
        let (shape, turn) = shaft.shape();
        assert!((shape.compute_aabb(&turn).half_extents() - shaft.half()).length() < 1e-9);
    }

    #[test]
    fn inertia_is_that_of_the_shape() {
        let cube = Solid::cuboid(Vector::splat(1.0));
        assert!((cube.inertia() - 2.0 / 3.0).abs() < 1e-12);
        assert!(
            (Solid::cylinder_z(1.0, 2.0).inertia() - (0.25 + 4.0 / 3.0)).abs() < 1e-12,
            "about its middle"
        );
        assert!((Solid::cylinder_z(1.0, 0.1).inertia() - 0.5).abs() < 1e-12, "of a disc about its axis");
    }
}
