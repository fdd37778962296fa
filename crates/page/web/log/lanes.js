// The commands of each level as bars over time.

import { Reader } from './series.js';
import { isFailure, word } from './state.js';

/**
 * @typedef {'move' | 'hand' | 'look' | 'change' | 'pause'} Kind
 * @typedef {{ start: number, end: number, done: number, text: string, kind: Kind, failed: boolean }} Bar
 *   `done`: tick in which the command ended; until `end` the process waited for the next one
 * @typedef {{ id: string, name: string, bars: Bar[] }} Lane
 */

const KINDS = /** @type {[Kind, RegExp][]} */ ([
  ['pause', /PAUSE|ROBOT-INIT|STARTUP|SHUTDOWN/],
  ['look', /LOCATE|flood|precise|MOV-TO-VU/],
  ['change', /^QC|GET-ENDEFF|MOV-TO-HOL/],
  [
    'hand',
    /GRASP|GRIP|RELEASE|ACQUIRE|REMOVE|INSERT|POSITION|GET-OBJECT|GO-UNTIL|GO-WHILE|PLACE|OPEN|CLOSE|FLIP/,
  ],
]);

/** What a command does, by its name. @param {string} text @returns {Kind} */
export function kindOf(text) {
  return KINDS.find(([, pattern]) => pattern.test(text))?.[0] ?? 'move';
}

const DONE = /^(done|finished|fingers-closed|qc-(un)?locked)/;

/** Processes with lanes. */
const COMMANDED = ['task', 'subtask', 'emove', 'prim', 'quick_change', 'grip', 'v_grip', 'tool_grip'];

/** The lanes of a run, extended while it is in progress. */
export class Lanes {
  /** @param {import('./log.js').Log} log */
  constructor(log) {
    this.tracks = new Map(COMMANDED.map((id) => [id, new Track(log, id)]));
  }

  /**
   * Process new commands and messages, up to the last tick.
   * @param {Map<string, import('./messages.js').Command[]>} orders new commands
   * @param {number} last
   */
  update(orders, last) {
    for (const [id, track] of this.tracks) track.update(orders.get(id) ?? [], last);
  }

  /** Forget the bars that end before a tick. @param {number} tick */
  trim(tick) {
    for (const track of this.tracks.values()) track.bars = track.bars.filter((bar) => bar.end >= tick);
  }

  /** @param {string} id @returns {Bar[]} */
  of(id) {
    return this.tracks.get(id)?.bars ?? [];
  }

  /**
   * Job, Task to Prim, Quick Change if it did anything, grippers, vision.
   * @param {import('./job.js').RunCommand[]} commands
   * @param {{ tick: number, status: string }[]} vision
   * @param {number} last
   * @returns {Lane[]}
   */
  all(commands, vision, last) {
    const grippers = ['grip', 'v_grip', 'tool_grip'].flatMap((id) => this.of(id));
    grippers.sort((a, b) => a.start - b.start);
    grippers.forEach((bar, index) => {
      const next = grippers[index + 1];
      if (next) [bar.end, bar.done] = [Math.min(bar.end, next.start), Math.min(bar.done, next.start)];
    });
    const job = commands.map((command) => ({
      start: command.first_tick,
      end: Math.min(command.last_tick, last),
      done: Math.min(command.last_tick, last),
      text: command.text,
      kind: kindOf(command.text),
      failed: command.status === 'error',
    }));
    const change = this.of('quick_change');
    return [
      { id: 'workstation', name: 'Job', bars: job },
      { id: 'task', name: 'Task', bars: this.of('task') },
      { id: 'subtask', name: 'Subtask', bars: this.of('subtask') },
      { id: 'emove', name: 'E-move', bars: this.of('emove') },
      { id: 'prim', name: 'Prim', bars: this.of('prim') },
      ...(change.length > 2 ? [{ id: 'quick_change', name: 'Quick Change', bars: change }] : []),
      { id: 'grip', name: 'Gripper', bars: grippers },
      { id: 'vision', name: 'Vision', bars: visionBars(vision, last) },
    ];
  }
}

/** The commands of a process. */
class Track {
  /** @param {import('./log.js').Log} log @param {string} id */
  constructor(log, id) {
    this.statuses = new Reader(log, `/${id}/status`, 'report');
    /** @type {Bar[]} */
    this.bars = [];
    this.answered = true;
  }

  /** @param {import('./messages.js').Command[]} orders @param {number} last */
  update(orders, last) {
    const statuses = [...this.statuses.fresh()];
    let at = 0;
    // The answer to a command arrives at the earliest in the tick after it.
    const answersUpTo = (/** @type {number} */ tick) => {
      for (; at < statuses.length && statuses[at][0] <= tick; at++) this.answer(...statuses[at]);
    };
    for (const { tick, text } of orders) {
      answersUpTo(tick);
      this.extend(tick);
      this.bars.push({ start: tick, end: tick, done: tick, text, kind: kindOf(text), failed: false });
      this.answered = false;
    }
    answersUpTo(Infinity);
    this.extend(last);
  }

  /** @param {number} tick @param {any} status */
  answer(tick, status) {
    const bar = this.bars.at(-1);
    if (!bar || this.answered || tick <= bar.start) return;
    const failed = isFailure(status);
    if (!failed && !DONE.test(word(status.report))) return;
    [bar.done, bar.failed, this.answered] = [tick, failed, true];
  }

  /** Extend the last command up to a tick. @param {number} tick */
  extend(tick) {
    const bar = this.bars.at(-1);
    if (!bar) return;
    bar.end = tick;
    if (!this.answered) bar.done = tick;
  }
}

/**
 * A bar for each picture that vision analysed.
 * @param {{ tick: number, status: string }[]} vision
 * @param {number} last
 * @returns {Bar[]}
 */
function visionBars(vision, last) {
  return vision.flatMap(({ tick, status }, index) => {
    if (status !== 'busy') return [];
    const answer = vision[index + 1];
    const end = answer?.tick ?? last;
    const text = answer?.status ?? 'busy';
    const failed = !/^(done|idle|busy)$/.test(text);
    return [{ start: tick, end, done: end, text, kind: /** @type {Kind} */ ('look'), failed }];
  });
}
