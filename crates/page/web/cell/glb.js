// Reads the meshes of a log: binary glTF 2.0 as `plant::look::glb` writes it, one primitive a material, no
// textures.

const MAGIC = 0x46546c67;
/** Exponent between the linear colours of glTF and those of a screen. */
const GAMMA = 1 / 2.2;

/**
 * @typedef {{ positions: Float32Array, normals: Float32Array, colours: Uint8Array, indices: Uint32Array }}
 *   Mesh
 */

/**
 * A mesh in the axes of its link: metres, Z up. glTF has Y up.
 * @param {Uint8Array} file
 * @returns {Mesh}
 */
export function readGlb(file) {
  const view = new DataView(file.buffer, file.byteOffset, file.byteLength);
  if (view.getUint32(0, true) !== MAGIC) throw new Error('A mesh of the log is not a glTF file.');
  const jsonSize = view.getUint32(12, true);
  const json = JSON.parse(new TextDecoder().decode(file.subarray(20, 20 + jsonSize)));
  const binary = 20 + jsonSize + 8;
  const values = (/** @type {number} */ accessor) => {
    const { bufferView, componentType, count, type } = json.accessors[accessor];
    const { byteOffset = 0 } = json.bufferViews[bufferView];
    const size = type === 'VEC3' ? count * 3 : count;
    // The file can be at any offset in the log, but a typed array must begin at a multiple of its element size.
    const start = file.byteOffset + binary + byteOffset;
    const bytes = file.buffer.slice(
      start,
      start + size * { 5126: 4, 5125: 4, 5123: 2 }[/** @type {5126} */ (componentType)],
    );
    if (componentType === 5126) return new Float32Array(bytes);
    return componentType === 5125 ? new Uint32Array(bytes) : new Uint16Array(bytes);
  };
  const parts = json.meshes[0].primitives.map((/** @type {any} */ primitive) => ({
    positions: zUp(values(primitive.attributes.POSITION)),
    normals: zUp(values(primitive.attributes.NORMAL)),
    indices: values(primitive.indices),
    colour: json.materials[primitive.material].pbrMetallicRoughness.baseColorFactor,
  }));
  return joined(parts);
}

/** @param {ArrayLike<number>} vectors */
function zUp(vectors) {
  const out = new Float32Array(vectors.length);
  for (let at = 0; at < vectors.length; at += 3) {
    out[at] = vectors[at];
    out[at + 1] = -vectors[at + 2];
    out[at + 2] = vectors[at + 1];
  }
  return out;
}

/**
 * @param {{ positions: Float32Array, normals: Float32Array, indices: ArrayLike<number>, colour: number[]
 *   }[]} parts
 * @returns {Mesh}
 */
function joined(parts) {
  const total = (/** @type {(part: typeof parts[0]) => number} */ size) =>
    parts.reduce((sum, part) => sum + size(part), 0);
  const vertices = total((part) => part.positions.length);
  const mesh = {
    positions: new Float32Array(vertices),
    normals: new Float32Array(vertices),
    colours: new Uint8Array(vertices),
    indices: new Uint32Array(total((part) => part.indices.length)),
  };
  let [vertex, index] = [0, 0];
  for (const { positions, normals, indices, colour } of parts) {
    mesh.positions.set(positions, vertex);
    mesh.normals.set(normals, vertex);
    const shown = colour.slice(0, 3).map((value) => Math.round(255 * value ** GAMMA));
    for (let at = 0; at < positions.length; at += 3) mesh.colours.set(shown, vertex + at);
    for (let at = 0; at < indices.length; at++) mesh.indices[index + at] = indices[at] + vertex / 3;
    vertex += positions.length;
    index += indices.length;
  }
  return mesh;
}

/** Two faces meet at a drawn edge if the cosine of their angle is smaller than this. */
const CREASE = 0.85;
/** Positions are equal if they agree when rounded to this fraction of a metre. */
const GRID = 1e5;

/**
 * The edges of a mesh that are drawn as lines: borders, and creases between faces.
 * @param {Mesh} mesh
 * @returns {Float32Array} pairs of points
 */
export function edgesOf({ positions, indices }) {
  const ids = sharedCorners(positions);
  /** @type {Map<number, { face: number, bend: number, count: number, ends: [number, number] }>} */
  const edges = new Map();
  const normals = faceNormals(positions, indices);
  for (let at = 0; at < indices.length; at += 3) {
    for (const [i, j] of [
      [0, 1],
      [1, 2],
      [2, 0],
    ]) {
      const ends = /** @type {[number, number]} */ ([indices[at + i], indices[at + j]]);
      const [a, b] = ends.map((end) => ids[end]).sort((x, y) => x - y);
      if (a === b) continue;
      const key = a * positions.length + b;
      const known = edges.get(key);
      if (!known) {
        edges.set(key, { face: at, bend: 1, count: 1, ends });
        continue;
      }
      known.count += 1;
      known.bend = Math.min(known.bend, cosine(normals, known.face, at));
    }
  }
  const lines = [];
  for (const { bend, count, ends } of edges.values()) {
    if (count === 1 || bend < CREASE) {
      for (const end of ends) lines.push(positions[end * 3], positions[end * 3 + 1], positions[end * 3 + 2]);
    }
  }
  return new Float32Array(lines);
}

/** For each vertex a number that it shares with all at the same place. @param {Float32Array} positions */
function sharedCorners(positions) {
  const known = new Map();
  const ids = new Uint32Array(positions.length / 3);
  for (let vertex = 0; vertex < ids.length; vertex++) {
    const key = [0, 1, 2].map((axis) => Math.round(positions[vertex * 3 + axis] * GRID)).join();
    const id = known.get(key) ?? known.size;
    known.set(key, id);
    ids[vertex] = id;
  }
  return ids;
}

/**
 * Normals of the faces, at the places of their first indices.
 * @param {Float32Array} p
 * @param {Uint32Array} indices
 */
function faceNormals(p, indices) {
  const out = new Float32Array(indices.length);
  for (let at = 0; at < indices.length; at += 3) {
    const [a, b, c] = [indices[at] * 3, indices[at + 1] * 3, indices[at + 2] * 3];
    const [ux, uy, uz] = [p[b] - p[a], p[b + 1] - p[a + 1], p[b + 2] - p[a + 2]];
    const [vx, vy, vz] = [p[c] - p[a], p[c + 1] - p[a + 1], p[c + 2] - p[a + 2]];
    const n = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
    const size = Math.hypot(...n) || 1;
    out.set(
      n.map((value) => value / size),
      at,
    );
  }
  return out;
}

/** @param {Float32Array} normals @param {number} a @param {number} b */
function cosine(normals, a, b) {
  return normals[a] * normals[b] + normals[a + 1] * normals[b + 1] + normals[a + 2] * normals[b + 2];
}
