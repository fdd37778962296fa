// Where the links are: `/tf` as a table of poses for each frame.
//
// `/tf` has a quarter of a million transforms in a run of 20 minutes, so they are read here without objects.

import { fields } from '../log/protobuf.js';
import { multiply, IDENTITY, ofPose } from './matrix.js';

/** The frame of fixed bodies. */
export const WORLD = 'world';
/** Numbers of a pose: x, y, z in metres, and the quaternion w, x, y, z. */
const SIZE = 7;

/** The poses of a frame in its parent over time. */
class Track {
  /** @param {string} parent */
  constructor(parent) {
    this.parent = parent;
    /** @type {number[]} */
    this.ticks = [];
    /** @type {number[]} */
    this.poses = [];
  }

  /** The pose in a tick; the first one before it. @param {number} tick */
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
    for (const { tick, data } of [...fixed, ...moving]) this.add(tick, data);
  }

  /** @param {number} tick @param {Uint8Array} data a `foxglove.FrameTransforms` */
  add(tick, data) {
    for (const [, body] of fields(data)) {
      if (!(body instanceof Uint8Array)) continue;
      let [parent, child] = ['', ''];
      const pose = [0, 0, 0, 0, 0, 0, 0];
      for (const [number, value] of fields(body)) {
        if (!(value instanceof Uint8Array)) continue;
        if (number === 2) parent = ascii(value);
        else if (number === 3) child = ascii(value);
        else if (number === 4) read(value, pose, [0, 1, 2]);
        else if (number === 5) read(value, pose, [4, 5, 6, 3]);
      }
      let track = this.tracks.get(child);
      if (!track) this.tracks.set(child, (track = new Track(parent)));
      track.ticks.push(tick);
      track.poses.push(...pose);
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

/** A name of letters and digits. @param {Uint8Array} bytes */
function ascii(bytes) {
  return String.fromCharCode(...bytes);
}

/**
 * Read the doubles of a vector or a quaternion into a pose.
 * @param {Uint8Array} data
 * @param {number[]} pose
 * @param {number[]} places
 */
function read(data, pose, places) {
  for (const [number, value] of fields(data)) {
    if (typeof value === 'number' && number <= places.length) pose[places[number - 1]] = value;
  }
}
