// Matrices of 4 x 4, column by column, and poses: x, y, z, then the quaternion w, x, y, z.

/** @typedef {[number, number, number]} Point */

/** @param {Float32Array} a @param {Float32Array} b */
export function multiply(a, b) {
  const out = new Float32Array(16);
  for (let column = 0; column < 4; column++) {
    for (let row = 0; row < 4; row++) {
      let sum = 0;
      for (let k = 0; k < 4; k++) sum += a[k * 4 + row] * b[column * 4 + k];
      out[column * 4 + row] = sum;
    }
  }
  return out;
}

/** @param {number} fieldOfView radians @param {number} aspect @param {number} near @param {number} far */
export function perspective(fieldOfView, aspect, near, far) {
  const scale = 1 / Math.tan(fieldOfView / 2);
  const out = new Float32Array(16);
  out[0] = scale / aspect;
  out[5] = scale;
  out[10] = (far + near) / (near - far);
  out[11] = -1;
  out[14] = (2 * far * near) / (near - far);
  return out;
}

/**
 * A view without perspective of a box around the axis.
 * @param {number} half half its width
 * @param {number} near
 * @param {number} far
 */
export function orthographic(half, near, far) {
  const out = new Float32Array(16);
  [out[0], out[5], out[10], out[15]] = [1 / half, 1 / half, -2 / (far - near), 1];
  out[14] = -(far + near) / (far - near);
  return out;
}

/** @param {Point} eye @param {Point} target */
export function lookAt(eye, target) {
  const z = normal(minus(eye, target));
  const x = normal(cross([0, 0, 1], z));
  const y = cross(z, x);
  return new Float32Array([
    x[0],
    y[0],
    z[0],
    0,
    x[1],
    y[1],
    z[1],
    0,
    x[2],
    y[2],
    z[2],
    0,
    -dot(x, eye),
    -dot(y, eye),
    -dot(z, eye),
    1,
  ]);
}

/** The matrix of a pose. @param {ArrayLike<number>} pose */
export function ofPose(pose) {
  const [x, y, z, w, a, b, c] = Array.from(pose);
  return new Float32Array([
    1 - 2 * (b * b + c * c),
    2 * (a * b + w * c),
    2 * (a * c - w * b),
    0,
    2 * (a * b - w * c),
    1 - 2 * (a * a + c * c),
    2 * (b * c + w * a),
    0,
    2 * (a * c + w * b),
    2 * (b * c - w * a),
    1 - 2 * (a * a + b * b),
    0,
    x,
    y,
    z,
    1,
  ]);
}

export const IDENTITY = ofPose([0, 0, 0, 1, 0, 0, 0]);

/** A point transformed by a matrix, with its fourth coordinate. @param {Float32Array} m @param {ArrayLike<number>} p */
export function transform(m, p) {
  return [0, 1, 2, 3].map((row) => m[row] * p[0] + m[4 + row] * p[1] + m[8 + row] * p[2] + m[12 + row]);
}

/** @param {Point} a @param {Point} b @returns {Point} */
export function minus(a, b) {
  return [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
}

/** @param {Point} a @param {Point} b @returns {Point} */
export function cross(a, b) {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

/** @param {Point} a @param {Point} b */
function dot(a, b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/** @param {Point} a @returns {Point} */
export function normal(a) {
  const size = Math.hypot(...a) || 1;
  return [a[0] / size, a[1] / size, a[2] / size];
}
