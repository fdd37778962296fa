// Decodes protobuf messages by the descriptors that a channel carries as its schema.
//
// A message becomes an object with the names of the schema. An enum becomes the name of its value. What is
// absent
// becomes null if the field is optional or a message, and zero, false or an empty text otherwise.

import { textOf } from './bytes.js';

/**
 * @typedef {object} Field
 * @property {string} name
 * @property {number} number
 * @property {number} kind
 * @property {string} type
 * @property {boolean} repeated
 * @property {boolean} optional
 * @typedef {{ fields: Map<number, Field>, blank: Record<string, any> }} MessageType
 * @typedef {{ messages: Map<string, MessageType>, enums: Map<string, Map<number, string>> }} Types
 */

/** Types of fields in a descriptor. */
const KIND = {
  double: 1,
  float: 2,
  int64: 3,
  uint64: 4,
  int32: 5,
  fixed64: 6,
  fixed32: 7,
  bool: 8,
  string: 9,
  message: 11,
  bytes: 12,
  uint32: 13,
  enum: 14,
  sfixed32: 15,
  sfixed64: 16,
  sint32: 17,
  sint64: 18,
};
const REPEATED = 3;
/** Depth at which a message that contains itself ends. */
const DEPTH_LIMIT = 32;

/**
 * The fields of a message: number and value. A value is a number, or bytes that the reader interprets.
 * @param {Uint8Array} bytes
 * @returns {Generator<[number, number | Uint8Array, number]>} number, value, wire type
 */
export function* fields(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  let at = 0;
  const varint = () => {
    let [value, scale] = [0, 1];
    for (;;) {
      const byte = bytes[at++];
      if (byte === undefined) throw new RangeError('a message ends in the middle of a number');
      value += (byte & 0x7f) * scale;
      if (byte < 0x80) return value;
      scale *= 128;
    }
  };
  while (at < bytes.length) {
    const key = varint();
    const [number, wire] = [Math.floor(key / 8), key % 8];
    if (wire === 0) {
      yield [number, varint(), wire];
      continue;
    }
    const size = wire === 1 ? 8 : wire === 5 ? 4 : wire === 2 ? varint() : NaN;
    if (!(at + size <= bytes.length)) throw new RangeError('a message ends in the middle of a field');
    if (wire === 1) yield [number, view.getFloat64(at, true), wire];
    else if (wire === 5) yield [number, view.getUint32(at, true), wire];
    else yield [number, bytes.subarray(at, at + size), wire];
    at += size;
  }
}

/**
 * The types of a set of file descriptors.
 * @param {Uint8Array} descriptors a `FileDescriptorSet`
 * @returns {Types}
 */
export function typesOf(descriptors) {
  /** @type {Types} */
  const types = { messages: new Map(), enums: new Map() };
  for (const [, file] of fields(descriptors)) {
    if (!(file instanceof Uint8Array)) continue;
    const parts = [...fields(file)];
    const prefix = `.${text(parts, 2)}`;
    for (const body of blocks(parts, 4)) addMessage(body, prefix, types);
    for (const body of blocks(parts, 5)) addEnum(body, prefix, types);
  }
  return types;
}

/** @param {Uint8Array} body @param {string} prefix @param {Types} types */
function addMessage(body, prefix, types) {
  const parts = [...fields(body)];
  const name = `${prefix}.${text(parts, 1)}`;
  /** @type {Map<number, Field>} */
  const found = new Map();
  for (const field of blocks(parts, 2)) {
    const of = [...fields(field)];
    const number = value(of, 3);
    found.set(number, {
      name: text(of, 1),
      number,
      kind: value(of, 5),
      type: text(of, 6),
      repeated: value(of, 4) === REPEATED,
      optional: value(of, 17) !== 0,
    });
  }
  types.messages.set(name, { fields: found, blank: {} });
  for (const nested of blocks(parts, 3)) addMessage(nested, name, types);
  for (const nested of blocks(parts, 4)) addEnum(nested, name, types);
}

/** @param {Uint8Array} body @param {string} prefix @param {Types} types */
function addEnum(body, prefix, types) {
  const parts = [...fields(body)];
  const values = blocks(parts, 2).map((of) => [...fields(of)]);
  types.enums.set(`${prefix}.${text(parts, 1)}`, new Map(values.map((of) => [value(of, 2), text(of, 1)])));
}

/** @typedef {[number, number | Uint8Array, number][]} Parts */

/** @param {Parts} parts @param {number} number @returns {Uint8Array[]} */
function blocks(parts, number) {
  return parts.flatMap(([of, block]) => (of === number && block instanceof Uint8Array ? [block] : []));
}

/** @param {Parts} parts @param {number} number */
function text(parts, number) {
  const [block] = blocks(parts, number);
  return block ? textOf(block) : '';
}

/** @param {Parts} parts @param {number} number */
function value(parts, number) {
  const found = parts.find(([of]) => of === number)?.[1];
  return typeof found === 'number' ? found : 0;
}

/**
 * A function that decodes the messages of a channel; with a name, only the field of this name.
 * @param {import('./mcap.js').Schema} schema
 * @returns {(data: Uint8Array, only?: string) => any}
 */
export function decoder(schema) {
  const types = typesOf(schema.data);
  for (const type of types.messages.values()) {
    for (const field of type.fields.values()) {
      type.blank[field.name] = field.repeated ? [] : blank(field, types);
    }
  }
  return (data, only) => decode(types, `.${schema.name}`, data, 0, only);
}

/** The value of an absent field. @param {Field} field @param {Types} types */
function blank(field, types) {
  if (field.optional || field.kind === KIND.message) return null;
  if (field.kind === KIND.string) return '';
  if (field.kind === KIND.bytes) return new Uint8Array();
  if (field.kind === KIND.bool) return false;
  if (field.kind === KIND.enum) return types.enums.get(field.type)?.get(0) ?? '0';
  return 0;
}

/**
 * @param {Types} types
 * @param {string} name
 * @param {Uint8Array} data
 * @param {number} depth
 * @param {string} [only]
 */
function decode(types, name, data, depth, only) {
  const type = types.messages.get(name);
  if (!type || depth > DEPTH_LIMIT) return null;
  const message = { ...type.blank };
  for (const [number, raw, wire] of fields(data)) {
    const field = type.fields.get(number);
    if (!field || (only !== undefined && field.name !== only)) continue;
    if (!field.repeated) {
      message[field.name] = single(types, field, raw, depth);
      continue;
    }
    const list = message[field.name] === type.blank[field.name] ? [] : message[field.name];
    message[field.name] = list;
    if (wire === 2 && raw instanceof Uint8Array && isNumber(field.kind)) unpack(types, field, raw, list);
    else list.push(single(types, field, raw, depth));
  }
  return message;
}

/** @param {number} kind */
function isNumber(kind) {
  return kind !== KIND.string && kind !== KIND.message && kind !== KIND.bytes;
}

/**
 * Append the numbers of a packed field.
 * @param {Types} types
 * @param {Field} field
 * @param {Uint8Array} raw
 * @param {any[]} list
 */
function unpack(types, field, raw, list) {
  const view = new DataView(raw.buffer, raw.byteOffset, raw.byteLength);
  const size = { [KIND.double]: 8, [KIND.fixed64]: 8, [KIND.float]: 4, [KIND.fixed32]: 4 }[field.kind];
  if (size) {
    for (let at = 0; at + size <= raw.length; at += size) {
      list.push(size === 8 ? view.getFloat64(at, true) : view.getUint32(at, true));
    }
    return;
  }
  let [number, scale] = [0, 1];
  for (const byte of raw) {
    number += (byte & 0x7f) * scale;
    scale *= 128;
    if (byte < 0x80) {
      list.push(single(types, field, number, 0));
      [number, scale] = [0, 1];
    }
  }
}

/** @param {Types} types @param {Field} field @param {number | Uint8Array} raw @param {number} depth */
function single(types, field, raw, depth) {
  if (raw instanceof Uint8Array) {
    if (field.kind === KIND.string) return textOf(raw);
    if (field.kind === KIND.message) return decode(types, field.type, raw, depth + 1);
    return raw;
  }
  if (field.kind === KIND.bool) return raw !== 0;
  if (field.kind === KIND.enum) return types.enums.get(field.type)?.get(raw) ?? String(raw);
  if (field.kind === KIND.sint32 || field.kind === KIND.sint64) {
    return raw % 2 === 0 ? raw / 2 : -(raw + 1) / 2;
  }
  // A negative int32 is written as 64 bits.
  if (field.kind === KIND.int32 || field.kind === KIND.int64) return raw >= 2 ** 63 ? raw - 2 ** 64 : raw;
  return raw;
}
