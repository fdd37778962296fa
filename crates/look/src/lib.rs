//! What the cell looks like: a mesh for each link, made in code from the description of the cell.
//!
//! [`models`] makes glTF files of parametric solids. They are for eyes only: the physics has its own bodies
//! ([`plant::bodies`], [`plant::scene`]), and each mesh covers the bodies of its link, so that nobody sees a gap where the
//! physics has contact. [`labels`] says the names of the things that matter, [`camera`] draws what vision saw.
//!
//! The same description gives the same bytes. Lengths are inches until [`glb`] writes metres.

#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod arm;
pub mod camera;
pub mod glb;
pub mod hand;
pub mod machine;
pub mod material;
pub mod mesh;
pub mod parts;
pub mod png;
pub mod room;

use plant::{
    CellDescription,
    description::PartType,
    scene::{Block, furniture},
};

pub use mesh::Mesh;

/// Frame of what stands still.
const WORLD: &str = "world";
/// Blocks of the furniture that belong to the link of the vise.
const VISE: [&str; 2] = ["vise_body", "fixed_jaw"];

/// A mesh, and the frame in which it is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// Its name: that of its link, or of a group of things that stand still.
    pub name: String,
    /// The link that it moves with; `world` for what stands still.
    pub frame: String,
    /// Its solids, in the coordinates of the frame.
    pub mesh: Mesh,
}

impl Model {
    /// The look of a link.
    #[must_use]
    pub fn new(link: &str, mesh: Mesh) -> Self {
        Self { name: link.into(), frame: link.into(), mesh }
    }

    /// The look of what stands still, in world coordinates.
    #[must_use]
    pub fn standing(name: &str, mesh: Mesh) -> Self {
        Self { name: name.into(), frame: WORLD.into(), mesh }
    }

    /// The mesh as a GLB file.
    #[must_use]
    pub fn glb(&self) -> Vec<u8> {
        glb::encode(&self.mesh)
    }
}

/// A name beside a thing.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// What is written.
    pub text: String,
    /// The link that it moves with.
    pub frame: &'static str,
    /// Where, in the frame, in.
    pub position: [f64; 3],
}

/// The look of the cell with its parts: names of their links, and their kinds. The description has been validated.
#[must_use]
pub fn models(cell: &CellDescription, parts: &[(String, &PartType)]) -> Vec<Model> {
    let furniture = furniture(cell);
    let (vise, rest): (Vec<&Block>, Vec<&Block>) =
        furniture.iter().partition(|block| VISE.contains(&block.name.as_str()));
    let mut models = room::models(cell, &rest);
    models.extend(arm::models(cell));
    models.extend(hand::models(cell));
    models.extend(machine::vise(cell, &vise));
    models.extend(parts.iter().map(|(link, kind)| Model::new(link, parts::mesh(kind))));
    models
}

/// Names of the things that matter.
#[must_use]
pub fn labels(cell: &CellDescription) -> Vec<Label> {
    let label = |text: &str, frame, position| Label { text: text.into(), frame, position };
    let above = |text: &str, fixture: &str, rise: f64| {
        let fixture = cell.fixture.iter().find(|known| known.name == fixture)?;
        let [x, y, z] = fixture.centre;
        Some(label(text, WORLD, [x, y, z + fixture.size[2] / 2.0 + rise]))
    };
    let mut labels = vec![label("T3", "turret", [0.0, 0.0, 2.0 * cell.robot.upper_arm_radius + 6.0])];
    for (tray, number) in cell.tray.iter().zip(1..) {
        // One above the other: they stand side by side.
        let ([x, y], up) = (tray.centre, 7.0 * f64::from(number));
        labels.push(label(&format!("tray {}", tray.unit), WORLD, [x, y, tray.floor + up]));
    }
    let [_, _, up] = cell.vise.jaw;
    labels.push(label("vise", "vise", [cell.vise.jaw[0], 0.0, 2.0 * up]));
    // One above the other: they stand side by side.
    labels.extend(above("machining centre", "machine_column", 18.0));
    labels.extend(above("tool drum", "tool_drum", 8.0));
    let [x, y, z] = cell.pedestal.position;
    labels.push(label("pedestal", WORLD, [x, y, z + 6.0]));
    if let Some(frame) = cell.holsters.right.frame() {
        let [x, y, z] = frame.position.into();
        labels.push(label("grippers", WORLD, [x, y, z + 18.0]));
    }
    labels
}
