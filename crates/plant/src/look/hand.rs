//! Meshes of the end effectors. The faces of bodies and fingers coincide with the boxes of the collision model.

use core::f64::consts::TAU;

use crate::{
    CellDescription,
    bodies::{CAMERA, body_boxes, palm},
    description::Gripper,
    hand::Hand,
    look::mesh::{Mesh, ROUND, SMALL, count},
    scene::Material::{self, Brass, Bright, Charcoal, Cream, Green, Light, Pad, Red, Rubber, Steel, Yellow},
};
use geometry::kinematics::T3;

const EDGE: f64 = 0.03; // small chamfer, in: gripped parts lie against the adjacent faces

#[must_use]
pub(crate) fn body(cell: &CellDescription, hand: Hand) -> Mesh {
    match hand {
        Hand::Pedestal => pedestal_hand(hand.description(cell)),
        _ => robot_gripper(cell, hand.description(cell), mark(hand)),
    }
}

#[must_use]
pub(crate) fn finger(cell: &CellDescription, hand: Hand, side: f64) -> Mesh {
    finger_mesh(hand.description(cell), side, mark(hand))
}

const fn mark(hand: Hand) -> Material {
    match hand {
        Hand::Parts => Green,
        Hand::V => Brass,
        Hand::Tool => Red,
        Hand::Pedestal => Yellow,
    }
}

/// The A plate of the quick change, and the camera, whose view passes the gripper.
#[must_use]
pub fn quick_change(cell: &CellDescription) -> Mesh {
    let mut mesh = Mesh::default();
    let change = &cell.quick_change;
    let (back, front) = (-T3.plate_to_tool, -T3.plate_to_tool + change.length / 2.0);
    mesh.rod(Charcoal, [back, 0.0, 0.0], [front, 0.0, 0.0], change.radius, EDGE, ROUND);
    mesh.rod(Bright, [front - 0.5, 0.0, 0.0], [front - 0.2, 0.0, 0.0], change.radius + 0.12, 0.05, ROUND);
    for turn in [1.0, 1.57, 2.14] {
        let at = |x: f64, out: f64| [x, out * libm::cos(turn + 1.57), out * libm::sin(turn + 1.57)];
        mesh.rod(
            Rubber,
            at(back + 0.7, change.radius - 0.3),
            at(back + 0.7, change.radius + 0.9),
            0.35,
            0.1,
            SMALL,
        );
    }
    let [x, y, z] = cell.camera.position;
    let [long, wide, high] = CAMERA;
    mesh.cuboid(Charcoal, [back + 0.2, y - 0.7, 2.0], [x, y + 0.7, z - high / 2.0 + 0.3], 0.1);
    mesh.block(Cream, [x, y, z], CAMERA, EDGE);
    let tilt = cell.camera.tilt.to_radians();
    let (cosine, sine) = (libm::cos(tilt), -libm::sin(tilt));
    let ahead = |distance: f64| [x + long / 2.0 - 0.1 + distance * cosine, y, z + distance * sine];
    mesh.rod(Charcoal, ahead(0.0), ahead(0.7), 0.62, 0.05, ROUND);
    mesh.rod(Light, ahead(0.5), ahead(0.62), 0.72, 0.0, ROUND);
    mesh.rod(Rubber, ahead(0.6), ahead(0.74), 0.48, 0.0, ROUND);
    mesh.hose(
        Rubber,
        &[
            [x - long / 2.0, y + wide / 4.0, z],
            [x - 2.2, y + 0.6, z + 0.7],
            [back - 1.0, y + 1.0, z - 0.1],
            [back - 1.6, y + 0.8, 2.8],
        ],
        0.16,
    );
    mesh
}

fn robot_gripper(cell: &CellDescription, gripper: &Gripper, mark: Material) -> Mesh {
    let mut mesh = Mesh::default();
    let (change, plate) = (&cell.quick_change, gripper.plate());
    mesh.rod(Steel, [-plate - change.length / 2.0, 0.0, 0.0], [-plate, 0.0, 0.0], change.radius, EDGE, ROUND);
    let [body, ears @ ..] = body_boxes(cell, gripper);
    mesh.block(Charcoal, body.0.position.into(), body.1.into(), 0.08);
    for (ear, size) in ears {
        mesh.block(Yellow, ear.position.into(), size.into(), EDGE);
    }
    let [back, front] = [-1.0, 1.0].map(|side| body.0.position.x + side * body.1.x / 2.0);
    let [wide, high] = [body.1.y / 2.0, body.1.z / 2.0];
    for side in [-1.0, 1.0] {
        mesh.rod(Bright, [front, -wide + 0.3, side * 1.3], [front, wide - 0.3, side * 1.3], 0.22, 0.0, SMALL);
        let [low, top] = if side > 0.0 { [high - 0.02, high + 0.06] } else { [-high - 0.06, 0.02 - high] };
        mesh.cuboid(mark, [back + 0.5, -wide + 0.6, low], [back + 1.5, wide - 0.6, top], 0.0);
        mesh.rod(
            Steel,
            [back + 2.4, side * (wide - 2.6), high - 0.2],
            [back + 2.4, side * (wide - 0.4), high - 0.2],
            0.6,
            0.1,
            SMALL,
        );
        for (x, z) in [(back + 0.5, 1.4), (back + 0.5, -1.4), (front - 0.5, 1.4), (front - 0.5, -1.4)] {
            mesh.rod(Bright, [x, side * (wide - 0.1), z], [x, side * (wide + 0.12), z], 0.22, 0.0, 6);
        }
    }
    mesh
}

/// A finger in its own frame: a bar with a pad on the gripping face, a rib on the other, a carriage at its root.
fn finger_mesh(gripper: &Gripper, side: f64, mark: Material) -> Mesh {
    let mut mesh = Mesh::default();
    let [length, thick, wide] = gripper.fingers;
    let (root, tip, z) = (-length / 2.0, length / 2.0, wide / 2.0);
    let pad = thick * 0.3;
    let mut slab = |material, x: [f64; 2], from: f64, to: f64, z: f64, edge| {
        let [a, b] = if side > 0.0 { [from, to] } else { [-to, -from] };
        mesh.cuboid(material, [x[0], a, -z], [x[1], b, z], edge);
    };
    let (inner, outer) = (-thick / 2.0, thick / 2.0);
    slab(Steel, [root, tip], inner + pad, outer, z, EDGE);
    slab(Steel, [root, tip - 2.2], inner, inner + pad, z, 0.0);
    slab(Pad, [tip - 2.2, tip], inner, inner + pad, z, EDGE);
    slab(mark, [tip - 2.4, tip - 1.9], outer - 0.05, outer + 0.02, z, 0.0);
    slab(Charcoal, [root, root + 0.9], outer - 0.05, outer + 0.9, z, 0.08);
    slab(Steel, [root + 0.8, root + 1.8], outer - 0.05, outer + 0.55, z * 0.4, 0.0);
    slab(Steel, [root + 1.7, root + 2.6], outer - 0.05, outer + 0.28, z * 0.4, 0.0);
    if let Some(groove) = gripper.groove {
        let x = tip + groove;
        slab(Bright, [x - 0.3, x + 0.3], inner - 0.005, inner + 0.1, z, 0.0);
        slab(Rubber, [x - 0.06, x + 0.06], inner - 0.01, inner + 0.1, z, 0.0);
    }
    mesh
}

/// The pedestal's hand: a palm on a rotary table; X points up.
fn pedestal_hand(hand: &Gripper) -> Mesh {
    let mut mesh = Mesh::default();
    let (place, size) = palm(hand);
    mesh.block(Charcoal, place.position.into(), size.into(), 0.08);
    let [bottom, top] = [-1.0, 1.0].map(|side| place.position.x + side * size.x / 2.0);
    mesh.rod(Steel, [bottom, 0.0, 0.0], [bottom + 0.5, 0.0, 0.0], 5.4, 0.1, ROUND);
    for tick in 0..12 {
        let angle = TAU * count(tick) / 12.0;
        let at = |x: f64| [x, 4.7 * libm::cos(angle), 4.7 * libm::sin(angle)];
        mesh.rod(Rubber, at(bottom + 0.4), at(bottom + 0.54), 0.22, 0.0, 6);
    }
    for side in [-1.0, 1.0] {
        mesh.rod(
            Bright,
            [top, -size.y / 2.0 + 0.2, side * 1.2],
            [top, size.y / 2.0 - 0.2, side * 1.2],
            0.2,
            0.0,
            SMALL,
        );
        let y = side * size.y / 2.0;
        mesh.rod(
            Steel,
            [bottom + 1.4, y - 0.05 * side, 0.0],
            [bottom + 1.4, y + 0.9 * side, 0.0],
            0.9,
            0.1,
            ROUND,
        );
    }
    mesh.cuboid(
        Yellow,
        [bottom + 2.6, -size.y / 2.0 - 0.03, -size.z / 2.0 - 0.03],
        [bottom + 3.1, size.y / 2.0 + 0.03, size.z / 2.0 + 0.03],
        0.0,
    );
    mesh
}
