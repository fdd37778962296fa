// An open log: its facts, its files, and its topics as series.

import { textOf } from './bytes.js';
import { jointState } from './cdr.js';
import { readMcap } from './mcap.js';
import { decoder } from './protobuf.js';
import { Series } from './series.js';

/**
 * Topics that only the list of fields and the pictures of the cell need: they are read when they are shown.
 */
const LATER = ['/emove/estimates', '/joint_states', '/prim/poses', '/tf'];
const RUN = 'rcs-run';
const END = 'rcs-end';

export class Log {
  /** @param {string} name @param {import('./mcap.js').Mcap} file */
  constructor(name, file) {
    this.name = name;
    this.file = file;
    this.run = file.metadata.get(RUN) ?? new Map();
    this.end = file.metadata.get(END) ?? null;
    /** @type {Map<string, Series<any>>} */
    this.loaded = new Map();
    this.last = 0;
  }

  /** The topics, sorted. */
  get topics() {
    return [...this.file.channels.keys()].sort();
  }

  /** Reads topics, so that `series` has them. @param {string[]} topics */
  async load(topics) {
    const missing = topics.filter((topic) => !this.loaded.has(topic));
    await Promise.all(
      missing.map(async (topic) => {
        const messages = await this.file.messages(topic);
        this.loaded.set(topic, new Series(messages, decoderOf(this.file.channels.get(topic))));
        this.last = Math.max(this.last, messages.at(-1)?.tick ?? 0);
      }),
    );
  }

  /** Returns true if a topic can be read without waiting. @param {string} topic */
  has(topic) {
    return this.loaded.has(topic) || !this.file.channels.has(topic);
  }

  /** The messages of a topic; none if it is not loaded. @param {string} topic @returns {Series<any>} */
  series(topic) {
    return this.loaded.get(topic) ?? NONE;
  }

  /** A file of the run as text; empty if it has none. @param {string} name */
  text(name) {
    const bytes = this.file.attachments.get(name);
    return bytes ? textOf(bytes) : '';
  }

  /** A file of the run as JSON; null if it has none. @param {string} name */
  json(name) {
    const text = this.text(name);
    return text === '' ? null : JSON.parse(text);
  }
}

/** @type {Series<any>} */
const NONE = new Series([], () => null);

/** The function that decodes the messages of a channel. @param {import('./mcap.js').Channel | undefined} channel */
export function decoderOf(channel) {
  if (channel?.encoding === 'cdr') return jointState;
  if (channel?.encoding === 'protobuf' && channel.schema) return decoder(channel.schema);
  return () => null;
}

/**
 * Opens a log: reads all topics but those that are large.
 * @param {string} name
 * @param {Uint8Array} bytes
 */
export async function openLog(name, bytes) {
  const file = await readMcap(bytes);
  if (!file.metadata.has(RUN))
    throw new Error('This MCAP file is not a log of rcs-run: it does not say what ran.');
  const log = new Log(name, file);
  await log.load(log.topics.filter((topic) => !LATER.includes(topic) && topic !== '/replay'));
  const ticks = Number(log.end?.get('ticks'));
  if (ticks > 0) log.last = Math.max(log.last, ticks);
  return log;
}
