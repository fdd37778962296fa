import assert from 'node:assert/strict';
import { deflateSync } from 'node:zlib';
import { test } from 'node:test';
import { readMcap } from './mcap.js';

const MAGIC = [0x89, 0x4d, 0x43, 0x41, 0x50, 0x30, 0x0d, 0x0a];

const u16 = (value) => [value & 255, value >> 8];
const u32 = (value) => [...u16(value & 65535), ...u16(value >>> 16)];
const u64 = (value) => [...u32(value), ...u32(0)];
const text = (value) => [...u32(value.length), ...Buffer.from(value)];
const record = (code, body) => [code, ...u64(body.length), ...body];
const message = (channel, tick, data) =>
  record(5, [...u16(channel), ...u32(tick), ...u64(0), ...u64(0), ...data]);

function chunk(compression, records, size = records.length) {
  const data = compression === 'deflate' ? [...deflateSync(Buffer.from(records))] : records;
  return record(6, [
    ...u64(0),
    ...u64(0),
    ...u64(size),
    ...u32(0),
    ...text(compression),
    ...u64(data.length),
    ...data,
  ]);
}

const schema = record(3, [...u16(1), ...text('rcs.Row'), ...text('protobuf'), ...u32(2), 7, 8]);
const channel = (id, topic) =>
  record(4, [...u16(id), ...u16(1), ...text(topic), ...text('protobuf'), ...u32(0)]);
const index = (id) => record(7, [...u16(id), ...u32(0)]);

test('messages_of_a_topic_are_read_from_its_chunks_only', async () => {
  const bytes = [
    ...MAGIC,
    ...schema,
    ...channel(4, '/a'),
    ...channel(5, '/b'),
    ...chunk('deflate', [...message(4, 1, [1, 2]), ...message(4, 3, [])]),
    ...index(4),
    ...chunk('lz4', [0]),
    ...index(5),
    ...chunk('', message(4, 9, [3])),
    ...index(4),
    ...MAGIC,
  ];
  const file = await readMcap(Uint8Array.from(bytes));
  assert.equal(file.complete, true);
  assert.deepEqual(file.channels.get('/a')?.schema?.data, Uint8Array.from([7, 8]));
  const found = await file.messages('/a');
  assert.deepEqual(
    found.map(({ tick, data }) => [tick, ...data]),
    [[1, 1, 2], [3], [9, 3]],
  );
  assert.deepEqual(await file.messages('/none'), []);
  await assert.rejects(file.messages('/b'), /cannot decompress lz4.*rcs-log page/);
});

test('a_file_without_its_end_is_read_up_to_the_cut', async () => {
  // The channels are in the chunk, as in a log whose program was killed.
  const whole = [
    ...MAGIC,
    ...chunk('', [...schema, ...channel(4, '/a'), ...message(4, 1, [1])]),
    ...record(5, [1, 2, 3]),
  ];
  for (const cut of [0, 1, 5]) {
    const file = await readMcap(Uint8Array.from(whole.slice(0, whole.length - cut)));
    assert.equal(file.complete, false);
    assert.deepEqual(
      (await file.messages('/a')).map((it) => it.tick),
      [1],
    );
  }
});

test('attachments_are_decompressed_and_metadata_are_maps', async () => {
  const packed = [...deflateSync(Buffer.from('[1]'))];
  const attached = (name, data) =>
    record(9, [...u64(0), ...u64(0), ...text(name), ...text(''), ...u64(data.length), ...data, ...u32(0)]);
  const map = [...text('job'), ...text('linkbar')];
  const file = await readMcap(
    Uint8Array.from([
      ...MAGIC,
      ...attached('why.json.deflate', packed),
      ...attached('job', [65]),
      ...record(12, [...text('rcs-run'), ...u32(map.length), ...map]),
    ]),
  );
  assert.equal(Buffer.from(file.attachments.get('why.json') ?? []).toString(), '[1]');
  assert.deepEqual(file.attachments.get('job'), Uint8Array.from([65]));
  assert.equal(file.metadata.get('rcs-run')?.get('job'), 'linkbar');
});

test('files_that_are_no_log_or_lie_about_their_size_are_refused', async () => {
  await assert.rejects(readMcap(Uint8Array.from([1, 2, 3])), /does not begin as an MCAP file/);
  const bomb = [
    ...MAGIC,
    ...schema,
    ...channel(4, '/a'),
    ...chunk('deflate', message(4, 1, Array(100).fill(0)), 10),
    ...index(4),
  ];
  const file = await readMcap(Uint8Array.from(bomb));
  await assert.rejects(file.messages('/a'), /larger than expected/);
});
