//! Meshes of the machining centre, built around pallet, column and drum of the description, and of the vise on it.

use core::f64::consts::TAU;

use crate::{
    description::Vise,
    look::mesh::{Mesh, ROUND, SMALL, count},
    scene::{
        Block,
        Material::{Bright, Charcoal, Gold, Green, Light, Petrol, Red, Rubber, Steel, White, Yellow},
        Shape, Visual,
    },
};

#[must_use]
pub fn vise(vise: &Vise, visuals: &[Visual]) -> Mesh {
    let mut body = boxes(visuals, 0.12);
    let ([front, back], [right, left]) = (vise.body_x, vise.body_y);
    let ledge = -vise.jaw[2];
    for x in [front + 0.5, back - 1.1] {
        body.cuboid(Bright, [x, right + 0.2, ledge - 0.1], [x + 0.6, left - 0.2, ledge + 0.02], 0.0);
    }
    let middle = (front + vise.jaw[0]) / 2.0;
    body.rod(Bright, [middle, right + 0.5, ledge - 1.4], [middle, left + 0.8, ledge - 1.4], 0.5, 0.1, SMALL);
    body.rod(Charcoal, [middle, left, ledge - 1.4], [middle, left + 2.6, ledge - 1.4], 1.3, 0.2, ROUND);
    body.rod(Yellow, [middle, left + 0.5, ledge - 1.4], [middle, left + 0.9, ledge - 1.4], 1.36, 0.0, ROUND);
    body.cuboid(
        Yellow,
        [front - 0.06, right + 0.8, ledge - 1.2],
        [front + 0.05, right + 3.2, ledge - 0.5],
        0.0,
    );
    for (x, y) in [(front + 1.0, right + 0.8), (back - 1.0, right + 0.8), (back - 1.0, left - 0.8)] {
        body.rod(Bright, [x, y, ledge - 0.1], [x, y, ledge + 0.2], 0.4, 0.05, 6);
    }
    body
}

/// The movable jaw around its shapes, which are boxes.
#[must_use]
pub fn jaw(vise: &Vise, visuals: &[Visual]) -> Mesh {
    let mut jaw = boxes(visuals, 0.0);
    let ledge = -vise.jaw[2];
    let behind = vise.jaw[1];
    for x in [1.4, vise.jaw[0] - 1.4] {
        jaw.rod(Bright, [x, behind - 0.1, ledge + 1.0], [x, behind + 0.25, ledge + 1.0], 0.45, 0.05, 6);
    }
    jaw
}

fn boxes(visuals: &[Visual], chamfer: f64) -> Mesh {
    // steel without a chamfer
    let mut mesh = Mesh::default();
    for Visual { frame, shape, colour } in visuals {
        if let Shape::Box(size) = shape {
            let edge = if *colour == Steel { 0.0 } else { chamfer };
            mesh.block(*colour, frame.position.into(), (*size).into(), edge);
        }
    }
    mesh
}

#[must_use]
pub fn pallet(block: &Block) -> Mesh {
    let mut mesh = Mesh::default();
    let [x, y, z] = (block.size / 2.0).into();
    mesh.cuboid(Petrol, [-x, -y, -z], [x, y, z], 0.3);
    mesh.cuboid(Steel, [-x - 0.25, -y - 0.25, z - 3.0], [x + 0.25, y + 0.25, z + 0.01], 0.15);
    let slots = 6;
    for slot in 0..slots {
        let at = -y + 2.0 * y * (count(slot) + 0.5) / count(slots);
        mesh.cuboid(Rubber, [-x - 0.27, at - 0.35, z - 0.8], [x + 0.2, at + 0.35, z + 0.03], 0.0);
    }
    mesh.cuboid(Charcoal, [-x - 0.6, -y - 0.6, -z], [x, y + 0.6, -z + 4.0], 0.3);
    mesh.cuboid(White, [-x - 0.3, -y + 4.0, -z + 9.0], [-x + 0.2, y - 4.0, z - 8.0], 0.2);
    mesh
}

/// The column with the spindle head, which faces -X at the height `spindle` above the block's middle, in.
#[must_use]
pub fn column(block: &Block, spindle: f64) -> Mesh {
    let mut mesh = Mesh::default();
    let [x, y, z] = (block.size / 2.0).into();
    mesh.cuboid(White, [-x, -y, -z], [x, y, z], 0.8);
    mesh.cuboid(Petrol, [-x - 0.4, -y - 0.4, -z], [x + 0.4, y + 0.4, -z + 14.0], 0.5);
    mesh.cuboid(Petrol, [-x - 0.4, -y - 0.4, z - 9.0], [x + 0.4, y + 0.4, z - 3.0], 0.5);
    for side in [-9.5, 9.5] {
        mesh.cuboid(Bright, [-x - 1.4, side - 1.0, -z + 16.0], [-x + 0.2, side + 1.0, z - 10.0], 0.1);
    }
    for fold in 0..8 {
        let up = spindle - 14.0 - 3.2 * count(fold);
        if up > -z + 16.0 {
            mesh.cuboid(Charcoal, [-x - 0.9, -8.0, up], [-x + 0.2, 8.0, up + 2.8], 0.2);
        }
    }
    mesh.cuboid(White, [-x - 6.5, -9.0, spindle - 9.0], [-x + 0.2, 9.0, spindle + 12.0], 1.2);
    mesh.cuboid(Petrol, [-x - 6.8, -9.15, spindle + 7.0], [-x, 9.15, spindle + 9.0], 0.3);
    let nose = [(0.0, 5.4), (1.6, 5.4), (2.4, 4.6), (2.8, 3.2), (4.4, 3.0), (4.8, 2.6)];
    mesh.lathe(Steel, [-x - 6.4, 0.0, spindle], [-x - 20.0, 0.0, spindle], ROUND, &nose);
    mesh.rod(Rubber, [-x - 11.0, 0.0, spindle], [-x - 11.3, 0.0, spindle], 1.3, 0.0, ROUND);
    mesh.rod(Gold, [-x - 11.0, 0.0, spindle], [-x - 13.2, 0.0, spindle], 0.55, 0.1, SMALL);
    mesh.cuboid(Rubber, [-x - 0.5, y - 12.0, 2.0], [-x + 0.2, y - 3.0, 22.0], 0.4);
    for (step, lamp) in [Green, Yellow, Red].into_iter().enumerate() {
        let up = z + 3.0 + 2.6 * count(step);
        mesh.rod(lamp, [0.0, -y + 6.0, up], [0.0, -y + 6.0, up + 2.5], 1.3, 0.2, ROUND);
    }
    mesh.rod(Charcoal, [0.0, -y + 6.0, z - 0.2], [0.0, -y + 6.0, z + 3.2], 0.6, 0.0, SMALL);
    mesh.rod(Charcoal, [-4.0, -y + 0.2, 24.0], [-4.0, -y - 8.0, 24.0], 0.9, 0.2, SMALL);
    mesh.cuboid(Charcoal, [-5.5, -y - 16.0, 2.0], [-2.5, -y - 3.0, 22.0], 0.6);
    mesh.cuboid(Light, [-5.7, -y - 14.5, 12.0], [-5.3, -y - 4.5, 20.0], 0.1);
    for key in 0..10 {
        let (row, place) = (count(key / 5), count(key % 5));
        let (low, up) = (-y - 14.0 + 2.0 * place, 8.4 - 2.6 * row);
        let material = if key == 9 { Red } else { Steel };
        mesh.cuboid(material, [-5.8, low, up], [-5.3, low + 1.2, up + 1.4], 0.1);
    }
    mesh
}

/// The tool drum with a disc of tool pockets in front; `exchange` is the pocket for exchanges, in, in the block's
/// frame.
#[must_use]
pub fn drum(block: &Block, exchange: [f64; 3]) -> Mesh {
    const POCKETS: usize = 9;
    let mut mesh = Mesh::default();
    let [x, y, z] = (block.size / 2.0).into();
    mesh.cuboid(Charcoal, [-x, -y, -z], [x, y, z], 0.1);
    mesh.cuboid(Petrol, [x - 0.2, -y - 0.3, -z - 0.3], [x + 0.5, y + 0.3, z + 0.3], 0.2);
    let [_, across, up] = exchange;
    let pitch = (y - across.abs() - 2.0).max(3.0);
    let middle = up + pitch;
    mesh.rod(Steel, [-x + 0.2, across, middle], [-x - 0.4, across, middle], pitch + 1.8, 0.15, 40);
    mesh.rod(Charcoal, [-x, across, middle], [-x - 0.9, across, middle], 2.0, 0.3, ROUND);
    for pocket in 0..POCKETS {
        let angle = TAU * (count(pocket) / count(POCKETS) - 0.25);
        let at = |x: f64| [x, across + pitch * libm::cos(angle), middle + pitch * libm::sin(angle)];
        let colour = if pocket == 0 { Yellow } else { Bright };
        mesh.rod(colour, at(-x - 0.2), at(-x - 0.55), 1.25, 0.1, ROUND);
        mesh.rod(Rubber, at(-x - 0.5), at(-x - 0.6), 0.95, 0.0, ROUND);
    }
    mesh.rod(Charcoal, [0.0, 0.0, z - 0.2], [0.0, 0.0, z + 3.0], 2.4, 0.3, ROUND);
    mesh
}
