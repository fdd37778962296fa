// Decodes the one ROS 2 message of a log: `sensor_msgs/msg/JointState` in CDR.

import { textOf } from './bytes.js';

/** Size of the encapsulation header, from whose end the fields are aligned. */
const HEAD = 4;

/**
 * Names and positions of the joints; radians, or metres for those of fingers.
 * @param {Uint8Array} data
 * @returns {{ name: string[], position: number[] }}
 */
export function jointState(data) {
  const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
  let at = HEAD;
  const align = (/** @type {number} */ to) => {
    at = HEAD + Math.ceil((at - HEAD) / to) * to;
  };
  const number = () => {
    align(4);
    at += 4;
    return view.getUint32(at - 4, true);
  };
  const text = () => {
    const size = number();
    at += size;
    return textOf(data.subarray(at - size, at - 1));
  };
  at += 8;
  text();
  const name = Array.from({ length: number() }, text);
  const count = number();
  align(8);
  return {
    name,
    position: Array.from({ length: count }, (_, index) => view.getFloat64(at + 8 * index, true)),
  };
}
