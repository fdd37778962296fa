//! Meshes of parts and tools: the bodies of the collision model, coloured by kind.

use crate::{
    description::PartType,
    look::mesh::{Mesh, ROUND, SMALL},
    scene::Material::{self, Bright, Gold, Steel},
    solid::along,
};

const EDGE: f64 = 0.03;

/// A part in its own frame: origin at its middle, X down as the part lies, Z along it.
#[must_use]
pub fn mesh(kind: &PartType) -> Mesh {
    let mut mesh = Mesh::default();
    let material = Material::of_part(kind);
    let Some((axis, radius, length)) = along(kind) else {
        mesh.block(material, [0.0; 3], kind.size, EDGE);
        return mesh;
    };
    let at = |x: f64| axis.shifted(geometry::frame::Vector::new(x, 0.0, 0.0)).position.into();
    let half = length / 2.0;
    if !kind.tool {
        mesh.rod(material, at(-half), at(half), radius, EDGE, ROUND);
        return mesh;
    }
    mesh.rod(Steel, at(-half), at(half), radius, EDGE, ROUND);
    mesh.rod(material, at(-half + 0.5), at(-half + 1.3), radius + 0.02, 0.0, ROUND);
    mesh.rod(Bright, at(half - 0.9), at(half - 0.6), radius + 0.015, 0.0, ROUND);
    mesh.rod(Gold, at(-half - 1.3), at(-half + 0.1), 0.32, 0.1, SMALL);
    mesh
}
