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
/** Depth at which decoding of nested messages ends. */
const DEPTH_LIMIT = 32;

/**
 * Iterates over the fields of a message without making objects, because a log has millions of fields.
 *
 * After `next`, `number` is the number of the field. A number is in `value`; other fields are the bytes from `from` to
 * `to`, which are a text, a message or packed numbers.
 */
export class Wire {
  /** @param {DataView} view @param {number} from @param {number} to */
  constructor(view, from, to) {
    this.view = view;
    this.at = from;
    this.end = to;
    this.number = 0;
    this.value = 0;
    this.from = 0;
    this.to = 0;
    /** The field is bytes. */
    this.isBlock = false;
  }

  /** Move to the next field. Returns false at the end. @throws {RangeError} if the message is damaged */
  next() {
    if (this.at >= this.end) return false;
    const key = this.varint();
    this.number = Math.floor(key / 8);
    const wire = key % 8;
    this.isBlock = wire === 2;
    if (wire === 0) {
      this.value = this.varint();
      return true;
    }
    const size = wire === 1 ? 8 : wire === 5 ? 4 : wire === 2 ? this.varint() : NaN;
    if (!(this.at + size <= this.end)) throw new RangeError('a message ends in the middle of a field');
    this.from = this.at;
    this.at += size;
    this.to = this.at;
    if (wire === 1) this.value = this.view.getFloat64(this.from, true);
    else if (wire === 5) this.value = this.view.getUint32(this.from, true);
    return true;
  }

  varint() {
    const { view, end } = this;
    let [value, scale] = [0, 1];
    for (;;) {
      if (this.at >= end) throw new RangeError('a message ends in the middle of a number');
      const byte = view.getUint8(this.at++);
      value += (byte & 0x7f) * scale;
      if (byte < 0x80) return value;
      scale *= 128;
    }
  }

  /** The fields of the message in this field. */
  inside() {
    return new Wire(this.view, this.from, this.to);
  }

  /** The bytes of this field, not copied. */
  get block() {
    return new Uint8Array(this.view.buffer, this.view.byteOffset + this.from, this.to - this.from);
  }
}

/** The fields of a message. @param {Uint8Array} bytes */
export function wireOf(bytes) {
  return new Wire(new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength), 0, bytes.length);
}

/**
 * The fields of a message as a list: number and value.
 * @param {Uint8Array} bytes
 * @returns {Parts}
 */
function fields(bytes) {
  /** @type {Parts} */
  const found = [];
  for (const wire = wireOf(bytes); wire.next();)
    found.push([wire.number, wire.isBlock ? wire.block : wire.value]);
  return found;
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
    const parts = fields(file);
    const prefix = `.${text(parts, 2)}`;
    for (const body of blocks(parts, 4)) addMessage(body, prefix, types);
    for (const body of blocks(parts, 5)) addEnum(body, prefix, types);
  }
  return types;
}

/** @param {Uint8Array} body @param {string} prefix @param {Types} types */
function addMessage(body, prefix, types) {
  const parts = fields(body);
  const name = `${prefix}.${text(parts, 1)}`;
  /** @type {Map<number, Field>} */
  const found = new Map();
  for (const field of blocks(parts, 2)) {
    const of = fields(field);
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
  const parts = fields(body);
  const values = blocks(parts, 2).map(fields);
  types.enums.set(`${prefix}.${text(parts, 1)}`, new Map(values.map((of) => [value(of, 2), text(of, 1)])));
}

/** @typedef {[number, number | Uint8Array][]} Parts */

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
  return (data, only) => decode(types, `.${schema.name}`, wireOf(data), 0, only);
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
 * @param {Wire} wire
 * @param {number} depth
 * @param {string} [only]
 */
function decode(types, name, wire, depth, only) {
  const type = types.messages.get(name);
  if (!type || depth > DEPTH_LIMIT) return null;
  const message = { ...type.blank };
  while (wire.next()) {
    const field = type.fields.get(wire.number);
    if (!field || (only !== undefined && field.name !== only)) continue;
    if (!field.repeated) {
      message[field.name] = single(types, field, wire, depth);
      continue;
    }
    const list = message[field.name] === type.blank[field.name] ? [] : message[field.name];
    message[field.name] = list;
    if (wire.isBlock && isNumber(field.kind)) unpack(types, field, wire, list);
    else list.push(single(types, field, wire, depth));
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
 * @param {Wire} wire
 * @param {any[]} list
 */
function unpack(types, field, { view, from, to }, list) {
  const size = { [KIND.double]: 8, [KIND.fixed64]: 8, [KIND.float]: 4, [KIND.fixed32]: 4 }[field.kind];
  if (size) {
    for (let at = from; at + size <= to; at += size) {
      list.push(size === 8 ? view.getFloat64(at, true) : view.getUint32(at, true));
    }
    return;
  }
  for (const packed = new Wire(view, from, to); packed.at < to;)
    list.push(numberOf(types, field, packed.varint()));
}

/** @param {Types} types @param {Field} field @param {Wire} wire @param {number} depth */
function single(types, field, wire, depth) {
  if (!wire.isBlock) return numberOf(types, field, wire.value);
  if (field.kind === KIND.string) return textOf(wire.block);
  if (field.kind === KIND.message) return decode(types, field.type, wire.inside(), depth + 1);
  return wire.block;
}

/** @param {Types} types @param {Field} field @param {number} raw */
function numberOf(types, field, raw) {
  if (field.kind === KIND.bool) return raw !== 0;
  if (field.kind === KIND.enum) return types.enums.get(field.type)?.get(raw) ?? String(raw);
  if (field.kind === KIND.sint32 || field.kind === KIND.sint64) {
    return raw % 2 === 0 ? raw / 2 : -(raw + 1) / 2;
  }
  // A negative int32 is written as 64 bits.
  if (field.kind === KIND.int32 || field.kind === KIND.int64) return raw >= 2 ** 63 ? raw - 2 ** 64 : raw;
  return raw;
}
