// The messages of a topic over time.

/** Number of decoded messages that a series keeps. */
const KEPT = 512;

/** @template T */
export class Series {
  /**
   * @param {import('./mcap.js').Message[]} messages in the order of their ticks
   * @param {(data: Uint8Array, only?: string) => T} decode
   */
  constructor(messages, decode) {
    this.messages = messages;
    this.decode = decode;
    /** @type {Map<number, T>} */
    this.decoded = new Map();
    /** Number of messages that were removed from the start. */
    this.removed = 0;
  }

  /** Append a message. @param {import('./mcap.js').Message} message */
  push(message) {
    this.messages.push(message);
  }

  /**
   * Remove the messages before a tick, except the last of them: its value is still valid in that tick. Returns the
   * number of removed bytes.
   * @param {number} tick
   */
  trim(tick) {
    const count = Math.max(0, this.index(tick - 1));
    const bytes = this.messages.splice(0, count).reduce((sum, { data }) => sum + data.length, 0);
    this.removed += count;
    if (count > 0) this.decoded.clear();
    return bytes;
  }

  get length() {
    return this.messages.length;
  }

  /** Index of the last message up to a tick; -1 if there is none. @param {number} tick */
  index(tick) {
    return lastUpTo(this.messages, tick, (message) => message.tick);
  }

  /** Tick of a message. @param {number} index */
  tick(index) {
    return this.messages[index].tick;
  }

  /** A message. @param {number} index @returns {T} */
  get(index) {
    const known = this.decoded.get(index);
    if (known !== undefined) return known;
    const value = this.decode(this.messages[index].data);
    if (this.decoded.size >= KEPT) this.decoded.clear();
    this.decoded.set(index, value);
    return value;
  }

  /** The last message up to a tick; null if there is none. @param {number} tick @returns {T | null} */
  latest(tick) {
    const index = this.index(tick);
    return index < 0 ? null : this.get(index);
  }

  /** All messages with their ticks. @returns {Generator<[number, T]>} */
  *[Symbol.iterator]() {
    for (const { tick, data } of this.messages) yield [tick, this.decode(data)];
  }

  /**
   * All messages with their ticks, with one of their fields only.
   * @param {string} only
   * @returns {Generator<[number, T]>}
   */
  *each(only) {
    for (const { tick, data } of this.messages) yield [tick, this.decode(data, only)];
  }
}

/** Reads each message of a topic once, also those that arrive later. */
export class Reader {
  /**
   * @param {{ series(topic: string): Series<any> }} log
   * @param {string} topic
   * @param {string} [only] field to decode; all without it
   */
  constructor(log, topic, only) {
    this.log = log;
    this.topic = topic;
    this.only = only;
    this.next = 0;
  }

  /** The messages since the last call, with their ticks. @returns {Generator<[number, any]>} */
  *fresh() {
    const series = this.log.series(this.topic);
    for (const { tick, data } of this.messages()) yield [tick, series.decode(data, this.only)];
  }

  /** The messages since the last call, not decoded. */
  messages() {
    const series = this.log.series(this.topic);
    const found = series.messages.slice(Math.max(0, this.next - series.removed));
    this.next = series.removed + series.length;
    return found;
  }
}

/**
 * Index of the last item of a sorted list whose key is at most a value; -1 if there is none.
 * @template I
 * @param {readonly I[]} list
 * @param {number} value
 * @param {(item: I) => number} key
 */
export function lastUpTo(list, value, key) {
  let [low, high] = [0, list.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (key(list[middle]) <= value) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}
