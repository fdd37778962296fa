// The log of a run in progress: it grows with the messages of the live view, and forgets its oldest part.

import { decoderOf, Log } from './log.js';
import { Series } from './series.js';

/** Bytes of messages that are kept, and the share that is removed when there are more. */
const LIMIT = { bytes: 96 << 20, share: 0.25 };

/** @typedef {{ topic: string, tick: number, data: Uint8Array }} Arrival */

export class LiveLog extends Log {
  /** @param {string} name @param {import('./mcap.js').Mcap} file start of the run: its metadata and files */
  constructor(name, file) {
    super(name, file);
    this.last = 0;
    /** Messages of ticks that may not be complete. @type {Arrival[]} */
    this.waiting = [];
    /** Size of the messages that are kept. */
    this.bytes = 0;
    /** First tick of which everything is known; 0 before the first message. @type {number} */
    this.first = 0;
  }

  /** Add a channel. @param {import('./mcap.js').Channel} channel */
  open(channel) {
    this.file.channels.set(channel.topic, channel);
    if (!this.loaded.has(channel.topic)) this.loaded.set(channel.topic, new Series([], decoderOf(channel)));
  }

  /** Take a message; it is shown when its tick is complete. @param {Arrival} arrival */
  take(arrival) {
    // After a loss the server begins with the state of a time that is known.
    if (arrival.tick <= this.last && (this.loaded.get(arrival.topic)?.length ?? 0) > 0) return;
    this.waiting.push(arrival);
  }

  /** All messages up to a tick have arrived. @param {number} tick */
  complete(tick) {
    this.last = Math.max(this.last, tick);
    // A message that was sent again to a new viewer has the tick in which it was sent.
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

  /** Forget the oldest part if there is too much. Returns true if something was forgotten. */
  trim() {
    if (this.bytes <= LIMIT.bytes) return false;
    this.first += Math.ceil((this.last - this.first) * LIMIT.share);
    for (const series of this.loaded.values()) this.bytes -= series.trim(this.first);
    return true;
  }

  /** Every topic that has arrived is loaded. */
  async load() {}
}
