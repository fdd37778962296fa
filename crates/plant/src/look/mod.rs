//! Visual meshes of the cell: one per link of a [`Scene`], generated from the description of the cell.
//!
//! [`Scene::models`] makes glTF files for display only: each mesh covers the bodies of its link. [`Scene::labels`]
//! lists the names to display; [`camera`] draws pictures. Lengths are inches; [`glb`] converts to metres.

pub mod arm;
pub mod camera;
pub mod glb;
pub mod hand;
pub mod machine;
pub mod mesh;
pub mod parts;
pub mod room;

use crate::scene::{Block, Body, Link, Moving, ROOT, Scene};

pub use mesh::Mesh;

/// A mesh, and the frame in which it is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// Name of the link, or of a group of fixed things.
    pub name: String,
    /// Name of the link with which it moves; `world` for fixed bodies.
    pub frame: String,
    pub mesh: Mesh, // the solids, in the coordinates of the frame, inches
}

impl Model {
    #[must_use]
    pub fn new(link: &str, mesh: Mesh) -> Self {
        Self { name: link.into(), frame: link.into(), mesh }
    }

    #[must_use]
    pub fn standing(name: &str, mesh: Mesh) -> Self {
        Self { name: name.into(), frame: ROOT.into(), mesh }
    }

    #[must_use]
    pub fn glb(&self) -> Vec<u8> {
        glb::encode(&self.mesh)
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    pub text: String,
    /// Name of the link with which it moves.
    pub frame: &'static str,
    pub position: [f64; 3], // inches
}

impl Scene<'_> {
    /// The detailed meshes: one per group of fixed bodies, and one per other link.
    #[must_use]
    pub fn models(&self) -> Vec<Model> {
        let blocks: Vec<&Block> = self.blocks().collect();
        let mut models = room::models(self.cell, &blocks);
        models.extend(self.links().iter().filter_map(|link| Some(Model::new(&link.name, self.mesh(link)?))));
        models
    }

    /// The mesh of a link; `None` if it is fixed.
    fn mesh(&self, link: &Link<'_>) -> Option<Mesh> {
        let cell = self.cell;
        Some(match link.body {
            Body::Fixed(_) => return None,
            Body::Part(kind) => parts::mesh(kind),
            Body::Moving(moving) => match moving {
                Moving::Arm(joint) => arm::mesh(joint, cell),
                Moving::QuickChange => hand::quick_change(cell),
                Moving::Hand(hand) => hand::body(cell, hand),
                Moving::Finger(hand, finger) => hand::finger(cell, hand, finger.sign()),
                Moving::Vise => machine::vise(&cell.vise, &link.visuals),
                Moving::Jaw => machine::jaw(&cell.vise, &link.visuals),
            },
        })
    }

    #[must_use]
    pub fn labels(&self) -> Vec<Label> {
        let cell = self.cell;
        let label = |text: &str, frame, position| Label { text: text.into(), frame, position };
        let above = |text: &str, fixture: &str, rise: f64| {
            let fixture = cell.fixture.iter().find(|known| known.name == fixture)?;
            let [x, y, z] = fixture.centre;
            Some(label(text, ROOT, [x, y, z + fixture.size[2] / 2.0 + rise]))
        };
        let mut labels = vec![label("T3", "turret", [0.0, 0.0, 2.0 * cell.robot.upper_arm_radius + 6.0])];
        for (tray, number) in cell.tray.iter().zip(1..) {
            let ([x, y], up) = (tray.centre, 7.0 * f64::from(number));
            labels.push(label(&format!("tray {}", tray.unit), ROOT, [x, y, tray.floor + up]));
        }
        let [_, _, up] = cell.vise.jaw;
        labels.push(label("vise", "vise", [cell.vise.jaw[0], 0.0, 2.0 * up]));
        labels.extend(above("machining centre", "machine_column", 18.0));
        labels.extend(above("tool drum", "tool_drum", 8.0));
        let [x, y, z] = cell.pedestal.position;
        labels.push(label("pedestal", ROOT, [x, y, z + 6.0]));
        if let Some(frame) = cell.holsters.right.frame() {
            let [x, y, z] = frame.position.into();
            labels.push(label("grippers", ROOT, [x, y, z + 18.0]));
        }
        labels
    }
}
