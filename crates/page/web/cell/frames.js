// The poses of the links: `/tf` as a table of poses for each frame.
//
// `/tf` has a quarter of a million transforms in a run of 20 minutes, so they are read here without objects.

import { textOf } from '../log/bytes.js';
import { wireOf } from '../log/protobuf.js';
import { multiply, IDENTITY, ofPose } from './matrix.js';

/** The frame of fixed bodies. */
export const WORLD = 'world';
/** Numbers of a pose: x, y, z in metres, and the quaternion w, x, y, z. */
const SIZE = 7;
/** Positions in a pose of the fields of a vector and of a quaternion. */
const POSITION = [0, 1, 2];
const ROTATION = [4, 5, 6, 3];

/** The poses of a frame in its parent by tick. */
class Track {
  /** @param {string} parent */
  constructor(parent) {
    this.parent = parent;
    /** @type {number[]} */
    this.ticks = [];
    /** @type {number[]} */
    this.poses = [];
  }

  /** The pose in a tick; before the first pose, the first one. @param {number} tick */
  at(tick) {
    let [low, high] = [0, this.ticks.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.ticks[middle] <= tick) low = middle + 1;
      else high = middle;
    }
    const start = Math.max(0, low - 1) * SIZE;
    return this.poses.slice(start, start + SIZE);
  }
}

export class Frames {
  /**
   * @param {import('../log/mcap.js').Message[]} moving of `/tf`
   * @param {import('../log/mcap.js').Message[]} fixed of `/tf_static`
   */
  constructor(moving, fixed) {
    /** @type {Map<string, Track>} */
    this.tracks = new Map();
    this.names = new Names();
    /** The pose that is being read. */
    this.pose = Array(SIZE).fill(0);
    for (const { tick, data } of [...fixed, ...moving]) this.add(tick, data);
  }

  /** @param {number} tick @param {Uint8Array} data a `foxglove.FrameTransforms` */
  add(tick, data) {
    const { names, pose } = this;
    for (const list = wireOf(data); list.next();) {
      if (!list.isBlock) continue;
      let [parent, child] = ['', ''];
      pose.fill(0);
      for (const wire = list.inside(); wire.next();) {
        if (!wire.isBlock) continue;
        if (wire.number === 2) parent = names.of(wire);
        else if (wire.number === 3) child = names.of(wire);
        else if (wire.number === 4) read(wire, pose, POSITION);
        else if (wire.number === 5) read(wire, pose, ROTATION);
      }
      let track = this.tracks.get(child);
      if (!track) this.tracks.set(child, (track = new Track(parent)));
      track.ticks.push(tick);
      for (const value of pose) track.poses.push(value);
    }
  }

  /**
   * The matrix of a frame in the world; null for an unknown frame.
   * @param {string} frame
   * @param {number} tick
   * @returns {Float32Array | null}
   */
  matrix(frame, tick) {
    let matrix = IDENTITY;
    for (let depth = 0; frame !== WORLD; depth++) {
      const track = this.tracks.get(frame);
      if (!track || depth > this.tracks.size) return null;
      matrix = multiply(ofPose(track.at(tick)), matrix);
      frame = track.parent;
    }
    return matrix;
  }

  /**
   * The place of a frame in the world, metres.
   * @param {string} frame
   * @param {number} tick
   * @returns {[number, number, number] | null}
   */
  place(frame, tick) {
    const matrix = this.matrix(frame, tick);
    return matrix && [matrix[12], matrix[13], matrix[14]];
  }
}

/** Names of frames: each is decoded from its bytes only once. */
class Names {
  constructor() {
    /** @type {Map<number, string>} */
    this.known = new Map();
  }

  /** The name in a field. @param {import('../log/protobuf.js').Wire} wire */
  of(wire) {
    const { view, from, to } = wire;
    let hash = to - from;
    for (let at = from; at < to; at++) hash = (hash * 31 + view.getUint8(at)) | 0;
    const known = this.known.get(hash);
    if (known !== undefined && isText(known, view, from, to)) return known;
    const name = textOf(wire.block);
    this.known.set(hash, name);
    return name;
  }
}

/** @param {string} text @param {DataView} view @param {number} from @param {number} to */
function isText(text, view, from, to) {
  if (text.length !== to - from) return false;
  for (let at = from; at < to; at++) if (text.charCodeAt(at - from) !== view.getUint8(at)) return false;
  return true;
}

/**
 * Read the doubles of a vector or a quaternion into a pose.
 * @param {import('../log/protobuf.js').Wire} of
 * @param {number[]} pose
 * @param {number[]} places
 */
function read(of, pose, places) {
  for (const wire = of.inside(); wire.next();) {
    if (!wire.isBlock && wire.number > 0 && wire.number <= places.length)
      pose[places[wire.number - 1]] = wire.value;
  }
}
