// The lines of the job with the ticks in which they ran.
//
// The log has the text of the job and the commands that Task got. Lines of the workstation (`**`) leave no
// message, so
// their ticks are those between the commands around them.

import { Reader } from './series.js';

/**
 * @typedef {{ text: string, station: boolean, start: number, end: number, status: string }} JobLine
 *   `station`: a line that the workstation executes. `start` is Infinity for a line that did not begin.
 * @typedef {{ text: string, first_tick: number, last_tick: number, status: string }} RunCommand
 */

/**
 * @param {string} text the file of the job
 * @param {RunCommand[]} commands what Task executed
 * @returns {JobLine[]}
 */
export function jobLines(text, commands) {
  const executed = commands.filter((command) => command.text !== 'PAUSE');
  /** @type {JobLine[]} */
  const lines = [];
  let at = 0;
  for (const line of text.split('\n').map((it) => it.trim())) {
    const [, mark, rest] = /^(==|\*\*)\s+(.*)$/.exec(line) ?? [];
    if (!mark) continue;
    const before = lines.at(-1);
    const reached = before === undefined || (before.end !== Infinity && before.status !== 'error');
    if (mark === '**') {
      const start = reached ? (before?.end ?? 0) : Infinity;
      lines.push({ text: rest.replace(/\s*#.*$/, ''), station: true, start, end: start, status: '' });
      continue;
    }
    const command = executed[at];
    const begun = command !== undefined;
    if (begun) at += 1;
    lines.push({
      text: begun ? command.text : inWords(rest),
      station: false,
      start: begun ? command.first_tick : Infinity,
      end: begun ? command.last_tick : Infinity,
      status: begun ? command.status : '',
    });
  }
  return lines;
}

/** The lines of the job from `/job/lines`, with their ticks from `/job/state`. */
export class JobProgress {
  /** @param {{ series(topic: string): import('./series.js').Series<any> }} log */
  constructor(log) {
    this.jobs = new Reader(log, '/job/lines');
    this.states = new Reader(log, '/job/state');
    /** @type {JobLine[] | null} */
    this.lines = null;
    this.text = '';
  }

  /** Process the new messages. Returns the lines; null if the log has none. */
  update() {
    for (const [, { lines }] of this.jobs.fresh()) {
      const text = lines.map((/** @type {any} */ line) => line.text).join('\n');
      if (text === this.text) continue;
      this.text = text;
      this.lines = lines.map((/** @type {any} */ line) => lineOfJob(line));
    }
    for (const [tick, state] of this.states.fresh()) this.reach(tick, state);
    return this.lines;
  }

  /** @param {number} tick @param {any} state */
  reach(tick, state) {
    const at = Number(state.index) - 1;
    const line = this.lines?.[at];
    if (!line) return;
    if (line.start === Infinity) {
      line.start = Math.min(tick, Number(state.began) + 1);
      for (const before of this.lines?.slice(0, at) ?? []) {
        before.start = Math.min(before.start, line.start);
        if (before.end === Infinity) [before.end, before.status] = [line.start, 'finished'];
      }
    }
    const failed = state.phase === 'failed' || state.outcome === 'error';
    const over = failed || state.phase === 'over';
    if (over && line.end === Infinity) [line.end, line.status] = [tick, failed ? 'error' : 'finished'];
    // A repeated line is executing again.
    if (state.phase === 'plays' && state.outcome === 'executing' && line.status === 'error')
      [line.end, line.status] = [Infinity, ''];
  }
}

/** @param {{ text: string, is_command: boolean }} line @returns {JobLine} */
function lineOfJob({ text, is_command: isCommand }) {
  const bare = text.replace(/^(==|\*\*)\s*/, '');
  const words = isCommand ? inWords(bare) : bare;
  return { text: words, station: !isCommand, start: Infinity, end: Infinity, status: '' };
}

/**
 * Index of the line that runs in a tick; -1 before the first.
 * @param {JobLine[]} lines
 * @param {number} tick
 */
export function lineAt(lines, tick) {
  return lines.reduce((found, line, index) => (line.start <= tick ? index : found), -1);
}

/**
 * `MOVE LINKBAR1_BH +2 UNIT_1 4 +2 PFIXTURE 0 -- 0` as `MOVE LINKBAR1_BH from UNIT_1:4 to PFIXTURE`.
 * @param {string} line
 */
function inWords(line) {
  const [verb, object, ...rest] = line.replace(/#.*$/, '').trim().split(/\s+/);
  const places = rest.filter((word) => !/^\+/.test(word));
  const place = (/** @type {number} */ at) => {
    const [name, sector] = [places[at], places[at + 1]];
    if (!name || name === '--') return '';
    return sector && sector !== '0' ? `${name}:${sector}` : name;
  };
  const [source, destination] = [place(0), place(2)];
  const words = [
    verb,
    object === '--' ? '' : object,
    source && `from ${source}`,
    destination && `to ${destination}`,
  ];
  return words.filter(Boolean).join(' ');
}
