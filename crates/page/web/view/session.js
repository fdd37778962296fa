// A run in progress: its connection, its messages, and the requests of the person at the page.

import { Connection, LOOK } from '../log/connection.js';
import { seconds, TICK_S } from '../log/units.js';

/** Nanoseconds of a tick. */
const TICK_NS = 40_000_000n;
/** Key of the token in the storage of this tab. */
const TOKEN = 'rcs-token';
/** Metadata with the time of tick 0. */
const TICK_0 = 'tick_0_ns';

/** @typedef {{ line: string, text: string, refused: boolean }} Answer */

export class Session {
  /**
   * @param {import('../log/live.js').LiveLog} log
   * @param {() => void} changed
   */
  constructor(log, changed) {
    this.log = log;
    this.changed = changed;
    this.zero = BigInt(log.run.get(TICK_0) ?? '0');
    /** Identifier of the run; empty before the first connection. */
    this.id = '';
    /** The line that was sent last, and its answer. @type {Answer | null} */
    this.answer = null;
    /** Lines that were sent from the field, the last one at the end. @type {string[]} */
    this.typed = [];
    const address = location.origin.replace(/^http/, 'ws');
    this.connection = new Connection(`${address}/`, {
      begin: (info) => this.begin(info),
      open: (channel) => log.open(channel),
      message: (topic, time, data) => log.take({ topic, tick: this.tick(time), data: data.slice() }),
      time: (time) => log.complete(this.tick(time) - 1),
      changed: () => {
        if (this.mayOperate) keep(this.connection.token);
        changed();
      },
    });
    this.takeToken();
    // A timer detects silence in time, even in a browser that draws slowly or not at all.
    setInterval(() => this.connection.watch(), LOOK);
  }

  /** The tick at a time. @param {bigint} time */
  tick(time) {
    return Number((time - this.zero) / TICK_NS);
  }

  /** @param {any} info */
  begin(info) {
    // Another run has another job and another start time, so it needs its own page.
    if (this.id !== '' && this.id !== info.sessionId) location.reload();
    this.id = info.sessionId;
  }

  /** The token of the address or of this tab. It is removed from the address, to keep it out of the history. */
  takeToken() {
    const hash = new URLSearchParams(location.hash.slice(1));
    const given = hash.get('token');
    if (given !== null) {
      hash.delete('token');
      history.replaceState(null, '', `${location.pathname}#${hash}`);
    }
    const token = given ?? kept();
    if (token && token !== this.connection.token) this.authorize(token);
  }

  /** @param {string} token */
  authorize(token) {
    this.connection.authorize(token.trim());
  }

  /** Returns true if messages arrive. */
  get isConnected() {
    return this.connection.state === 'ok';
  }

  /** Returns true if the person may send requests. */
  get mayOperate() {
    return this.connection.right === 'accepted' && this.connection.service !== null;
  }

  /** The reason why no messages arrive, in parts; null if messages arrive. */
  get loss() {
    const { state, heard, attempts, next } = this.connection;
    if (state === 'ok') return null;
    const now = performance.now();
    const ago = heard === null ? 'not seen yet' : `${((now - heard) / 1000).toFixed(1)} s ago`;
    const again = next > now ? `, the next in ${Math.ceil((next - now) / 1000)} s` : '';
    return { state, ago, attempt: attempts > 0 ? `attempt ${attempts}${again}` : '' };
  }

  /**
   * Send a line as an operator; its answer is shown.
   * @param {string} line
   */
  async ask(line) {
    this.answer = { line, text: 'sent', refused: false };
    this.changed();
    const sent = this.answer;
    try {
      sent.text = await this.connection.ask(line);
    } catch (error) {
      [sent.text, sent.refused] = [error instanceof Error ? error.message : String(error), true];
    }
    this.changed();
  }

  /** Send a line that was typed. @param {string} line */
  type(line) {
    this.typed = [...this.typed.filter((it) => it !== line), line].slice(-50);
    void this.ask(line);
  }

  /** The time since a tick, as text. @param {number} tick */
  ago(tick) {
    return `${((this.log.last - tick) * TICK_S).toFixed(1)} s ago, ${seconds(tick)}`;
  }
}

/** The token that this tab has used; empty if there is none, or if the browser keeps nothing. */
function kept() {
  try {
    return sessionStorage.getItem(TOKEN) ?? '';
  } catch {
    return '';
  }
}

/** Keep a token for the next page of this tab, if the browser allows it. @param {string} token */
function keep(token) {
  try {
    sessionStorage.setItem(TOKEN, token);
  } catch {
    // The person enters it again.
  }
}
