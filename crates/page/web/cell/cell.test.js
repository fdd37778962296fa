import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Frames } from './frames.js';
import { edgesOf, readGlb } from './glb.js';
import { lookAt, multiply, ofPose, perspective, transform } from './matrix.js';

const near = (actual, expected) =>
  expected.forEach((value, at) => assert.ok(Math.abs(actual[at] - value) < 1e-5, `${actual}`));
const half = Math.SQRT1_2;

test('a_pose_turns_and_moves_a_point', () => {
  // A quarter turn about Z, and a metre along X.
  near(transform(ofPose([1, 0, 0, half, 0, 0, half]), [1, 0, 0]), [1, 1, 0, 1]);
  const twice = multiply(ofPose([1, 0, 0, half, 0, 0, half]), ofPose([1, 0, 0, half, 0, 0, half]));
  near(transform(twice, [1, 0, 0]), [0, 1, 0, 1]);
});

test('the_target_of_the_camera_is_in_the_middle_of_the_picture', () => {
  const view = multiply(perspective(0.5, 1, 0.1, 10), lookAt([3, -4, 2], [1, 1, 0]));
  const [x, y, , w] = transform(view, [1, 1, 0]);
  near([x / w, y / w], [0, 0]);
  assert.ok(w > 0);
});

const double = (number, value) => [number * 8 + 1, ...new Uint8Array(Float64Array.of(value).buffer)];
const bytes = (number, body) => [number * 8 + 2, body.length, ...body];
const name = (number, text) => bytes(number, [...Buffer.from(text)]);

function message(tick, parent, child, x) {
  return {
    tick,
    data: Uint8Array.from(
      bytes(1, [...name(2, parent), ...name(3, child), ...bytes(4, double(1, x)), ...bytes(5, double(4, 1))]),
    ),
  };
}

test('a_frame_is_where_its_last_transform_puts_it_in_its_parent', () => {
  const frames = new Frames(
    [message(1, 'world', 'arm', 1), message(1, 'arm', 'hand', 10), message(5, 'world', 'arm', 2)],
    [],
  );
  assert.deepEqual(
    [1, 4, 5, 9].map((tick) => frames.place('hand', tick)?.[0]),
    [11, 11, 12, 12],
  );
  assert.equal(frames.matrix('nothing', 1), null);
});

/** A square of two triangles, and one that stands on its side. */
function glb() {
  const positions = Float32Array.of(0, 0, 0, 1, 0, 0, 1, 0, -1, 0, 0, -1, 0, 1, 0);
  const normals = new Float32Array(15).fill(1);
  const indices = Uint16Array.of(0, 1, 2, 0, 2, 3, 0, 3, 4);
  const binary = Buffer.concat([positions, normals, indices].map((it) => Buffer.from(it.buffer)));
  const json = {
    meshes: [{ primitives: [{ attributes: { POSITION: 0, NORMAL: 1 }, indices: 2, material: 0 }] }],
    materials: [{ pbrMetallicRoughness: { baseColorFactor: [1, 0, 0, 1] } }],
    accessors: [
      { bufferView: 0, componentType: 5126, count: 5, type: 'VEC3' },
      { bufferView: 1, componentType: 5126, count: 5, type: 'VEC3' },
      { bufferView: 2, componentType: 5123, count: 9, type: 'SCALAR' },
    ],
    bufferViews: [{ byteOffset: 0 }, { byteOffset: 60 }, { byteOffset: 120 }],
  };
  const text = Buffer.from(JSON.stringify(json));
  const head = Buffer.alloc(20);
  head.write('glTF');
  head.writeUInt32LE(text.length, 12);
  return new Uint8Array(Buffer.concat([head, text, Buffer.alloc(8), binary]));
}

test('a_mesh_is_read_with_z_up', () => {
  const mesh = readGlb(glb());
  assert.deepEqual([...mesh.positions.slice(6, 9)], [1, 1, 0]);
  assert.deepEqual([...mesh.colours.slice(0, 3)], [255, 0, 0]);
  assert.deepEqual([...mesh.indices], [0, 1, 2, 0, 2, 3, 0, 3, 4]);
});

test('borders_and_creases_are_edges_and_diagonals_of_flat_faces_are_not', () => {
  // Three borders of the square, its edge with the upright triangle, and two borders of that.
  assert.equal(edgesOf(readGlb(glb())).length / 6, 6);
});
