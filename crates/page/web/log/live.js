// The log of a run in progress: messages of the live view are added, and the oldest are removed.

import { decoderOf, Log } from './log.js';
import { Series } from './series.js';

/** Limit of the stored messages in bytes, and the share that is removed above it. */
const LIMIT = { bytes: 96 << 20, share: 0.25 };

/** @typedef {{ topic: string, tick: number, data: Uint8Array }} Arrival */

export class LiveLog extends Log {
  /** @param {string} name @param {import('./mcap.js').Mcap} file start of the run: its metadata and files */
  constructor(name, file) {
    super(name, file);
    this.last = 0;
    /** Messages of ticks that may still be incomplete. @type {Arrival[]} */
    this.waiting = [];
    /** Size of the messages that are kept. */
    this.bytes = 0;
    /** First tick with all its messages; 0 before the first message. @type {number} */
    this.first = 0;
  }

  /** Add a channel. @param {import('./mcap.js').Channel} channel */
  open(channel) {
    this.file.channels.set(channel.topic, channel);
    if (!this.loaded.has(channel.topic)) this.loaded.set(channel.topic, new Series([], decoderOf(channel)));
  }

  /** Store a message. It is shown when its tick is complete. @param {Arrival} arrival */
  take(arrival) {
    // After a loss the server starts with a state whose time the log already has.
    if (arrival.tick <= this.last && (this.loaded.get(arrival.topic)?.length ?? 0) > 0) return;
    this.waiting.push(arrival);
  }

  /** Show the messages up to a tick, which have all arrived. @param {number} tick */
  complete(tick) {
    this.last = Math.max(this.last, tick);
    // A message repeated for a new viewer has the tick of its repetition.
    const ready = this.waiting.filter((arrival) => arrival.tick <= tick);
    if (ready.length === 0) return;
    if (this.first === 0) this.first = ready.reduce((least, arrival) => Math.min(least, arrival.tick), tick);
    this.waiting = this.waiting.filter((arrival) => arrival.tick > tick);
    for (const { topic, tick: of, data } of ready) {
      const series = this.loaded.get(topic);
      if (!series) continue;
      const before = series.length > 0 ? series.tick(series.length - 1) : 0;
      series.push({ tick: Math.max(before, of), data });
      this.bytes += data.length;
    }
  }

  /** Remove the oldest part above the limit. Returns true if something was removed. */
  trim() {
    if (this.bytes <= LIMIT.bytes) return false;
    this.first += Math.ceil((this.last - this.first) * LIMIT.share);
    for (const series of this.loaded.values()) this.bytes -= series.trim(this.first);
    return true;
  }

  /** Does nothing, because every received topic is loaded. */
  async load() {}
}
