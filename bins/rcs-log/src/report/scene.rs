//! Draws the cell as SVG: the boxes and cylinders of its description at the poses in the log.
//!
//! Parallel projection, so that lengths can be compared, seen from the operator's side, from the right and from above.
//! Close-ups of a link are seen straight from above and from the side. Faces that point away are left out; the others
//! are painted from the farthest to the nearest.

use std::{collections::HashMap, fmt::Write as _};

use record::{Link, Transform};
use roxmltree::{Document, Node};

/// Size of a picture, pixels.
const SIZE: [f64; 2] = [560.0, 380.0];
/// Number of sides of a drawn cylinder.
const SIDES: usize = 14;
/// Viewing direction, into the picture, and direction of the light; approximate unit vectors in the world.
const EYE: [f64; 3] = [-0.35, 0.80, -0.49];
/// Viewing direction straight down: +X to the right, +Y up.
pub const FROM_ABOVE: [f64; 3] = [0.0, 0.02, -1.0];
/// Viewing direction from the operator's side: +X to the right, +Z up.
pub const FROM_THE_SIDE: [f64; 3] = [0.0, 1.0, -0.02];
/// A point above the reach of the raised arm, m: pictures of the whole cell include it.
const OVER_THE_ARM: [f64; 3] = [0.0, 0.0, 1.35];
/// Half the width of a close-up, m.
const NEAR: f64 = 0.55;
const LIGHT: [f64; 3] = [0.35, -0.55, 0.76];
/// Links that would hide others or fill the picture.
const LEFT_OUT: [&str; 2] = ["floor", "machine_column"];

type Point = [f64; 3];
/// Depth, colour, and corners in the picture, m.
type Face = (f64, String, Vec<[f64; 2]>);

/// A body with its pose in its link.
struct Visual {
    at: Transform,
    faces: Vec<Vec<Point>>,
    /// Red, green, blue, each 0 to 1.
    color: Point,
}

/// The description of the cell, and the poses of its links.
pub struct Scene {
    visuals: Vec<(String, Vec<Visual>)>,
    places: HashMap<String, (String, Transform)>,
    /// Middle and pixels per metre, the same for all pictures of the whole cell.
    view: Option<([f64; 2], f64)>,
}

impl Scene {
    /// A scene from a URDF, without poses. Elements that cannot be parsed are not drawn.
    pub fn new(urdf: &str) -> Self {
        let document = Document::parse(urdf).ok();
        let robot = document.as_ref().map(Document::root_element);
        let links = robot.into_iter().flat_map(|robot| children(robot, "link").collect::<Vec<_>>());
        let link = |link: Node<'_, '_>| {
            let name = link.attribute("name")?.to_owned();
            let visuals: Vec<Visual> = children(link, "visual").filter_map(visual).collect();
            (!visuals.is_empty() && !LEFT_OUT.contains(&name.as_str())).then_some((name, visuals))
        };
        Self { visuals: links.filter_map(link).collect(), places: HashMap::new(), view: None }
    }

    /// Updates the poses of links.
    pub fn place(&mut self, places: Vec<(Link, Transform)>) {
        self.places.extend(places.into_iter().map(|(link, place)| (link.name, (link.parent, place))));
    }

    /// The pose of a link in the world; `None` if the log has no pose of it yet.
    fn world(&self, link: &str) -> Option<Transform> {
        let (mut at, mut name) = (Transform::IDENTITY, link);
        // A chain of links is not longer than the number of links, so the loop ends even for a cycle.
        for _ in 0..=self.places.len() {
            let Some((parent, place)) = self.places.get(name) else { return (name == "world").then_some(at) };
            at = compose(place, &at);
            name = parent;
        }
        None
    }

    /// Draws the whole cell at the present poses.
    pub fn draw(&mut self) -> String {
        let faces = self.faces(EYE);
        let (right, up) = basis(EYE);
        let over = [dot(OVER_THE_ARM, right), -dot(OVER_THE_ARM, up)];
        let view = *self.view.get_or_insert_with(|| fit(&faces, over));
        svg(faces, view)
    }

    /// Draws the surroundings of a link along a viewing direction; `None` if its pose is unknown.
    pub fn near(&self, link: &str, eye: Point) -> Option<String> {
        let (right, up) = basis(eye);
        let at = self.world(link)?.position;
        let view = ([dot(at, right), -dot(at, up)], SIZE[0] / (2.0 * NEAR));
        Some(svg(self.faces(eye), view))
    }

    /// The visible faces along a viewing direction: depth, colour, corners in the picture, m.
    fn faces(&self, eye: Point) -> Vec<Face> {
        let (right, up) = basis(eye);
        let mut faces = Vec::new();
        for (name, visuals) in &self.visuals {
            let Some(link) =
                self.world(name).filter(|place| *place != Transform::IDENTITY || name == "world")
            else {
                continue;
            };
            for visual in visuals {
                let at = compose(&link, &visual.at);
                for face in &visual.faces {
                    let corners: Vec<Point> = face.iter().map(|corner| apply(&at, *corner)).collect();
                    let normal = normal(&corners);
                    if dot(normal, eye) >= 0.0 {
                        continue;
                    }
                    let depth =
                        corners.iter().map(|corner| dot(*corner, eye)).sum::<f64>() / corners.len() as f64;
                    let flat =
                        corners.iter().map(|corner| [dot(*corner, right), -dot(*corner, up)]).collect();
                    faces.push((depth, shade(visual.color, normal), flat));
                }
            }
        }
        faces
    }
}

/// An SVG of the faces around a middle at a scale in pixels per metre, the farthest face first.
fn svg(mut faces: Vec<Face>, (middle, scale): ([f64; 2], f64)) -> String {
    faces.sort_by(|a, b| b.0.total_cmp(&a.0));
    let [width, height] = SIZE;
    let mut out = format!("<svg class=\"cell\" viewBox=\"0 0 {width} {height}\" role=\"img\">");
    for (_, fill, corners) in &faces {
        let place = |corner: &[f64; 2]| {
            let x = (corner[0] - middle[0]).mul_add(scale, width / 2.0);
            [x, (corner[1] - middle[1]).mul_add(scale, height / 2.0)]
        };
        let corners: Vec<[f64; 2]> = corners.iter().map(place).collect();
        let outside = |axis: usize| {
            corners.iter().all(|corner| corner[axis] < 0.0)
                || corners.iter().all(|corner| corner[axis] > SIZE[axis])
        };
        if outside(0) || outside(1) {
            continue;
        }
        let _ = write!(out, "<path fill=\"{fill}\" d=\"");
        for (index, [x, y]) in corners.iter().enumerate() {
            let _ = write!(out, "{}{x:.1} {y:.1}", if index == 0 { 'M' } else { 'L' });
        }
        out.push_str("Z\"/>");
    }
    out + "</svg>"
}

fn children<'a, 'input>(node: Node<'a, 'input>, name: &'a str) -> impl Iterator<Item = Node<'a, 'input>> {
    node.children().filter(move |child| child.has_tag_name(name))
}

/// The numbers of an XML attribute.
fn numbers<const N: usize>(node: Node<'_, '_>, attribute: &str) -> Option<[f64; N]> {
    let numbers = node.attribute(attribute)?.split_whitespace().map(|number| number.parse().ok());
    numbers.collect::<Option<Vec<f64>>>()?.try_into().ok()
}

fn visual(visual: Node<'_, '_>) -> Option<Visual> {
    let shape = children(visual, "geometry").next()?.first_element_child()?;
    let faces = match shape.tag_name().name() {
        "box" => cuboid(numbers(shape, "size")?),
        "cylinder" => {
            let [radius] = numbers(shape, "radius")?;
            let [length] = numbers(shape, "length")?;
            cylinder(radius, length)
        }
        _ => return None,
    };
    let origin = children(visual, "origin").next();
    let of = |attribute| origin.and_then(|origin| numbers(origin, attribute)).unwrap_or_default();
    let color = visual.descendants().find(|node| node.has_tag_name("color"));
    let color: Option<[f64; 4]> = color.and_then(|color| numbers(color, "rgba"));
    let [red, green, blue, _] = color.unwrap_or([0.6, 0.6, 0.6, 1.0]);
    let at = Transform { position: of("xyz"), rotation: quaternion(of("rpy")) };
    Some(Visual { at, faces, color: [red, green, blue] })
}

/// The faces of a box centred at the origin, each counter-clockwise as seen from outside.
fn cuboid(size: Point) -> Vec<Vec<Point>> {
    let corner = |x: f64, y: f64, z: f64| [x * size[0] / 2.0, y * size[1] / 2.0, z * size[2] / 2.0];
    let face = |axis: usize, side: f64| {
        let turn = |a: f64, b: f64| {
            let mut at = [0.0; 3];
            (at[axis], at[(axis + 1) % 3], at[(axis + 2) % 3]) = (side, a * side, b);
            corner(at[0], at[1], at[2])
        };
        vec![turn(-1.0, -1.0), turn(1.0, -1.0), turn(1.0, 1.0), turn(-1.0, 1.0)]
    };
    (0..3).flat_map(|axis| [face(axis, 1.0), face(axis, -1.0)]).collect()
}

/// The faces of a cylinder along Z, centred at the origin.
fn cylinder(radius: f64, length: f64) -> Vec<Vec<Point>> {
    let at = |side: usize, z: f64| {
        let angle = side as f64 / SIDES as f64 * std::f64::consts::TAU;
        [radius * angle.cos(), radius * angle.sin(), z]
    };
    let (top, bottom) = (length / 2.0, -length / 2.0);
    let mut faces: Vec<Vec<Point>> = (0..SIDES)
        .map(|side| vec![at(side, bottom), at(side + 1, bottom), at(side + 1, top), at(side, top)])
        .collect();
    faces.push((0..SIDES).map(|side| at(side, top)).collect());
    faces.push((0..SIDES).rev().map(|side| at(side, bottom)).collect());
    faces
}

/// Quaternion of a URDF rotation about fixed axes: roll about X, then pitch about Y, then yaw about Z.
fn quaternion([roll, pitch, yaw]: Point) -> [f64; 4] {
    let [(sr, cr), (sp, cp), (sy, cy)] = [roll, pitch, yaw].map(|angle| (angle / 2.0).sin_cos());
    [
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    ]
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(a: Point) -> Point {
    let length = dot(a, a).sqrt().max(1e-12);
    a.map(|value| value / length)
}

/// Directions of right and up in a picture along a viewing direction that is not vertical.
fn basis(eye: Point) -> (Point, Point) {
    let right = unit(cross(eye, [0.0, 0.0, 1.0]));
    (right, unit(cross(right, eye)))
}

/// Outward normal of a planar face.
fn normal(corners: &[Point]) -> Point {
    match corners {
        [a, b, c, ..] => {
            let side = |to: &Point| [to[0] - b[0], to[1] - b[1], to[2] - b[2]];
            unit(cross(side(c), side(a)))
        }
        _ => [0.0; 3],
    }
}

fn rotate([x, y, z, w]: [f64; 4], point: Point) -> Point {
    let axis = [x, y, z];
    let once = cross(axis, point).map(|value| 2.0 * value);
    let twice = cross(axis, once);
    std::array::from_fn(|at| point[at] + w * once[at] + twice[at])
}

fn apply(place: &Transform, point: Point) -> Point {
    let turned = rotate(place.rotation, point);
    std::array::from_fn(|at| place.position[at] + turned[at])
}

/// The pose `inner`, given in the frame `outer`, in the frame that `outer` is given in.
fn compose(outer: &Transform, inner: &Transform) -> Transform {
    let ([ax, ay, az, aw], [bx, by, bz, bw]) = (outer.rotation, inner.rotation);
    Transform {
        position: apply(outer, inner.position),
        rotation: [
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
            aw * bw - ax * bx - ay * by - az * bz,
        ],
    }
}

/// The shaded colour of a face, as `#rrggbb`.
fn shade(color: Point, normal: Point) -> String {
    let light = 0.28f64.mul_add(dot(normal, unit(LIGHT)), 0.74);
    let byte = |part: f64| (part * light * 255.0).clamp(0.0, 255.0).round() as u8;
    format!("#{:02x}{:02x}{:02x}", byte(color[0]), byte(color[1]), byte(color[2]))
}

/// Middle and scale at which all faces and one point fit into the picture.
fn fit(faces: &[Face], point: [f64; 2]) -> ([f64; 2], f64) {
    let (mut least, mut most) = (point, point);
    for corner in faces.iter().flat_map(|(_, _, corners)| corners) {
        for axis in 0..2 {
            (least[axis], most[axis]) = (least[axis].min(corner[axis]), most[axis].max(corner[axis]));
        }
    }
    if faces.is_empty() {
        return ([0.0; 2], 1.0);
    }
    let scale = (0..2).map(|axis| 0.96 * SIZE[axis] / (most[axis] - least[axis]).max(1e-3));
    ([0, 1].map(|axis| f64::midpoint(least[axis], most[axis])), scale.fold(f64::MAX, f64::min))
}

#[cfg(test)]
mod tests {
    use super::*;

    const URDF: &str = "<robot name='r'><link name='world'/><link name='base'><visual><origin xyz='0 0 1' rpy='0 0 0'/>\
        <geometry><box size='1 2 3'/></geometry></visual></link><link name='arm'><visual><geometry>\
        <cylinder radius='1' length='2'/></geometry></visual></link></robot>";

    fn at(position: Point) -> Transform {
        Transform { position, ..Transform::IDENTITY }
    }

    fn link(name: &str, parent: &str) -> Link {
        Link { name: name.into(), parent: parent.into() }
    }

    #[test]
    fn all_faces_look_outward() {
        for face in cuboid([1.0, 2.0, 3.0]).iter().chain(&cylinder(0.5, 2.0)) {
            let middle: Point = std::array::from_fn(|axis| {
                face.iter().map(|corner| corner[axis]).sum::<f64>() / face.len() as f64
            });
            assert!(dot(normal(face), middle) > 0.1, "{face:?}");
        }
    }

    #[test]
    fn links_stand_in_their_parents() {
        let mut scene = Scene::new(URDF);
        let quarter = Transform {
            rotation: quaternion([0.0, 0.0, std::f64::consts::FRAC_PI_2]),
            ..at([1.0, 0.0, 0.0])
        };
        scene.place(vec![(link("base", "world"), quarter), (link("arm", "base"), at([2.0, 0.0, 5.0]))]);
        let place = scene.world("arm").unwrap();
        for (is, expected) in place.position.into_iter().zip([1.0, 2.0, 5.0]) {
            assert!((is - expected).abs() < 1e-12, "{place:?}");
        }
        assert_eq!(scene.world("nobody"), None);
    }

    #[test]
    fn a_ring_of_parents_is_nowhere() {
        let mut scene = Scene::new(URDF);
        scene.place(vec![(link("base", "arm"), at([1.0; 3])), (link("arm", "base"), at([1.0; 3]))]);
        assert_eq!(scene.world("arm"), None);
    }

    #[test]
    fn three_sides_of_a_box_are_seen() {
        let mut scene = Scene::new(URDF);
        assert_eq!(scene.draw().matches("<path").count(), 0, "nothing is anywhere yet");
        scene.view = None;
        scene.place(vec![(link("base", "world"), at([1.0, 0.0, 0.0]))]);
        let picture = scene.draw();
        assert_eq!(picture.matches("<path").count(), 3, "{picture}");
    }

    #[test]
    fn near_a_link_it_is_in_the_middle_whichever_way_one_looks() {
        let mut scene = Scene::new(URDF);
        assert_eq!(scene.near("arm", FROM_ABOVE), None, "it is nowhere yet");
        scene.place(vec![
            (link("base", "world"), at([9.0, 0.0, 0.0])),
            (link("arm", "world"), at([1.0, 2.0, 3.0])),
        ]);
        for eye in [FROM_ABOVE, FROM_THE_SIDE] {
            let picture = scene.near("arm", eye).unwrap();
            assert!(picture.matches("<path").count() > 0, "{picture}");
            let view = |point| basis(eye).0.iter().zip(point).map(|(a, b): (&f64, f64)| a * b).sum::<f64>();
            assert!((view([1.0, 0.0, 0.0]) - 1.0).abs() < 1e-9, "+X is to the right");
        }
        let far = scene.near("arm", FROM_ABOVE).unwrap().matches("<path").count();
        scene.place(vec![(link("base", "world"), at([1.0, 2.0, 3.0]))]);
        assert!(
            scene.near("arm", FROM_ABOVE).unwrap().matches("<path").count() > far,
            "what is far is left out"
        );
    }

    #[test]
    fn what_is_no_urdf_is_an_empty_picture() {
        assert_eq!(Scene::new("<robot><link name='x'>").draw().matches("<path").count(), 0);
    }
}
