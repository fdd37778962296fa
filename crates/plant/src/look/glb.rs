//! Writes a mesh as a binary glTF 2.0 file (GLB), with one primitive per material.
//!
//! glTF measures in metres with Y up: the link's (X, Y, Z) is written as (X, Z, -Y).

use std::{collections::BTreeMap, fmt::Write as _};

use geometry::frame::Vector;

use crate::{look::mesh::Mesh, scene::Material};

const INCH: f64 = 0.0254; // metres per inch
/// The magic words `glTF`, `JSON` and `BIN` of the file and its chunks.
const MAGIC: [&[u8; 4]; 3] = [b"glTF", b"JSON", b"BIN\0"];

#[derive(Default)]
struct Surface {
    known: BTreeMap<[u32; 6], u32>,
    vertices: Vec<[f32; 6]>,
    indices: Vec<u32>,
}

impl Surface {
    fn corner(&mut self, vertex: [f32; 6]) {
        let next = self.vertices.len() as u32;
        let index = *self.known.entry(vertex.map(f32::to_bits)).or_insert(next);
        if index == next {
            self.vertices.push(vertex);
        }
        self.indices.push(index);
    }
}

/// A vector in glTF's axes, multiplied by `scale`.
fn y_up(v: &Vector, scale: f64) -> [f32; 3] {
    // Rounded to 10 um and without negative zeros, so that equal vectors have equal bytes.
    [v.x, v.z, -v.y].map(|value| ((value * scale * 1e5).round() / 1e5 + 0.0) as f32)
}

#[must_use]
pub fn encode(mesh: &Mesh) -> Vec<u8> {
    let mut surfaces: BTreeMap<Material, Surface> = BTreeMap::new();
    for piece in mesh.pieces() {
        let surface = surfaces.entry(piece.material).or_default();
        for corner in piece.corners().iter().flatten() {
            let ([x, y, z], [nx, ny, nz]) = (y_up(&corner.position, INCH), y_up(&corner.normal, 1.0));
            surface.corner([x, y, z, nx, ny, nz]);
        }
    }
    let mut binary = Vec::new();
    let (mut views, mut accessors, mut primitives) = (Vec::new(), Vec::new(), Vec::new());
    let mut materials = Vec::new();
    for (number, (material, surface)) in surfaces.iter().enumerate() {
        let first = accessors.len();
        for (part, offset) in [0, 3].into_iter().enumerate() {
            let start = binary.len();
            for vertex in &surface.vertices {
                vertex[offset..offset + 3]
                    .iter()
                    .for_each(|value| binary.extend_from_slice(&value.to_le_bytes()));
            }
            let bounds = if part == 0 { bounds(&surface.vertices) } else { String::new() };
            accessors.push(format!(
                r#"{{"bufferView":{},"componentType":5126,"count":{},"type":"VEC3"{bounds}}}"#,
                views.len(),
                surface.vertices.len()
            ));
            views.push(view(start, binary.len(), 34962));
        }
        let start = binary.len();
        let short = u16::try_from(surface.vertices.len()).is_ok();
        for index in &surface.indices {
            let bytes = index.to_le_bytes();
            binary.extend_from_slice(if short { &bytes[..2] } else { &bytes[..] });
        }
        accessors.push(format!(
            r#"{{"bufferView":{},"componentType":{},"count":{},"type":"SCALAR"}}"#,
            views.len(),
            if short { 5123 } else { 5125 },
            surface.indices.len()
        ));
        views.push(view(start, binary.len(), 34963));
        pad(&mut binary, 0);
        primitives.push(format!(
            r#"{{"attributes":{{"POSITION":{first},"NORMAL":{}}},"indices":{},"material":{number}}}"#,
            first + 1,
            first + 2
        ));
        materials.push(material.gltf());
    }
    let mut json =
        r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}]"#.to_owned();
    let _ = write!(
        json,
        r#","meshes":[{{"primitives":[{}]}}],"materials":[{}],"accessors":[{}],"bufferViews":[{}],"buffers":[{{"byteLength":{}}}]}}"#,
        primitives.join(","),
        materials.join(","),
        accessors.join(","),
        views.join(","),
        binary.len()
    );
    let mut json = json.into_bytes();
    pad(&mut json, b' ');
    let mut file = MAGIC[0].to_vec();
    let length = 12 + 8 + json.len() + 8 + binary.len();
    [2, length as u32].iter().for_each(|number| file.extend_from_slice(&number.to_le_bytes()));
    for (kind, chunk) in MAGIC[1..].iter().zip([json, binary]) {
        file.extend_from_slice(&(chunk.len() as u32).to_le_bytes());
        file.extend_from_slice(*kind);
        file.extend_from_slice(&chunk);
    }
    file
}

fn view(start: usize, end: usize, target: u32) -> String {
    format!(r#"{{"buffer":0,"byteOffset":{start},"byteLength":{},"target":{target}}}"#, end - start)
}

fn pad(bytes: &mut Vec<u8>, with: u8) {
    bytes.resize(bytes.len().next_multiple_of(4), with);
}

/// Least and greatest coordinates as JSON, which glTF requires.
fn bounds(vertices: &[[f32; 6]]) -> String {
    let fold = |start: f32, choose: fn(f32, f32) -> f32| {
        let mut of = [start; 3];
        for vertex in vertices {
            of.iter_mut().zip(vertex).for_each(|(slot, value)| *slot = choose(*slot, *value));
        }
        format!("[{},{},{}]", of[0], of[1], of[2])
    };
    format!(r#","min":{},"max":{}"#, fold(f32::INFINITY, f32::min), fold(f32::NEG_INFINITY, f32::max))
}
