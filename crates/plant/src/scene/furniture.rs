//! Fixed bodies as boxes. Simulation, clearance check and scene use the same [`Block`]s.

use geometry::frame::{Frame, Rotation, Vector as Inches};
use rapier3d_f64::prelude::*;

use super::material::Material;
use crate::{
    clearance::Body,
    convert::{to_metres, to_pose},
    description::{CellDescription, Fixture, Kind, Tray, TrayShape, Vise},
    drum::strike_plate,
    holster::holsters,
};

pub const WORLD: Group = Group::GROUP_1;
pub const JAW: Group = Group::GROUP_4;
pub const FINGER: Group = Group::GROUP_2;
pub const HAND: Group = Group::GROUP_5;
pub const PART: Group = Group::GROUP_3;
/// Collision group of the palms of hands: a held part still collides with the palm.
pub const PALM: Group = Group::GROUP_6;

/// The backs of the movable jaw are this far behind the backs of the fixed jaw, in, so that no back drags the part.
const RELIEF: f64 = 0.02;

const FRICTION: Real = 0.30; // coefficient of friction of steel on trays, vise and floor

#[must_use]
pub const fn groups(member: Group, meets: Group) -> InteractionGroups {
    InteractionGroups::new(member, meets, InteractionTestMode::And)
}

#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Name of the link that it belongs to.
    pub name: String,
    pub frame: Frame, // its centre and its axes, in the world (or the jaw's frame), in
    pub size: Inches, // its size along its axes, in
    pub kind: Kind,
    pub jaw: bool,
    /// Its coefficient of friction, if it differs from that of trays, vise and floor.
    pub friction: Option<f64>,
}

impl Block {
    /// A box given by two opposite corners, in their frame.
    #[must_use]
    pub fn between(name: &str, kind: Kind, low: Inches, high: Inches) -> Self {
        let frame = Frame { position: (low + high) / 2.0, rotation: Rotation::identity() };
        Self { name: name.into(), frame, size: (high - low).abs(), kind, jaw: false, friction: None }
    }

    fn jaw(name: &str, low: Inches, high: Inches) -> Self {
        Self { jaw: true, ..Self::between(name, Kind::Vise, low, high) }
    }

    /// Half the size, metres.
    #[must_use]
    pub fn half(&self) -> Vector {
        to_metres(&self.size) / 2.0
    }

    /// The same block moved by a frame.
    #[must_use]
    pub fn moved(&self, by: &Frame) -> Self {
        Self { frame: by.compose(&self.frame), ..self.clone() }
    }

    #[must_use]
    pub fn is_of_vise(&self) -> bool {
        self.kind == Kind::Vise
    }

    /// Its colour; for a bench, the colour of its top.
    #[must_use]
    pub fn colour(&self) -> Material {
        match (self.kind, self.name.as_str()) {
            (Kind::Vise, _) if self.jaw => Material::Steel,
            (Kind::Vise, _) => Material::Charcoal,
            (Kind::Tray, _) => Material::Blue,
            (Kind::Holster, name) if name.ends_with("_foot") => Material::Slate,
            (Kind::Holster | Kind::Drum, _) => Material::Yellow,
            (_, "floor") => Material::Concrete,
            (_, "robot_base" | "tool_drum") => Material::Charcoal,
            (_, "machine_pallet") => Material::Petrol,
            (_, "machine_column") => Material::White,
            (_, "horizontal_fixture" | "vertical_fixture" | "brush_bracket") => Material::Steel,
            (_, name) if name.starts_with("nest_") || name.starts_with("pot_") => Material::Charcoal,
            (_, name) if name.starts_with("cradle_") => Material::Cream,
            _ if self.size.min() >= 8.0 => Material::Maple,
            _ => Material::Slate,
        }
    }

    pub fn collider(&self) -> ColliderBuilder {
        let half = self.half();
        ColliderBuilder::cuboid(half.x, half.y, half.z)
            .position(to_pose(&self.frame))
            .friction(self.friction.unwrap_or(FRICTION))
            .collision_groups(groups(if self.jaw { JAW } else { WORLD }, Group::ALL))
    }
}

#[must_use]
pub fn furniture(cell: &CellDescription) -> Vec<Block> {
    let mut blocks: Vec<Block> = cell.fixture.iter().map(fixture).collect();
    for tray in &cell.tray {
        blocks.extend(tray_blocks(tray, &cell.tray_shape));
    }
    let drum = cell.drum.pose.frame().unwrap_or_else(Frame::identity);
    blocks.extend(strike_plate(&drum, &cell.drum));
    blocks.extend(holsters(cell).iter().flat_map(|holster| holster.blocks(&cell.gripper.parts)));
    let vise = vise_frame(&cell.vise);
    blocks.extend(vise_blocks(&cell.vise).iter().map(|block| block.moved(&vise)));
    blocks
}

fn fixture(fixture: &Fixture) -> Block {
    let rotation = Rotation::from_axis_angle(&Inches::z_axis(), fixture.azimuth.to_radians())
        * Rotation::from_axis_angle(&Inches::y_axis(), fixture.tilt.to_radians());
    Block {
        name: fixture.name.clone(),
        frame: Frame { position: Inches::from(fixture.centre), rotation },
        size: Inches::from(fixture.size),
        kind: Kind::Fixture,
        jaw: false,
        friction: None,
    }
}

fn tray_blocks(tray: &Tray, shape: &TrayShape) -> Vec<Block> {
    let [x, y] = tray.centre;
    let inner = shape.inside / 2.0;
    let outer = inner + shape.wall;
    let (bottom, floor, rim) = (tray.floor - shape.floor_thickness, tray.floor, tray.floor + shape.rim);
    let name = |what: &str| format!("{}_{what}", tray.unit);
    let centre = Inches::new(x, y, 0.0);
    let block = |what: &str, low: Inches, high: Inches| {
        Block::between(&name(what), Kind::Tray, centre + low, centre + high)
    };
    vec![
        block("floor", Inches::new(-outer, -outer, bottom), Inches::new(outer, outer, floor)),
        block("far_wall", Inches::new(-outer, -outer, floor), Inches::new(-inner, outer, rim)),
        block("near_wall", Inches::new(inner, -outer, floor), Inches::new(outer, outer, rim)),
        block("left_wall", Inches::new(-inner, -outer, floor), Inches::new(inner, -inner, rim)),
        block("right_wall", Inches::new(-inner, inner, floor), Inches::new(inner, outer, rim)),
    ]
}

#[must_use]
pub fn vise_frame(vise: &Vise) -> Frame {
    Frame { position: Inches::from(vise.position), rotation: Rotation::identity() }
}

fn vise_blocks(vise: &Vise) -> Vec<Block> {
    let height = vise.jaw[2];
    let [front, back] = vise.body_x;
    let mut blocks = vec![Block::between(
        "vise_body",
        Kind::Vise,
        Inches::new(front, vise.body_y[0], -height - vise.body_height),
        Inches::new(back, vise.body_y[1], -height),
    )];
    blocks.extend(jaw_pieces(vise).into_iter().map(|[[x0, x1], [d0, d1], [z0, z1]]| {
        Block::jaw("fixed_jaw", Inches::new(x0, -d1, z0), Inches::new(x1, -d0, z1))
    }));
    blocks
}

/// The movable jaw in its own frame, whose Y origin is its inner face.
#[must_use]
pub fn jaw_blocks(vise: &Vise) -> Vec<Block> {
    let pieces = jaw_pieces(vise).into_iter().map(|[[x0, x1], [d0, d1], [z0, z1]]| {
        let back = if x0 > 0.0 { x0 + RELIEF } else { x0 };
        Block::jaw("movable_jaw", Inches::new(back, d0, z0), Inches::new(x1, d1, z1))
    });
    pieces.collect()
}

/// The blocks of a jaw without the steps of all programs. Each has ranges of depth into the vise, of depth behind the
/// inner face, and of height.
fn jaw_pieces(vise: &Vise) -> Vec<[[f64; 2]; 3]> {
    let [into, thickness, height] = vise.jaw;
    let mut depths: Vec<f64> = vise.program.iter().map(|program| program.depth).collect();
    depths.extend([0.0, thickness]);
    let mut levels: Vec<f64> = vise.program.iter().map(|program| program.ledge).collect();
    levels.extend([-height, 0.0]);
    for borders in [&mut depths, &mut levels] {
        borders.sort_by(f64::total_cmp);
        borders.dedup();
    }
    let mut pieces: Vec<[[f64; 2]; 3]> = Vec::new();
    for depth in depths.windows(2) {
        for level in levels.windows(2) {
            let cuts = vise.program.iter().filter(|cut| cut.depth >= depth[1] && cut.ledge <= level[0]);
            let from = cuts.map(|cut| cut.back).fold(0.0, f64::max);
            match pieces.last_mut() {
                // Merge with the box of the step above if both extend equally far into the vise.
                Some([x, d, z]) if x[0] == from && *d == [depth[0], depth[1]] && z[1] == level[0] => {
                    z[1] = level[1];
                }
                _ if from < into => {
                    pieces.push([[from, into], [depth[0], depth[1]], [level[0], level[1]]]);
                }
                _ => {}
            }
        }
    }
    pieces
}

impl From<&Block> for Body {
    fn from(block: &Block) -> Self {
        let half = block.half();
        let shape = SharedShape::cuboid(half.x, half.y, half.z);
        Self::new(block.name.clone(), block.kind, to_pose(&block.frame), shape)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn program_steps_are_cut_out_of_the_jaws() {
        let cell = CellDescription::from_toml(include_str!("../../../../data/cell.toml")).unwrap();
        let mut pieces = jaw_pieces(&cell.vise);
        pieces.sort_by(|a, b| b[1][0].total_cmp(&a[1][0]).then(a[2][0].total_cmp(&b[2][0])));
        assert_eq!(
            pieces,
            [
                [[0.0, 6.0], [0.1625, 3.0], [-3.25, 0.0]],
                [[0.41, 6.0], [0.10, 0.1625], [-3.25, 0.0]],
                [[0.41, 6.0], [0.0, 0.10], [-3.25, -1.0]],
                [[1.60, 6.0], [0.0, 0.10], [-1.0, 0.0]],
            ]
        );
    }
}
