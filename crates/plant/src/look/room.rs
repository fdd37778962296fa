//! Meshes of fixed things. The mesh of a block contains the block's own box; all others are out of the arm's reach.

use crate::{
    CellDescription,
    description::Kind,
    look::{
        Model, arm, machine,
        mesh::{Mesh, ROUND, SMALL, count},
    },
    scene::{
        Block,
        Material::{
            Blue, Bright, Charcoal, Cream, Green, Light, Maple, Orange, PaleBlue, Petrol, Red, Rubber, Slate,
            Steel, Yellow,
        },
    },
};
use geometry::frame::{Frame, Vector};

const EDGE: f64 = 0.03; // chamfer of surfaces that parts lie on or lean against, in
const BEVEL: f64 = 0.25; // chamfer of surfaces without contacts, in
/// Height of a cover above the body under it, in: two faces in one plane would flicker.
const PAINT: f64 = 0.015;
const SPINDLE: f64 = 10.0; // height of the spindle above the top of the jaws, in
/// The fenced area, as shares of half the floor: left, right, back and front border.
const FENCED_AREA: [f64; 4] = [-0.68, 0.92, 0.44, -0.78];

/// The models of the fixed things in world coordinates, in groups that a viewer can hide.
#[must_use]
pub fn models(cell: &CellDescription, blocks: &[&Block]) -> Vec<Model> {
    const GROUPS: [&str; 7] = ["floor", "fence", "base", "machine", "trays", "benches", "holsters"];
    let mut meshes: Vec<Mesh> = GROUPS.iter().map(|_| Mesh::default()).collect();
    for block in blocks {
        let (group, mesh) = look(cell, block);
        if let Some(at) = GROUPS.iter().position(|name| *name == group) {
            meshes[at].add(&block.frame, &mesh);
        }
    }
    let floor = blocks.iter().find(|block| block.name == "floor");
    if let Some(floor) = floor {
        let top = floor.frame.position.z + floor.size.z / 2.0;
        paint(&mut meshes[0], floor, top);
        fence(&mut meshes[1], floor, top);
        for block in blocks.iter().filter(|block| block.name.ends_with("_foot")) {
            post(&mut meshes[6], &block.frame.position, top);
        }
        for block in blocks.iter().filter(|block| block.name == "brush_bracket") {
            post(&mut meshes[5], &block.frame.position, top);
        }
        if let Some(base) = blocks.iter().find(|block| block.name == "robot_base") {
            cabinets(&mut meshes[2], base, top);
        }
    }
    let named = GROUPS.into_iter().zip(meshes).filter(|(_, mesh)| mesh.triangles() > 0);
    named.map(|(name, mesh)| Model::standing(name, mesh)).collect()
}

fn look(cell: &CellDescription, block: &Block) -> (&'static str, Mesh) {
    let boxed = |edge| {
        let mut mesh = Mesh::default();
        mesh.block(block.colour(), [0.0; 3], block.size.into(), edge);
        mesh
    };
    let place = |point: Vector| block.frame.inverse().shifted(point).position;
    match (block.kind, block.name.as_str()) {
        (Kind::Tray, name) => ("trays", tray(block, name.ends_with("_floor"))),
        (Kind::Holster, _) => ("holsters", boxed(EDGE)),
        (Kind::Drum, _) => ("machine", boxed(EDGE)),
        (_, "floor") => ("floor", boxed(0.0)),
        (_, "robot_base") => ("base", arm::base(block)),
        (_, "machine_pallet") => ("machine", machine::pallet(block)),
        (_, "machine_column") => {
            let up = place(Vector::from(cell.vise.position)).z + SPINDLE;
            ("machine", machine::column(block, up))
        }
        (_, "tool_drum") => {
            let exchange = cell.drum.pose.frame().map_or_else(Vector::zeros, |frame| frame.position);
            ("machine", machine::drum(block, place(exchange).into()))
        }
        (_, "horizontal_fixture" | "vertical_fixture") => ("machine", tower(block)),
        (_, name) if name.starts_with("nest_") => ("machine", boxed(EDGE)),
        (_, name) if name.starts_with("pot_") || name.starts_with("cradle_") => ("trays", boxed(EDGE)),
        (_, name) if name == cell.pedestal.stand => ("benches", stand(block)),
        (_, "brush_bracket") => ("benches", boxed(BEVEL)),
        _ if block.size.min() >= 8.0 => ("benches", bench(block)),
        _ => ("benches", boxed(EDGE)),
    }
}

/// A block of a tray; the floor has lines between the sectors.
fn tray(block: &Block, floor: bool) -> Mesh {
    let mut mesh = Mesh::default();
    let [x, y, z] = (block.size / 2.0).into();
    mesh.cuboid(Blue, [-x, -y, -z], [x, y, z], EDGE);
    if floor {
        for (long, wide) in [(x - 1.0, 0.12), (0.12, y - 1.0)] {
            mesh.cuboid(PaleBlue, [-long, -wide, 0.0], [long, wide, z + 0.015], 0.0);
        }
    } else {
        mesh.cuboid(PaleBlue, [-x - 0.04, -y - 0.04, z - 0.45], [x + 0.04, y + 0.04, z - 0.15], 0.0);
    }
    mesh
}

fn tower(block: &Block) -> Mesh {
    let mut mesh = Mesh::default();
    let [x, y, z] = (block.size / 2.0).into();
    mesh.cuboid(Steel, [-x, -y, -z], [x, y, z], 0.06);
    mesh.cuboid(Charcoal, [-x - 0.6, -y - 0.6, -z], [x + 0.6, y + 0.6, -z + 1.0], 0.15);
    for row in 0..3 {
        for (a, b) in [(-1.6, -1.0), (1.6, -1.0), (0.0, 1.0)] {
            let up = -z + 2.6 + 2.4 * count(row);
            mesh.rod(Rubber, [-x + 0.1, a, up], [-x - 0.03, a, up], 0.35, 0.0, SMALL);
            mesh.rod(Rubber, [a, b * (y - 0.1), up], [a, b * (y + 0.03), up], 0.35, 0.0, SMALL);
        }
    }
    mesh
}

fn bench(block: &Block) -> Mesh {
    let mut mesh = Mesh::default();
    let [x, y, z] = (block.size / 2.0).into();
    mesh.cuboid(Slate, [-x, -y, -z], [x, y, z], 0.15);
    mesh.cuboid(Charcoal, [-x - 0.2, -y - 0.2, -z], [x + 0.2, y + 0.2, -z + 3.0], 0.15);
    mesh.cuboid(Maple, [-x - 0.7, -y - 0.7, z - 1.8], [x + 0.7, y + 0.7, z + PAINT], 0.2);
    let mut front = |from: f64, to: f64, along_y: bool| {
        let rows = 4;
        let high = (2.0 * z - 6.5) / count(rows);
        for row in 0..rows {
            let low = -z + 3.8 + high * count(row);
            let mut panel = |material, inset: f64, out: f64, bottom: f64, top: f64| {
                for side in [-1.0, 1.0] {
                    let (depth, reach) = if along_y { (x, out) } else { (y, out) };
                    let [a, b] =
                        if side > 0.0 { [depth - 0.1, depth + reach] } else { [-depth - reach, 0.1 - depth] };
                    let (low_corner, high_corner) = if along_y {
                        ([a, from + inset, bottom], [b, to - inset, top])
                    } else {
                        ([from + inset, a, bottom], [to - inset, b, top])
                    };
                    mesh.cuboid(material, low_corner, high_corner, 0.08);
                }
            };
            panel(Cream, 0.5, 0.3, low, low + high - 0.5);
            panel(Charcoal, (to - from) / 3.0, 0.7, low + high - 2.0, low + high - 1.3);
        }
    };
    let columns = if y > 20.0 { 2 } else { 1 };
    for column in 0..columns {
        let step = 2.0 * y / count(columns);
        front(-y + step * count(column), -y + step * (count(column) + 1.0), true);
    }
    front(-x, x, false);
    mesh
}

fn stand(block: &Block) -> Mesh {
    let mut mesh = Mesh::default();
    let [x, y, z] = (block.size / 2.0).into();
    mesh.cuboid(Slate, [-x, -y, -z], [x, y, z], 0.12);
    mesh.cuboid(Charcoal, [-x - 2.0, -y - 2.0, -z], [x + 2.0, y + 2.0, -z + 1.2], 0.3);
    mesh.cuboid(Steel, [-x - 0.5, -y - 0.5, z - 1.6], [x + 0.5, y + 0.5, z + PAINT], 0.15);
    mesh.rod(Charcoal, [0.0, 0.0, z - 1.5], [0.0, 0.0, z + 2.0 * PAINT], x.min(y) + 0.4, 0.02, ROUND);
    mesh.cuboid(Yellow, [-x - 0.05, -y - 0.05, z - 5.0], [x + 0.05, y + 0.05, z - 4.0], 0.0);
    mesh.rod(Charcoal, [x - 0.2, 0.0, z - 7.5], [x + 3.6, 0.0, z - 7.5], 1.9, 0.3, ROUND);
    mesh.rod(Bright, [x + 3.4, 0.0, z - 7.5], [x + 3.9, 0.0, z - 7.5], 1.0, 0.1, SMALL);
    for louver in 0..5 {
        let up = 2.0 - 1.6 * count(louver);
        mesh.cuboid(Rubber, [-4.0, -y - 0.12, up], [4.0, 0.2 - y, up + 0.6], 0.0);
        mesh.cuboid(Rubber, [-4.0, y - 0.2, up], [4.0, y + 0.12, up + 0.6], 0.0);
    }
    mesh
}

/// Adds a post from the floor up to an object that would otherwise float.
fn post(mesh: &mut Mesh, under: &Vector, floor: f64) {
    mesh.rod(Slate, [under.x, under.y, floor], [under.x, under.y, under.z], 1.6, 0.0, ROUND);
    mesh.rod(Charcoal, [under.x, under.y, floor], [under.x, under.y, floor + 0.8], 4.2, 0.2, ROUND);
}

fn yard(floor: &Block) -> [f64; 4] {
    let (middle, half) = (floor.frame.position, floor.size / 2.0);
    let at = |share: f64, axis: usize| middle[axis] + share * half[axis];
    [at(FENCED_AREA[0], 0), at(FENCED_AREA[1], 0), at(FENCED_AREA[2], 1), at(FENCED_AREA[3], 1)]
}

fn paint(mesh: &mut Mesh, floor: &Block, top: f64) {
    let [left, right, back, front] = yard(floor);
    let high = top + 0.08;
    let mut line = |low: [f64; 2], to: [f64; 2]| {
        mesh.cuboid(Yellow, [low[0], low[1], top - 0.5], [to[0], to[1], high], 0.0);
    };
    let wide = 1.5;
    line([left - wide, back - wide], [right + wide, back + wide]);
    line([left - wide, front - wide], [left + wide, back - wide]);
    line([right - wide, front - wide], [right + wide, back - wide]);
    line([left + wide, front - wide], [right - wide, front + wide]);
    line([left + wide, front + 9.0 - wide], [right - wide, front + 9.0 + wide]);
    let upright = Frame { position: Vector::new(0.0, 0.0, top), ..Frame::identity() };
    let steps = ((right - left) / 12.0) as usize;
    for step in 0..steps {
        let x = left + 4.0 + 12.0 * count(step);
        let stripe = [
            (x, front + wide),
            (x + 3.0, front + wide),
            (x + 8.0, front + 9.0 - wide),
            (x + 5.0, front + 9.0 - wide),
        ];
        mesh.plate(Yellow, &upright, &stripe, -0.5, 0.08);
    }
}

/// Fence at the back and on the left, light curtain in front; the machine closes the right side.
fn fence(mesh: &mut Mesh, floor: &Block, top: f64) {
    const HIGH: f64 = 66.0;
    let [left, right, back, front] = yard(floor);
    let mut run = |from: [f64; 2], to: [f64; 2]| {
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let length = libm::hypot(dx, dy);
        let frame = Frame {
            position: Vector::new(from[0], from[1], top),
            rotation: geometry::frame::Rotation::from_axis_angle(&Vector::z_axis(), libm::atan2(dy, dx)),
        };
        let mut panels = Mesh::default();
        let posts = (length / 48.0).round().max(1.0);
        let step = length / posts;
        for number in 0..=(posts as usize) {
            let x = step * count(number);
            panels.cuboid(Yellow, [x - 1.2, -1.2, 0.0], [x + 1.2, 1.2, HIGH + 1.0], 0.2);
            panels.cuboid(Charcoal, [x - 2.6, -2.6, 0.0], [x + 2.6, 2.6, 0.6], 0.1);
        }
        for (low, high) in [(5.0, 6.2), (HIGH / 2.0, HIGH / 2.0 + 0.8), (HIGH - 1.2, HIGH)] {
            panels.cuboid(Charcoal, [0.0, -0.5, low], [length, 0.5, high], 0.0);
        }
        for wire in 1..((length / 4.0) as usize) {
            let x = 4.0 * count(wire);
            panels.cuboid(Charcoal, [x - 0.12, -0.12, 5.0], [x + 0.12, 0.12, HIGH - 0.5], 0.0);
        }
        mesh.add(&frame, &panels);
    };
    run([left, back], [right, back]);
    run([left, front], [left, back]);
    for x in [left, right] {
        let y = front - 4.0;
        mesh.cuboid(Yellow, [x - 2.0, y - 2.0, top], [x + 2.0, y + 2.0, top + 60.0], 0.4);
        mesh.cuboid(Charcoal, [x - 4.0, y - 4.0, top], [x + 4.0, y + 4.0, top + 1.0], 0.2);
        let [a, b] = if x < 0.0 { [x + 1.9, x + 2.2] } else { [x - 2.2, x - 1.9] };
        mesh.cuboid(Rubber, [a, y - 0.8, top + 10.0], [b, y + 0.8, top + 56.0], 0.0);
        mesh.rod(Green, [x, y, top + 60.0], [x, y, top + 63.0], 1.4, 0.3, ROUND);
    }
}

/// Behind the robot, out of the base's range: the controller and the hydraulic power unit.
fn cabinets(mesh: &mut Mesh, base: &Block, top: f64) {
    let [x, y] = [base.frame.position.x, base.frame.position.y + base.size.y / 2.0 + 26.0];
    let mut at = Mesh::default();
    at.cuboid(Cream, [-62.0, -10.0, 0.0], [-26.0, 10.0, 66.0], 0.6);
    at.cuboid(Charcoal, [-62.4, -10.4, 0.0], [-25.6, 10.4, 5.0], 0.4);
    at.cuboid(Orange, [-62.1, -10.1, 56.0], [-25.9, 10.1, 58.5], 0.2);
    at.cuboid(Rubber, [-44.2, -10.15, 6.0], [-43.8, -9.8, 55.0], 0.0);
    at.cuboid(Charcoal, [-59.0, -10.6, 38.0], [-47.0, -9.8, 50.0], 0.4);
    at.cuboid(Light, [-58.0, -10.75, 40.5], [-48.0, -10.5, 49.0], 0.1);
    for (key, lamp) in [Green, Yellow, Red, Steel, Steel, Steel].into_iter().enumerate() {
        let (column, row) = (count(key % 3), count(key / 3));
        let (across, up) = (-40.0 + 4.0 * column, 48.0 - 4.0 * row);
        at.rod(lamp, [across, -9.9, up], [across, -10.9, up], 1.0, 0.2, SMALL);
    }
    at.cuboid(Petrol, [22.0, -12.0, 3.0], [58.0, 12.0, 21.0], 0.8);
    at.cuboid(Charcoal, [20.0, -13.0, 0.0], [60.0, 13.0, 3.2], 0.4);
    at.rod(Charcoal, [26.0, -3.0, 27.0], [42.0, -3.0, 27.0], 5.5, 0.8, ROUND);
    for fin in 0..6 {
        let from = 28.0 + 2.2 * count(fin);
        at.rod(Slate, [from, -3.0, 27.0], [from + 0.7, -3.0, 27.0], 5.9, 0.0, ROUND);
    }
    at.rod(Steel, [42.0, -3.0, 27.0], [49.0, -3.0, 27.0], 3.4, 0.5, ROUND);
    at.cuboid(Charcoal, [27.0, -6.0, 20.5], [50.0, 0.0, 23.5], 0.3);
    at.rod(Red, [53.0, 5.0, 21.0], [53.0, 5.0, 44.0], 3.6, 1.6, ROUND);
    at.rod(Bright, [53.0, 5.0, 43.5], [53.0, 5.0, 46.0], 1.0, 0.2, SMALL);
    mesh.add(&Frame { position: Vector::new(x, y, top), ..Frame::identity() }, &at);
    let behind = base.frame.position.y + base.size.y / 2.0;
    let ports = base.frame.position.z - 6.0;
    for (number, across) in [-6.0, -2.0, 2.0].into_iter().enumerate() {
        let turn = 1.5 * count(number);
        let through = [
            [across, behind + 1.5, ports],
            [across + 1.0, behind + 6.0, ports - 1.0],
            [across + 6.0, behind + 9.0 + turn, top + 2.0],
            [x + 15.0, y - 9.0 + turn, top + 1.6],
            [x + 21.0, y - 6.0 + 2.0 * turn, top + 9.0],
            [x + 23.0, y - 6.0 + 2.0 * turn, top + 12.0],
        ];
        mesh.hose(Rubber, &through, 0.75);
    }
}
