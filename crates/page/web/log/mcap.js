// Reads an MCAP file, version 0 of the format. Chunks are decompressed when one of their channels is read.
//
// If the program was killed, its file ends inside a record. All records before it are read. The browser
// inflates
// "deflate", which `rcs-log page` writes. It decompresses "zstd", which a run writes, only if it is new
// enough.

import { Cursor } from './bytes.js';

const MAGIC = [0x89, 0x4d, 0x43, 0x41, 0x50, 0x30, 0x0d, 0x0a];
const CODE = {
  schema: 0x03,
  channel: 0x04,
  message: 0x05,
  chunk: 0x06,
  messageIndex: 0x07,
  attachment: 0x09,
  metadata: 0x0c,
};
/** Greatest size of a chunk or a file after decompression, bytes. A chunk of a log has a megabyte. */
const SIZE_LIMIT = 64 << 20;
/** End of the names of files that are compressed. */
const DEFLATED = '.deflate';
/** Size of a message before its data, bytes. */
const MESSAGE_HEAD = 22;

/**
 * @typedef {{ name: string, encoding: string, data: Uint8Array }} Schema
 * @typedef {{ id: number, topic: string, encoding: string, schema: Schema | null }} Channel
 * @typedef {{ compression: string, size: number, data: Uint8Array, channels: Set<number> }} Chunk
 * @typedef {{ tick: number, data: Uint8Array }} Message
 */

/** A file with all data read except its messages. */
export class Mcap {
  constructor() {
    /** @type {Map<string, Channel>} Channels by topic. */
    this.channels = new Map();
    /** @type {Map<string, Uint8Array>} Files by name. */
    this.attachments = new Map();
    /** @type {Map<string, Map<string, string>>} */
    this.metadata = new Map();
    /** True if the file has its end. Otherwise the program that wrote it was killed. */
    this.complete = false;
    /** @type {Chunk[]} */
    this.chunks = [];
    /** @type {Map<number, Schema>} */
    this.schemas = new Map();
    /** @type {Map<Chunk, Promise<Uint8Array>>} */
    this.inflated = new Map();
  }

  /** All messages of a topic, in their order. @param {string} topic @returns {Promise<Message[]>} */
  async messages(topic) {
    const channel = this.channels.get(topic);
    if (!channel) return [];
    const chunks = this.chunks.filter((chunk) => chunk.channels.size === 0 || chunk.channels.has(channel.id));
    const blocks = await Promise.all(chunks.map((chunk) => this.records(chunk)));
    /** @type {Message[]} */
    const found = [];
    for (const block of blocks) {
      for (const [code, body] of records(block)) {
        if (code === CODE.message && body.length >= MESSAGE_HEAD) {
          const view = new DataView(body.buffer, body.byteOffset, MESSAGE_HEAD);
          if (view.getUint16(0, true) === channel.id) {
            found.push({ tick: view.getUint32(2, true), data: body.subarray(MESSAGE_HEAD) });
          }
        }
      }
    }
    return found;
  }

  /** The records of a chunk. @param {Chunk} chunk */
  records(chunk) {
    let block = this.inflated.get(chunk);
    if (!block) {
      block = decompressed(chunk);
      // A chunk of a single channel is read only once, so it is not kept.
      if (chunk.channels.size !== 1) this.inflated.set(chunk, block);
    }
    return block;
  }

  /** @param {number} code @param {Uint8Array} body */
  describe(code, body) {
    const at = new Cursor(body);
    if (code === CODE.schema) {
      const id = at.u16();
      this.schemas.set(id, { name: at.text(), encoding: at.text(), data: at.block(at.u32()) });
    } else if (code === CODE.channel) {
      const [id, schema] = [at.u16(), at.u16()];
      const [topic, encoding] = [at.text(), at.text()];
      if (!this.channels.has(topic)) {
        this.channels.set(topic, { id, topic, encoding, schema: this.schemas.get(schema) ?? null });
      }
    }
  }
}

/**
 * Reads the head of a file.
 * @param {Uint8Array} bytes
 * @throws {Error} if the file is not MCAP
 */
export async function readMcap(bytes) {
  if (!MAGIC.every((byte, at) => bytes[at] === byte)) {
    throw new Error('This file is not a log: it does not begin as an MCAP file does.');
  }
  const file = new Mcap();
  for (const [code, body] of records(bytes.subarray(MAGIC.length))) {
    if (code === CODE.chunk) {
      file.chunks.push(chunkOf(body));
    } else if (code === CODE.messageIndex) {
      file.chunks.at(-1)?.channels.add(new Cursor(body).u16());
    } else if (code === CODE.attachment) {
      const at = new Cursor(body);
      at.take(16);
      const [name] = [at.text(), at.text()];
      const data = at.block(at.u64());
      if (!name.endsWith(DEFLATED)) file.attachments.set(name, data);
      else
        file.attachments.set(name.slice(0, -DEFLATED.length), await decompress(data, 'deflate', SIZE_LIMIT));
    } else if (code === CODE.metadata) {
      const at = new Cursor(body);
      file.metadata.set(at.text(), mapOf(at.block(at.u32())));
    } else {
      file.describe(code, body);
    }
  }
  file.complete = MAGIC.every((byte, at) => bytes[bytes.length - MAGIC.length + at] === byte);
  if (file.channels.size === 0) {
    // In a file without its end, only the chunks describe the channels.
    for (const chunk of file.chunks) {
      for (const [code, body] of records(await file.records(chunk))) file.describe(code, body);
    }
  }
  return file;
}

/**
 * The records of a block: code and body. An incomplete record ends the block.
 * @param {Uint8Array} block
 * @returns {Generator<[number, Uint8Array]>}
 */
function* records(block) {
  const view = new DataView(block.buffer, block.byteOffset, block.byteLength);
  for (let at = 0; at + 9 <= block.length;) {
    const end = at + 9 + Number(view.getBigUint64(at + 1, true));
    if (end > block.length) return;
    yield [block[at], block.subarray(at + 9, end)];
    at = end;
  }
}

/** @param {Uint8Array} body @returns {Chunk} */
function chunkOf(body) {
  const at = new Cursor(body);
  at.take(16);
  const size = at.u64();
  at.take(4);
  const compression = at.text();
  return { compression, size, data: at.block(at.u64()), channels: new Set() };
}

/** @param {Uint8Array} bytes @returns {Map<string, string>} */
function mapOf(bytes) {
  const at = new Cursor(bytes);
  const map = new Map();
  while (at.left > 0) map.set(at.text(), at.text());
  return map;
}

/** @param {Chunk} chunk */
async function decompressed({ compression, size, data }) {
  if (compression === '') return data;
  if (size > SIZE_LIMIT)
    throw new Error(`A chunk of the log has ${size} bytes; at most ${SIZE_LIMIT} are read.`);
  return decompress(data, compression, size);
}

/**
 * @param {Uint8Array} data
 * @param {string} compression
 * @param {number} limit greatest size of the result, bytes
 * @returns {Promise<Uint8Array>}
 */
async function decompress(data, compression, limit) {
  let stream;
  try {
    stream = new DecompressionStream(/** @type {CompressionFormat} */ (compression));
  } catch {
    throw new Error(
      `This browser cannot decompress ${compression}. Write a page instead: rcs-log page LOG -o run.html`,
    );
  }
  const parts = [];
  let size = 0;
  const reader = new Blob([/** @type {BlobPart} */ (data)]).stream().pipeThrough(stream).getReader();
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    size += value.length;
    if (size > limit) throw new Error('A part of the log is larger than expected: the log is damaged.');
    parts.push(value);
  }
  const out = new Uint8Array(size);
  let at = 0;
  for (const part of parts) {
    out.set(part, at);
    at += part.length;
  }
  return out;
}
