// Draws the cell with WebGL2: all bodies in three calls, then marks.

import { edgesOf, readGlb } from './glb.js';
import { attribute, joined, numbers, program, shadowMap, texture } from './gpu.js';
import { cross, lookAt, minus, multiply, orthographic, perspective, transform } from './matrix.js';
import { BACKDROP, EDGES, MARKS, SHADOW, SURFACE, TEXELS } from './shaders.js';

/**
 * @typedef {import('./matrix.js').Point} Point
 * @typedef {[number, number, number]} Colour
 * @typedef {{ name: string, frame: string }} Body
 * @typedef {{ azimuth: number, elevation: number, distance: number, target: Point }} Camera
 * @typedef {{ place: Point, radius: number, colour: Colour, glow: boolean }} Ball
 * @typedef {object} Picture
 * @property {(Float32Array | null)[]} matrices of the bodies; null hides one
 * @property {Map<string, { colour: Colour, amount: number }>} tints by name of the body
 * @property {Point[]} trail
 * @property {Colour} trailColour
 * @property {Ball[]} balls
 * @property {boolean} light
 * @property {Camera} camera
 */

const FIELD_OF_VIEW = 0.52;
const SHADOW_SIZE = 2048;
/** The sunlight: a point on its path to the middle of the cell, and that middle, metres. */
const MIDDLE = /** @type {Point} */ ([0.35, -0.6, -0.5]);
const SUN = /** @type {Point} */ ([-0.279, -0.537, 0.796]);
const SUN_DISTANCE = 9;

const THEMES = {
  dark: {
    background: [0.093, 0.107, 0.128],
    top: [0.043, 0.051, 0.063],
    sky: [0.4, 0.45, 0.54],
    ground: [0.13, 0.13, 0.145],
    floor: [0.034, 0.038, 0.045],
    exposure: 0.8,
    sunlight: 1.02,
    line: [0, 0, 0, 0.34],
  },
  light: {
    background: [0.885, 0.897, 0.913],
    top: [0.955, 0.962, 0.972],
    sky: [0.52, 0.56, 0.63],
    ground: [0.34, 0.33, 0.32],
    floor: [0.5, 0.52, 0.545],
    exposure: 0.93,
    sunlight: 0.92,
    line: [0.05, 0.07, 0.1, 0.3],
  },
};

export class Renderer {
  /**
   * @param {HTMLCanvasElement} canvas
   * @param {any[]} entities of `/meshes`
   * @throws {Error} if the browser has no WebGL2
   */
  constructor(canvas, entities) {
    const gl = canvas.getContext('webgl2', { antialias: true, alpha: false, preserveDrawingBuffer: true });
    if (!gl) throw new Error('This browser cannot draw the cell: it has no WebGL2.');
    this.canvas = canvas;
    this.gl = gl;
    /** @type {Body[]} */
    this.bodies = entities.map((entity) => ({ name: entity.id, frame: entity.frame_id }));
    this.surface = program(gl, SURFACE);
    this.shadow = program(gl, SHADOW);
    this.edges = program(gl, EDGES);
    this.marks = program(gl, MARKS);
    this.backdrop = program(gl, BACKDROP);
    this.upload(entities.map((entity) => readGlb(entity.models[0].data)));
    this.texels = new Float32Array(Math.max(1, this.bodies.length) * TEXELS * 4);
    this.bodyTexture = texture(gl, gl.NEAREST);
    this.shadowTexture = shadowMap(gl, SHADOW_SIZE);
    this.shadowTarget = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.shadowTarget);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, this.shadowTexture, 0);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    const eye = /** @type {Point} */ (MIDDLE.map((value, axis) => value + SUN[axis] * SUN_DISTANCE));
    this.light = multiply(orthographic(3.7, 3, 15), lookAt(eye, MIDDLE));
    this.nothing = gl.createVertexArray();
    this.markArray = gl.createVertexArray();
    this.markBuffer = gl.createBuffer();
    gl.bindVertexArray(this.markArray);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.markBuffer);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    this.sphere = sphere();
    this.view = new Float32Array(16);
    this.size = [1, 1];
    /** Signalled when the graphics processor has drawn the last picture. @type {WebGLSync | null} */
    this.fence = null;
  }

  /** Put all meshes into one set of buffers. @param {import('./glb.js').Mesh[]} meshes */
  upload(meshes) {
    const { gl } = this;
    const lines = meshes.map(edgesOf);
    const triangles = gl.createVertexArray();
    gl.bindVertexArray(triangles);
    attribute(
      gl,
      0,
      3,
      gl.FLOAT,
      joined(
        Float32Array,
        meshes.map((mesh) => mesh.positions),
      ),
    );
    attribute(
      gl,
      1,
      3,
      gl.FLOAT,
      joined(
        Float32Array,
        meshes.map((mesh) => mesh.normals),
      ),
    );
    attribute(
      gl,
      2,
      3,
      gl.UNSIGNED_BYTE,
      joined(
        Uint8Array,
        meshes.map((mesh) => mesh.colours),
      ),
    );
    attribute(gl, 3, 1, gl.UNSIGNED_SHORT, numbers(meshes.map((mesh) => mesh.positions.length / 3)));
    let first = 0;
    const indices = meshes.map((mesh) => {
      const moved = mesh.indices.map((index) => index + first);
      first += mesh.positions.length / 3;
      return moved;
    });
    const all = joined(Uint32Array, indices);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, all, gl.STATIC_DRAW);
    const segments = gl.createVertexArray();
    gl.bindVertexArray(segments);
    attribute(gl, 0, 3, gl.FLOAT, joined(Float32Array, lines));
    attribute(gl, 3, 1, gl.UNSIGNED_SHORT, numbers(lines.map((line) => line.length / 3)));
    gl.bindVertexArray(null);
    this.triangles = { array: triangles, count: all.length };
    this.segments = { array: segments, count: lines.reduce((sum, line) => sum + line.length / 3, 0) };
  }

  /** @param {Picture} picture */
  draw(picture) {
    const { gl, canvas } = this;
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((it) =>
      Math.max(2, Math.round(it * ratio)),
    );
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    this.size = [width / ratio, height / ratio];
    const theme = picture.light ? THEMES.light : THEMES.dark;
    const eye = eyeOf(picture.camera);
    this.view = multiply(
      perspective(FIELD_OF_VIEW, width / height, 0.05, 40),
      lookAt(eye, picture.camera.target),
    );
    this.place(picture);
    this.drawShadows();
    gl.viewport(0, 0, width, height);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    this.drawBackdrop(theme);
    this.drawBodies(theme, eye);
    this.drawMarks(picture, eye);
    gl.bindVertexArray(null);
    this.fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
  }

  /** Returns true while the graphics processor draws the last picture. */
  get isBusy() {
    const { gl, fence } = this;
    if (!fence) return false;
    if (gl.getSyncParameter(fence, gl.SYNC_STATUS) === gl.UNSIGNALED) return true;
    gl.deleteSync(fence);
    this.fence = null;
    return false;
  }

  /** Write the places and tints of the bodies into their texture. @param {Picture} picture */
  place({ matrices, tints }) {
    const { gl } = this;
    this.bodies.forEach(({ name }, index) => {
      const start = index * TEXELS * 4;
      const matrix = matrices[index];
      if (matrix) this.texels.set(matrix, start);
      const tint = tints.get(name);
      this.texels.set([...(tint?.colour ?? [0, 0, 0]), tint?.amount ?? 0], start + 16);
      const castsNoShadow = name === 'floor' || name === 'fence';
      this.texels.set([matrix ? 0 : 1, name === 'floor' ? 1 : 0, castsNoShadow ? 1 : 0, 0], start + 20);
    });
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, this.bodyTexture);
    gl.texImage2D(
      gl.TEXTURE_2D,
      0,
      gl.RGBA32F,
      TEXELS,
      Math.max(1, this.bodies.length),
      0,
      gl.RGBA,
      gl.FLOAT,
      this.texels,
    );
  }

  drawShadows() {
    const { gl, shadow } = this;
    gl.enable(gl.DEPTH_TEST);
    gl.disable(gl.BLEND);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.shadowTarget);
    gl.viewport(0, 0, SHADOW_SIZE, SHADOW_SIZE);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    gl.useProgram(shadow.program);
    gl.uniformMatrix4fv(shadow.at('light'), false, this.light);
    gl.uniform1i(shadow.at('bodies'), 1);
    this.drawTriangles();
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  drawTriangles() {
    const { gl, triangles } = this;
    if (!triangles) return;
    gl.bindVertexArray(triangles.array);
    gl.drawElements(gl.TRIANGLES, triangles.count, gl.UNSIGNED_INT, 0);
  }

  /** @param {typeof THEMES.dark} theme */
  drawBackdrop(theme) {
    const { gl, backdrop } = this;
    gl.depthMask(false);
    gl.useProgram(backdrop.program);
    gl.uniform3fv(backdrop.at('low'), theme.background);
    gl.uniform3fv(backdrop.at('high'), theme.top);
    gl.bindVertexArray(this.nothing);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.depthMask(true);
  }

  /** @param {typeof THEMES.dark} theme @param {Point} eye */
  drawBodies(theme, eye) {
    const { gl, surface, edges } = this;
    gl.useProgram(surface.program);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.shadowTexture);
    gl.uniform1i(surface.at('shadows'), 0);
    gl.uniform1i(surface.at('bodies'), 1);
    gl.uniformMatrix4fv(surface.at('view'), false, this.view);
    gl.uniformMatrix4fv(surface.at('light'), false, this.light);
    const vectors = {
      sun: SUN,
      eye,
      background: theme.background,
      sky: theme.sky,
      ground: theme.ground,
      floorColour: theme.floor,
    };
    for (const [name, value] of Object.entries(vectors)) gl.uniform3fv(surface.at(name), value);
    gl.uniform1f(surface.at('exposure'), theme.exposure);
    gl.uniform1f(surface.at('sunlight'), theme.sunlight);
    this.drawTriangles();
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthMask(false);
    gl.useProgram(edges.program);
    gl.uniform1i(edges.at('bodies'), 1);
    gl.uniformMatrix4fv(edges.at('view'), false, this.view);
    gl.uniform4fv(edges.at('line'), theme.line);
    gl.bindVertexArray(this.segments?.array ?? null);
    gl.drawArrays(gl.LINES, 0, this.segments?.count ?? 0);
    gl.depthMask(true);
  }

  /** @param {Picture} picture @param {Point} eye */
  drawMarks({ trail, trailColour, balls }, eye) {
    const { gl, marks } = this;
    gl.useProgram(marks.program);
    gl.uniformMatrix4fv(marks.at('view'), false, this.view);
    gl.bindVertexArray(this.markArray);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.markBuffer);
    const show = (
      /** @type {number[]} */ points,
      /** @type {Colour} */ colour,
      /** @type {number} */ alpha,
      /** @type {number} */ mode,
    ) => {
      gl.uniform4f(marks.at('colour'), ...colour, alpha);
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(points), gl.DYNAMIC_DRAW);
      gl.drawArrays(mode, 0, points.length / 3);
    };
    const pixel = (Math.tan(FIELD_OF_VIEW / 2) * 2) / this.size[1];
    gl.depthMask(false);
    // The trail fades in six steps towards its beginning.
    for (let part = 0; part < 6; part++) {
      const [from, to] = [part, part + 1].map((it) => Math.floor((it * trail.length) / 6));
      const points = trail.slice(from, to + 1);
      if (points.length > 1)
        show(
          ribbon(points, pixel * 0.9, eye),
          trailColour,
          0.12 + (0.75 * (part + 1)) / 6,
          gl.TRIANGLE_STRIP,
        );
    }
    gl.depthMask(true);
    for (const { place, radius, colour, glow } of balls) {
      show(
        this.sphere.map((value, at) => place[at % 3] + value * radius),
        colour,
        0.92,
        gl.TRIANGLES,
      );
      if (!glow) continue;
      gl.disable(gl.DEPTH_TEST);
      show(
        this.sphere.map((value, at) => place[at % 3] + value * radius * 2.3),
        colour,
        0.16,
        gl.TRIANGLES,
      );
      gl.enable(gl.DEPTH_TEST);
    }
  }

  /**
   * The place of a point in the picture, pixels from the upper left corner; null behind the camera.
   * @param {ArrayLike<number>} point
   * @returns {[number, number] | null}
   */
  project(point) {
    const [x, y, , w] = transform(this.view, point);
    return w <= 0 ? null : [(x / w / 2 + 0.5) * this.size[0], (0.5 - y / w / 2) * this.size[1]];
  }
}

/** @param {Camera} camera @returns {Point} */
function eyeOf({ azimuth, elevation, distance, target }) {
  const flat = distance * Math.cos(elevation);
  return [
    target[0] + flat * Math.cos(azimuth),
    target[1] + flat * Math.sin(azimuth),
    target[2] + distance * Math.sin(elevation),
  ];
}

/**
 * A line as a strip of triangles that faces the camera.
 * @param {Point[]} points
 * @param {number} width a metre away
 * @param {Point} eye
 */
function ribbon(points, width, eye) {
  return points.flatMap((point, index) => {
    const along = minus(points[Math.min(index + 1, points.length - 1)], points[Math.max(index - 1, 0)]);
    const toEye = minus(eye, point);
    const side = cross(along, toEye);
    const scale = (width * Math.hypot(...toEye)) / (Math.hypot(...side) || 1);
    return [1, -1].flatMap((sign) => point.map((value, axis) => value + sign * scale * side[axis]));
  });
}

/** Corners of the triangles of a ball with radius 1. */
function sphere() {
  const [around, down] = [16, 10];
  const corner = (/** @type {number} */ i, /** @type {number} */ j) => {
    const [turn, tilt] = [(i / around) * 2 * Math.PI, (j / down) * Math.PI];
    return [Math.sin(tilt) * Math.cos(turn), Math.sin(tilt) * Math.sin(turn), Math.cos(tilt)];
  };
  const out = [];
  for (let j = 0; j < down; j++) {
    for (let i = 0; i < around; i++) {
      for (const [di, dj] of [
        [0, 0],
        [1, 0],
        [0, 1],
        [1, 0],
        [1, 1],
        [0, 1],
      ])
        out.push(...corner(i + di, j + dj));
    }
  }
  return out;
}
