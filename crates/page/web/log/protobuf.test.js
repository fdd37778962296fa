import assert from 'node:assert/strict';
import { test } from 'node:test';
import { decoder } from './protobuf.js';

const size = (length) => (length < 128 ? [length] : [(length & 127) | 128, length >> 7]);
const bytes = (number, body) => [number * 8 + 2, ...size(body.length), ...body];
const text = (number, value) => bytes(number, [...Buffer.from(value)]);
const varint = (number, value) => [number * 8, value];

/** A field of a descriptor: name, number, type, label, name of the type. */
function field(name, number, type, { label = 1, of = '', optional = 0 } = {}) {
  return bytes(2, [
    ...text(1, name),
    ...varint(3, number),
    ...varint(4, label),
    ...varint(5, type),
    ...(of ? text(6, of) : []),
    ...(optional ? [17 * 8, 1, 1] : []),
  ]);
}

const lamp = [
  ...text(1, 'Lamp'),
  ...field('number', 1, 13),
  ...field('light', 2, 14, { of: '.rcs.Light.Value' }),
  ...field('hours', 3, 17, { label: 3 }),
  ...field('name', 4, 9),
  ...field('inner', 6, 11, { label: 3, of: '.rcs.Inner' }),
  ...field('level', 7, 1),
  ...field('lit', 8, 8),
  ...field('spare', 9, 13, { optional: 1 }),
  ...field('last', 10, 11, { of: '.rcs.Inner' }),
];
const inner = [...text(1, 'Inner'), ...field('at', 1, 17)];
const value = (name, number) => bytes(2, [...text(1, name), ...varint(2, number)]);
const light = [
  ...text(1, 'Light'),
  ...bytes(4, [...text(1, 'Value'), ...value('off', 0), ...value('on', 1)]),
];
const file = [
  ...text(1, 'rcs.proto'),
  ...text(2, 'rcs'),
  ...bytes(4, lamp),
  ...bytes(4, inner),
  ...bytes(4, light),
];
const decode = decoder({ name: 'rcs.Lamp', encoding: 'protobuf', data: Uint8Array.from(bytes(1, file)) });

test('a_message_is_decoded_field_by_field', () => {
  // The bytes of `record::proto::message::tests::a_message_field_by_field`.
  const message = [
    0x08,
    0xac,
    0x02,
    0x10,
    0x01,
    0x1a,
    0x03,
    0x01,
    0x90,
    0x03,
    0x22,
    0x04,
    ...Buffer.from('LAMP'),
    0x32,
    0x02,
    0x08,
    0x00,
    0x32,
    0x02,
    0x08,
    0x03,
    0x39,
    0,
    0,
    0,
    0,
    0,
    0,
    0xf8,
    0x3f,
    0x40,
    0x01,
  ];
  assert.deepEqual(decode(Uint8Array.from(message)), {
    number: 300,
    light: 'on',
    hours: [-1, 200],
    name: 'LAMP',
    inner: [{ at: 0 }, { at: -2 }],
    level: 1.5,
    lit: true,
    spare: null,
    last: null,
  });
});

test('absent_fields_have_their_defaults_and_lists_are_not_shared', () => {
  const blank = {
    number: 0,
    light: 'off',
    hours: [],
    name: '',
    inner: [],
    level: 0,
    lit: false,
    spare: null,
    last: null,
  };
  assert.deepEqual(decode(new Uint8Array()), blank);
  decode(Uint8Array.from([0x1a, 1, 1]));
  assert.deepEqual(decode(new Uint8Array()), blank);
});

test('one_field_is_decoded_alone', () => {
  assert.deepEqual(decode(Uint8Array.from([0x08, 7, 0x10, 1]), 'light'), {
    ...decode(new Uint8Array()),
    light: 'on',
  });
});

test('a_cut_message_is_an_error', () => {
  for (const cut of [[0x08], [0x22, 4, 65], [0x39, 0]])
    assert.throws(() => decode(Uint8Array.from(cut)), RangeError);
});
