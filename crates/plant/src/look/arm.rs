//! Meshes of the T3: each covers the cylinder of its link in the collision model ([`crate::bodies`]).

use core::f64::consts::TAU;

use crate::{
    CellDescription,
    bodies::turret,
    look::mesh::{Mesh, ROUND, SMALL, count, rounded},
    scene::{
        Block,
        Material::{Bright, Charcoal, Cream, Orange, Rubber, Steel, Yellow},
    },
};
use geometry::{
    frame::{Frame, Rotation, Vector},
    kinematics::T3,
};

/// Distance of the mesh's surface from the collision body of a link, in: as thin as a coat of paint.
const MESH_OFFSET: f64 = 0.15;
const CHEEK: f64 = 1.8; // thickness of the plates of a fork joint, in
const PLAY: f64 = 0.4; // gap between a fork and the part that turns in it, in

#[must_use]
pub fn mesh(joint: usize, cell: &CellDescription) -> Mesh {
    let (radius, half) = turret(cell);
    let robot = &cell.robot;
    match joint {
        0 => turret_mesh(radius, half),
        1 => upper_arm(radius, robot.upper_arm_radius),
        2 => forearm(robot.upper_arm_radius, robot.forearm_radius),
        3 => wrist_pitch(robot.forearm_radius, robot.wrist_radius),
        4 => wrist_yaw(robot.wrist_radius),
        _ => end_plate(robot.wrist_radius),
    }
}

/// The column under the turret: the block of the description, with a flange at the bottom and a ring on top.
#[must_use]
pub fn base(block: &Block) -> Mesh {
    let mut mesh = Mesh::default();
    let [x, y, z] = (block.size / 2.0).into();
    mesh.cuboid(Charcoal, [-x, -y, -z], [x, y, z], 0.4);
    mesh.cuboid(Charcoal, [-x - 6.0, -y - 6.0, -z], [x + 6.0, y + 6.0, -z + 1.5], 0.4);
    mesh.cuboid(Orange, [-x - 0.3, -y - 0.3, z - 7.0], [x + 0.3, y + 0.3, z - 0.2], 0.6);
    for quarter in 0..4 {
        let turn = Frame {
            position: Vector::zeros(),
            rotation: Rotation::from_axis_angle(&Vector::z_axis(), TAU / 4.0 * count(quarter)),
        };
        let mut side = Mesh::default();
        let upright = Frame {
            position: Vector::zeros(),
            rotation: Rotation::from_axis_angle(&Vector::x_axis(), TAU / 4.0),
        };
        for y in [-9.0, 9.0] {
            let rib = [(x, 1.5 - z), (x + 5.5, 1.5 - z), (x + 0.6, 14.0 - z), (x, 14.0 - z)];
            side.plate(Charcoal, &upright, &rib, y - 0.5, y + 0.5);
            side.rod(Bright, [x + 4.0, y + 3.6, 1.2 - z], [x + 4.0, y + 3.6, 2.4 - z], 0.9, 0.2, 6);
        }
        side.cuboid(Cream, [x, -6.0, z - 5.6], [x + 0.55, 6.0, z - 1.8], 0.15);
        for louver in 0..6 {
            let up = z - 16.0 - 1.6 * count(louver);
            side.cuboid(Rubber, [x - 0.2, -5.5, up], [x + 0.25, 5.5, up + 0.7], 0.0);
        }
        mesh.add(&turn, &side);
    }
    for across in [-6.0, -2.0, 2.0] {
        mesh.rod(
            Bright,
            [across, block.size.y / 2.0, -6.0],
            [across, block.size.y / 2.0 + 2.0, -6.0],
            1.0,
            0.2,
            SMALL,
        );
    }
    mesh
}

fn turret_mesh(radius: f64, half: f64) -> Mesh {
    let mut mesh = Mesh::default();
    let coat = radius + MESH_OFFSET;
    let bearing = [(0.0, coat + 3.4), (1.6, coat + 3.4), (2.0, coat + 3.0), (2.6, coat + 3.0), (3.6, coat)];
    mesh.lathe(Charcoal, [0.0, 0.0, -half - 1.0], [0.0, 0.0, half], ROUND, &bearing);
    let drum =
        [(0.0, coat), (2.0 * half, coat), (2.0 * half + 0.8, coat - 0.8), (2.0 * half + 1.2, coat - 3.0)];
    mesh.lathe(Orange, [0.0, 0.0, -half], [0.0, 0.0, half], ROUND, &drum);
    mesh.rod(Charcoal, [0.0, 0.0, half + 1.0], [0.0, 0.0, half + 2.2], 4.0, 0.4, ROUND);
    let out = coat + PLAY + CHEEK;
    for side in [-1.0, 1.0] {
        let y = |distance: f64| [0.0, side * distance, 0.0];
        mesh.rod(Steel, y(coat - 1.0), y(out + 0.6), 3.0, 0.2, ROUND);
        mesh.rod(Charcoal, y(out + 0.5), y(out + 3.6), 4.6, 0.6, ROUND);
        mesh.rod(Orange, y(out + 3.5), y(out + 4.3), 3.2, 0.4, ROUND);
        for bolt in 0..6 {
            let angle = TAU * count(bolt) / 6.0;
            let (x, z) = (3.9 * libm::cos(angle), 3.9 * libm::sin(angle));
            mesh.rod(Bright, [x, side * (out + 3.5), z], [x, side * (out + 4.0), z], 0.35, 0.0, 6);
        }
        let (back, aside) = (-coat - 1.4, 4.2 * side);
        mesh.rod(Charcoal, [back, aside, -half + 2.0], [back, aside, half - 4.0], 2.0, 0.3, ROUND);
        mesh.rod(Cream, [back, aside, -half + 3.6], [back, aside, -half + 6.4], 2.08, 0.1, ROUND);
        mesh.rod(Bright, [back, aside, half - 4.2], [back, aside, half + 2.6], 1.0, 0.1, SMALL);
        mesh.rod(Charcoal, [back, aside - 1.2, half + 2.6], [back, aside + 1.2, half + 2.6], 1.5, 0.2, SMALL);
        mesh.hose(
            Rubber,
            &[
                [back, aside + side * 1.8, -half + 3.0],
                [back - 2.6, aside + side * 2.2, -half + 6.0],
                [back - 2.2, aside + side * 1.6, half - 7.0],
                [back, aside + side * 1.2, half - 5.0],
            ],
            0.45,
        );
    }
    let bridge = [-coat - 2.4, -5.6, half + 1.8];
    mesh.cuboid(Charcoal, bridge, [-coat + 5.0, 5.6, half + 3.0], 0.4);
    mesh
}

/// Adds the two plates of a fork whose axis is Y: round at the back, `reach` long, `2 * high` high at the front.
fn fork(mesh: &mut Mesh, inner: f64, hub: f64, reach: f64, high: f64) {
    const POINTS: usize = 14;
    let from = TAU * 0.21;
    let round = (0..=POINTS).map(|i| {
        let angle = from + (TAU - 2.0 * from) * count(i) / count(POINTS);
        (hub * libm::cos(angle), hub * libm::sin(angle))
    });
    // Counter-clockwise in x and z as seen from -Y, the direction of the frame's z.
    let outline: Vec<(f64, f64)> = round.chain([(reach, -high), (reach, high)]).collect();
    let upright = Frame {
        position: Vector::zeros(),
        rotation: Rotation::from_axis_angle(&Vector::x_axis(), TAU / 4.0),
    };
    for from in [inner, -inner - CHEEK] {
        mesh.plate(Orange, &upright, &outline, from, from + CHEEK);
    }
    for side in [-1.0, 1.0] {
        let y = side * (inner + CHEEK);
        for bolt in 0..8 {
            let angle = TAU * (count(bolt) + 0.5) / 8.0;
            let (x, z) = ((hub - 1.1) * libm::cos(angle), (hub - 1.1) * libm::sin(angle));
            mesh.rod(Bright, [x, y - side * 0.1, z], [x, y + side * 0.4, z], 0.45, 0.0, 6);
        }
    }
}

fn upper_arm(turret: f64, radius: f64) -> Mesh {
    let mut mesh = Mesh::default();
    let (elbow, r) = (T3.upper_arm, radius + MESH_OFFSET);
    let inner = turret + MESH_OFFSET + PLAY;
    let front = turret + 3.0;
    fork(&mut mesh, inner, 6.6, front + 5.0, r + 0.6);
    mesh.cuboid(Orange, [front, -inner - CHEEK, -r - 0.6], [front + 5.0, inner + CHEEK, r + 0.6], 1.2);
    let beam = [
        (3.5, 0.0, 0.0),
        (front, 0.2, 0.6),
        (front + 6.0, 0.4, 0.9),
        (elbow - 8.0, 0.1, 0.3),
        (elbow, 0.0, 0.0),
    ];
    let rings: Vec<Vec<Vector>> = beam.iter().map(|(x, y, z)| rounded(*x, [r + y, r + z], 2.4)).collect();
    mesh.loft(Orange, &rings);
    mesh.rod(Orange, [elbow, -r, 0.0], [elbow, r, 0.0], r + 0.05, 0.05, ROUND);
    for side in [-1.0, 1.0] {
        let y = side * (r + 0.1);
        let [low, high] = if side > 0.0 { [y, y + 0.45] } else { [y - 0.45, y] };
        mesh.cuboid(Cream, [front + 7.0, low, -3.4], [elbow - 8.5, high, 3.4], 0.25);
        lettering(&mut mesh, front + 10.0, y, side);
    }
    let z = r + 3.4;
    for (x, high) in [(front + 2.5, 4.6), (elbow - 3.0, 4.6)] {
        mesh.cuboid(Charcoal, [x - 1.5, -1.6, r - 0.5], [x + 1.5, 1.6, r + high], 0.4);
    }
    mesh.rod(Charcoal, [front + 3.5, 0.0, z], [elbow - 13.0, 0.0, z], 2.2, 0.3, ROUND);
    mesh.rod(Cream, [front + 5.0, 0.0, z], [front + 7.0, 0.0, z], 2.3, 0.1, ROUND);
    mesh.rod(Charcoal, [elbow - 14.0, 0.0, z], [elbow - 12.2, 0.0, z], 2.5, 0.3, ROUND);
    mesh.rod(Bright, [elbow - 12.5, 0.0, z], [elbow - 3.0, 0.0, z], 1.1, 0.1, SMALL);
    for side in [-1.0, 1.0] {
        mesh.hose(
            Rubber,
            &[
                [front + 1.0, side * 4.0, r + 0.3],
                [front + 4.0, side * 3.6, r + 1.6],
                [elbow - 16.0, side * 3.4, r + 1.2],
                [elbow - 13.4, side * 2.2, z - 0.6],
            ],
            0.5,
        );
    }
    mesh
}

/// The letters "T3", readable from the side of the arm that they are on.
fn lettering(mesh: &mut Mesh, x: f64, y: f64, side: f64) {
    // Bars: start and end along the direction of writing, lower and upper edge.
    const T: [[f64; 4]; 2] = [[0.0, 3.6, 3.4, 4.4], [1.3, 2.3, 0.0, 3.6]];
    const THREE: [[f64; 4]; 4] =
        [[4.6, 7.8, 3.4, 4.4], [5.2, 7.8, 1.7, 2.7], [4.6, 7.8, 0.0, 1.0], [6.9, 7.9, 0.2, 4.2]];
    let depth = if side > 0.0 { [y, y + 0.65] } else { [y - 0.65, y] };
    for [from, to, low, high] in T.into_iter().chain(THREE) {
        let [a, b] = if side > 0.0 { [7.9 - to, 7.9 - from] } else { [from, to] };
        mesh.cuboid(Charcoal, [x + a, depth[0], low - 2.2], [x + b, depth[1], high - 2.2], 0.0);
    }
}

fn forearm(upper: f64, radius: f64) -> Mesh {
    let mut mesh = Mesh::default();
    let (wrist, r) = (T3.forearm, radius + MESH_OFFSET);
    let inner = upper + MESH_OFFSET + PLAY;
    mesh.rod(Steel, [0.0, -inner - 0.5, 0.0], [0.0, inner + 0.5, 0.0], r, 0.05, ROUND);
    let front = upper + 1.4;
    fork(&mut mesh, inner, 5.2, front + 4.0, r + 0.3);
    for side in [-1.0, 1.0] {
        let y = |distance: f64| [0.0, side * (inner + CHEEK + distance), 0.0];
        mesh.rod(Charcoal, y(-0.1), y(1.4), 3.0, 0.4, ROUND);
    }
    mesh.cuboid(Orange, [front, -inner - CHEEK, -r - 0.3], [front + 4.0, inner + CHEEK, r + 0.3], 1.0);
    let beam = [(0.0, 0.0), (front + 3.0, 0.5), (front + 9.0, 0.2), (wrist - 4.0, 0.0), (wrist, 0.0)];
    let rings: Vec<Vec<Vector>> = beam.iter().map(|(x, more)| rounded(*x, [r + more; 2], 2.6)).collect();
    mesh.loft(Orange, &rings);
    mesh.rod(Orange, [wrist, -r, 0.0], [wrist, r, 0.0], r + 0.02, 0.05, ROUND);
    mesh.cuboid(Cream, [wrist - 8.0, -r - 0.12, -r - 0.12], [wrist - 6.4, r + 0.12, r + 0.12], 2.0);
    for (aside, up) in [(-3.2, 1.6), (0.0, 2.4), (3.2, 1.6)] {
        let z = r + up;
        mesh.rod(Charcoal, [front + 1.5, aside, z], [front + 10.0, aside, z], 1.45, 0.3, ROUND);
        mesh.rod(Yellow, [front + 2.6, aside, z], [front + 3.6, aside, z], 1.5, 0.05, ROUND);
        mesh.rod(Bright, [front + 9.5, aside, z - 0.3], [wrist - 4.6, aside * 0.8, r + 0.7], 0.5, 0.0, SMALL);
    }
    mesh.cuboid(Charcoal, [wrist - 5.6, -3.8, r - 0.5], [wrist - 3.6, 3.8, r + 2.0], 0.4);
    for side in [-1.0, 1.0] {
        mesh.hose(
            Rubber,
            &[
                [front + 2.0, side * (inner + 0.6), r],
                [front + 7.0, side * (r + 1.4), r - 0.6],
                [wrist - 14.0, side * (r + 1.1), r - 2.0],
                [wrist - 6.0, side * (r + 1.6), 0.6],
                [wrist - 0.5, side * (r + 1.2), 1.4],
                [wrist + 0.4, side * (r - 0.6), 1.0],
            ],
            0.42,
        );
    }
    mesh
}

fn wrist_pitch(forearm: f64, radius: f64) -> Mesh {
    let mut mesh = Mesh::default();
    let out = forearm + MESH_OFFSET;
    for side in [-1.0, 1.0] {
        mesh.rod(Charcoal, [0.0, side * (out - 0.3), 0.0], [0.0, side * (out + 0.7), 0.0], 2.9, 0.3, ROUND);
        mesh.rod(Bright, [0.0, side * (out + 0.6), 0.0], [0.0, side * (out + 0.9), 0.0], 1.2, 0.0, 6);
        let z = side * (radius + 0.2);
        let [low, high] = if side > 0.0 { [z, z + 0.8] } else { [z - 0.8, z] };
        mesh.cuboid(Orange, [-1.5, -2.4, low], [T3.pitch_to_yaw, 2.4, high], 0.25);
        mesh.rod(Orange, [T3.pitch_to_yaw, 0.0, low], [T3.pitch_to_yaw, 0.0, high], 2.4, 0.25, ROUND);
        mesh.rod(Bright, [T3.pitch_to_yaw, 0.0, z], [T3.pitch_to_yaw, 0.0, z + side * 1.1], 1.0, 0.0, 6);
    }
    mesh
}

fn wrist_yaw(radius: f64) -> Mesh {
    let mut mesh = Mesh::default();
    let profile = [
        (0.0, radius - 0.8),
        (0.3, radius - 0.2),
        (radius - 0.5, radius + 0.1),
        (radius + 0.5, radius + 0.1),
        (2.0 * radius - 0.3, radius - 0.2),
        (2.0 * radius, radius - 0.8),
    ];
    mesh.lathe(Charcoal, [0.0, 0.0, -radius], [0.0, 0.0, radius], ROUND, &profile);
    mesh
}

fn end_plate(radius: f64) -> Mesh {
    let mut mesh = Mesh::default();
    let r = radius + 0.06;
    let dome = (0..7).map(|i| {
        let angle = TAU / 4.0 * count(i) / 6.0;
        (r - r * libm::cos(angle), r * libm::sin(angle))
    });
    let plate = r + T3.yaw_to_plate;
    let rest = [(plate - 1.6, r), (plate - 1.3, r - 0.25), (plate - 0.8, r - 0.25)];
    let profile: Vec<(f64, f64)> = dome.chain(rest).collect();
    mesh.lathe(Orange, [-r, 0.0, 0.0], [0.0; 3], ROUND, &profile);
    let x = T3.yaw_to_plate;
    mesh.rod(Charcoal, [1.2, 0.0, 0.0], [2.0, 0.0, 0.0], r + 0.18, 0.1, ROUND);
    mesh.rod(Charcoal, [3.2, 0.0, 0.0], [3.6, 0.0, 0.0], r + 0.12, 0.05, ROUND);
    mesh.rod(Bright, [x - 0.9, 0.0, 0.0], [x, 0.0, 0.0], radius - 0.1, 0.1, ROUND);
    for bolt in 0..8 {
        let angle = TAU * (count(bolt) + 0.5) / 8.0;
        let (y, z) = ((radius + 0.05) * libm::cos(angle), (radius + 0.05) * libm::sin(angle));
        mesh.rod(Bright, [x - 1.5, y * 0.9, z * 0.9], [x - 1.1, y * 0.9, z * 0.9], 0.3, 0.0, 6);
    }
    for (turn, reach) in [(2.3, 1.5), (3.1, 1.9), (3.9, 1.5)] {
        let at = |x: f64, out: f64| [x, out * libm::cos(turn), out * libm::sin(turn)];
        let through =
            [at(0.4, r - 0.4), at(0.9, r + 0.9), at(3.2, r + reach), at(6.4, r + 1.0), at(7.2, r - 0.8)];
        mesh.hose(Rubber, &through, 0.3);
    }
    mesh
}
