//! Tests the meshes of the shipped cell: they cover the collision bodies, are valid glTF, and are small.

use std::{
    collections::{BTreeMap, BTreeSet},
    f64::consts::TAU,
};

use geometry::{
    frame::{Frame, Vector},
    kinematics::T3,
};
use plant::look::Model;
use plant::{
    Cell, CellDescription, Placement, WorkstationAction, bodies,
    clearance::Body,
    convert::{inches, to_frame},
    scene::{Material, Scene, furniture},
};
use rapier3d_f64::prelude::{Pose, TypedShape};

/// A point this far inside a collision body must be inside its mesh, in; chamfers are smaller.
const DEPTH: f64 = 0.05;

fn description() -> CellDescription {
    CellDescription::from_toml(include_str!("../../../data/cell.toml")).unwrap()
}

fn cell(description: &CellDescription) -> Cell {
    let mut cell = Cell::new(description, 1).unwrap();
    for (part, sector) in [("LINKBAR1_BH", 1), ("LCLEVIS_BH", 2)] {
        let (part, unit) = (part.into(), "UNIT_1".into());
        cell.workstation(&WorkstationAction::Place { part, unit, sector, placement: Placement::Random })
            .unwrap();
    }
    cell
}

fn frames(cell: &Cell) -> BTreeMap<String, Frame> {
    let mut frames = BTreeMap::from([("world".to_owned(), Frame::identity())]);
    for link in cell.links().into_iter().chain(cell.fixed_links()) {
        let pose =
            Pose::from_parts(link.position.into(), rapier3d_f64::math::Rotation::from_array(link.rotation));
        let frame = frames[link.parent].compose(&to_frame(&pose));
        frames.insert(link.name, frame);
    }
    frames
}

struct Solid {
    triangles: Vec<[Vector; 3]>,
    low: Vector,
    high: Vector,
}

fn solids(models: &[Model], frames: &BTreeMap<String, Frame>) -> Vec<Solid> {
    let pieces =
        models.iter().flat_map(|model| model.mesh.pieces().iter().map(|piece| (&model.frame, piece)));
    let placed = pieces.map(|(frame, piece)| {
        let place = |point: &Vector| frames[frame].shifted(*point).position;
        let triangles: Vec<[Vector; 3]> =
            piece.triangles.iter().map(|t| [0, 1, 2].map(|i| place(&t[i]))).collect();
        let points = || triangles.iter().flatten();
        let low = points().fold(Vector::repeat(f64::MAX), |low, point| low.inf(point));
        let high = points().fold(Vector::repeat(f64::MIN), |high, point| high.sup(point));
        Solid { low, high, triangles }
    });
    placed.collect()
}

impl Solid {
    /// Winding number of the surface about a point, from the solid angles of its triangles (van Oosterom and Strackee).
    fn winding(&self, point: &Vector) -> f64 {
        if (0..3).any(|i| point[i] < self.low[i] || point[i] > self.high[i]) {
            return 0.0;
        }
        let angles = self.triangles.iter().map(|corners| {
            let [a, b, c] = corners.map(|corner| corner - point);
            let [la, lb, lc] = [a.norm(), b.norm(), c.norm()];
            let under = la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb;
            2.0 * a.dot(&b.cross(&c)).atan2(under)
        });
        angles.sum::<f64>() / (2.0 * TAU)
    }
}

/// Points slightly inside the surface of a body, inches.
fn skin(body: &Body) -> Vec<Vector> {
    const STEPS: [f64; 5] = [-0.9, -0.45, 0.0, 0.45, 0.9];
    let mut points = Vec::new();
    let around = |radius: f64, along: f64, points: &mut Vec<[f64; 3]>| {
        points.extend((0..16).map(|i| {
            let angle = TAU * f64::from(i) / 16.0;
            [radius * angle.cos(), along, radius * angle.sin()]
        }));
    };
    let mut local = Vec::new();
    let frame = match body.shape.as_typed_shape() {
        TypedShape::Cuboid(cuboid) => {
            let half = [0, 1, 2].map(|i| inches(cuboid.half_extents[i]) - DEPTH);
            for axis in 0..3 {
                for (a, b, side) in
                    STEPS.iter().flat_map(|a| STEPS.iter().flat_map(move |b| [(a, b, 1.0), (a, b, -1.0)]))
                {
                    let mut point = [0.0; 3];
                    point[axis] = side * half[axis];
                    point[(axis + 1) % 3] = a * half[(axis + 1) % 3];
                    point[(axis + 2) % 3] = b * half[(axis + 2) % 3];
                    local.push(point);
                }
            }
            to_frame(&body.pose)
        }
        TypedShape::Cylinder(cylinder) => {
            let (radius, half) = (inches(cylinder.radius) - DEPTH, inches(cylinder.half_height) - DEPTH);
            STEPS.iter().for_each(|step| around(radius, step * half, &mut local));
            for side in [-half, half] {
                around(0.9 * radius, side, &mut local);
                around(0.4 * radius, side, &mut local);
            }
            to_frame(&body.pose)
        }
        TypedShape::Capsule(capsule) => {
            let radius = inches(capsule.radius) - DEPTH;
            let half = inches(capsule.half_height());
            STEPS.iter().for_each(|step| around(radius, step * half, &mut local));
            for (side, angle) in
                [(1.0, 0.4_f64), (-1.0, 0.4), (1.0, 1.0), (-1.0, 1.0), (1.0, 1.5), (-1.0, 1.5)]
            {
                around(radius * angle.cos(), side * (half + radius * angle.sin()), &mut local);
            }
            let pose = body.pose * Pose::from_parts(capsule.center(), capsule.rotation_wrt_y());
            to_frame(&pose)
        }
        _ => panic!("{} has another shape", body.name),
    };
    points.extend(local.into_iter().map(|point| frame.shifted(Vector::from(point)).position));
    points
}

#[test]
fn looks_cover_all_collision_shapes() {
    let description = description();
    let cell = cell(&description);
    let frames = frames(&cell);
    let solids = solids(&cell.scene(&[]).models(), &frames);
    let tool = T3.forward(&cell.joints());
    let grippers = &description.gripper;
    let metres = |name: &str| plant::convert::to_pose(&frames[name]);
    let mut bodies = bodies::standing(&description, &furniture(&description));
    bodies.extend(bodies::arm(&description, &cell.joints()));
    bodies.extend(bodies::quick_change(&description, &tool));
    bodies.extend(bodies::worn(&description, &grippers.parts, &tool, grippers.parts.initial_opening));
    bodies.extend(bodies::stored(&description, &grippers.v, "v_gripper", &metres("v_gripper")));
    bodies.extend(bodies::stored(&description, &grippers.tool, "tool_gripper", &metres("tool_gripper")));
    let opening = description.pedestal.hand.initial_opening;
    bodies.extend(bodies::pedestal(&description, &frames["pedestal_hand"], opening));
    bodies.extend(bodies::movable_jaw(&description, &frames["movable_jaw"]));
    for part in cell.parts() {
        let kind = description.part(&part.name).unwrap();
        bodies.push(bodies::part(kind, &metres(&plant::part_link(part.id))));
    }
    assert!(bodies.len() > 90, "{}", bodies.len());
    let drawn = |point: &Vector| solids.iter().any(|solid| solid.winding(point) > 0.5);
    let gap = |body: &Body| {
        let point = skin(body).into_iter().find(|point| !drawn(point))?;
        Some(format!("{} at {:.2?}", body.name, point.as_slice()))
    };
    let gaps: Vec<String> = bodies.iter().filter_map(gap).collect();
    assert!(gaps.is_empty(), "no mesh covers the collision body of {}", gaps.join(", "));
}

#[test]
fn each_look_belongs_to_a_link_and_has_closed_surfaces() {
    let description = description();
    let cell = cell(&description);
    let frames = frames(&cell);
    let models = cell.scene(&[]).models();
    for model in &models {
        assert!(frames.contains_key(&model.frame), "{} is not a link", model.frame);
    }
    let moving = cell.links().into_iter().map(|link| link.name);
    for link in moving {
        assert!(models.iter().any(|model| model.frame == link), "{link} has no look");
    }
    for (solid, at) in solids(&models, &frames).iter().zip(0..) {
        // Each edge occurs equally often in both directions.
        let mut edges: BTreeMap<[[i64; 3]; 2], i64> = BTreeMap::new();
        let key = |point: &Vector| [0, 1, 2].map(|i| (point[i] * 1e5).round() as i64);
        for [a, b, c] in &solid.triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let (from, to) = (key(from), key(to));
                let (edge, way) = if from < to { ([from, to], 1) } else { ([to, from], -1) };
                *edges.entry(edge).or_default() += way;
            }
        }
        let open = edges.values().filter(|ways| **ways != 0).count();
        assert_eq!(open, 0, "piece {at} near {:?} is open", solid.low);
    }
    for label in cell.scene(&[]).labels() {
        assert!(frames.contains_key(label.frame), "{label:?}");
    }
}

fn parts_of(glb: &[u8]) -> (serde_json::Value, &[u8]) {
    let number = |at: usize| u32::from_le_bytes(glb[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((&glb[..4], number(4), number(8)), (&b"glTF"[..], 2, glb.len()));
    let json = number(12);
    assert_eq!((&glb[16..20], json % 4), (&b"JSON"[..], 0));
    let binary = 20 + json;
    assert_eq!((&glb[binary + 4..binary + 8], number(binary)), (&b"BIN\0"[..], glb.len() - binary - 8));
    (serde_json::from_slice(&glb[20..binary]).unwrap(), &glb[binary + 8..])
}

#[test]
fn mesh_files_are_gltf_with_y_up_and_unit_normals() {
    let description = description();
    for model in Scene::new(&description, []).models() {
        let glb = model.glb();
        let (json, binary) = parts_of(&glb);
        assert_eq!(json["buffers"][0]["byteLength"], binary.len());
        let floats = |accessor: &serde_json::Value| -> Vec<f32> {
            let view = &json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
            let [start, length] =
                ["byteOffset", "byteLength"].map(|key| view[key].as_u64().unwrap() as usize);
            let bytes = binary[start..start + length].chunks_exact(4);
            bytes.map(|bytes| f32::from_le_bytes(bytes.try_into().unwrap())).collect()
        };
        let mut highest = f32::MIN;
        for primitive in json["meshes"][0]["primitives"].as_array().unwrap() {
            let accessor =
                |key: &str| &json["accessors"][primitive["attributes"][key].as_u64().unwrap() as usize];
            let (positions, normals) = (floats(accessor("POSITION")), floats(accessor("NORMAL")));
            assert_eq!(positions.len(), normals.len());
            for normal in normals.chunks_exact(3) {
                let length = normal.iter().map(|value| value * value).sum::<f32>().sqrt();
                assert!((length - 1.0).abs() < 1e-3, "{}: {normal:?}", model.name);
            }
            highest = positions.chunks_exact(3).map(|point| point[1]).fold(highest, f32::max);
            let indices = &json["accessors"][primitive["indices"].as_u64().unwrap() as usize];
            assert_eq!(indices["count"].as_u64().unwrap() % 3, 0);
        }
        let top = model.mesh.pieces().iter().flat_map(|piece| piece.triangles.iter().flatten());
        let top = top.map(|point| point.z).fold(f64::MIN, f64::max);
        assert!(
            (f64::from(highest) - top * 0.0254).abs() < 1e-4,
            "{}: Z of the link is Y of the file",
            model.name
        );
    }
}

#[test]
fn looks_are_small_and_deterministic() {
    let description = description();
    let scene = Scene::new(&description, (1..).zip(&description.part));
    let made = scene.models();
    let triangles: usize = made.iter().map(|model| model.mesh.triangles()).sum();
    let bytes: usize = made.iter().map(|model| model.glb().len()).sum();
    assert!(triangles < 60_000 && bytes < 1_500_000, "{triangles} triangles, {bytes} bytes");
    let again = scene.models();
    assert!(made.iter().zip(&again).all(|(a, b)| a.glb() == b.glb()));
}

#[test]
fn link_shapes_have_colours_of_their_mesh() {
    let description = description();
    let scene = Scene::new(&description, (1..).zip(&description.part));
    let models = scene.models();
    let (groups, links): (Vec<&Model>, Vec<&Model>) = models.iter().partition(|model| model.frame == "world");
    for link in scene.links() {
        let own = links.iter().filter(|model| model.name == link.name);
        let meshes: Vec<_> = if own.clone().count() > 0 { own.collect() } else { groups.iter().collect() };
        let materials = meshes.iter().flat_map(|model| model.mesh.pieces()).map(|piece| piece.material);
        let materials: BTreeSet<Material> = materials.collect();
        for visual in &link.visuals {
            assert!(materials.contains(&visual.colour), "{}: {:?}", link.name, visual.colour);
        }
    }
}

#[test]
fn kinds_of_parts_differ_in_colour() {
    let description = description();
    let colour = |name: &str| Material::of_part(description.part(name).unwrap());
    let kinds = ["LINKBAR1", "LCLEVIS", "SHAFT", "DRILL-2"].map(colour);
    for (i, kind) in kinds.iter().enumerate() {
        assert!(!kinds[..i].contains(kind), "{kind:?} twice");
    }
    assert_eq!(colour("LINKBAR1_BH"), colour("LINKBAR1"));
}
