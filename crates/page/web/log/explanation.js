// The chain of a failure: commands down to the first cause, reports up from it.
//
// `why.json` has it as sentences, as `rcs-log why --json` prints them. They are split here for the view.

import { idOf } from './processes.js';

/**
 * @typedef {object} Cause
 * @property {number} tick
 * @property {string | null} process id of the process that failed first; null for an event in the cell
 * @property {string} title what went wrong
 * @property {string} detail
 * @property {'failure' | 'contact' | 'ended'} kind
 *
 * @typedef {object} Link
 * @property {number} tick
 * @property {'command' | 'cause' | 'report' | 'cell'} kind
 * @property {string | null} process id; null for the cell
 * @property {string} from name of the process
 * @property {string} to name of the commanded process; empty for reports
 * @property {string} text
 * @property {string} row table, row and action, such as `LOCATE-OBJ 7 Fail(NothingSeen)`
 * @property {string} news what is new in this tick
 */

/**
 * What went wrong first; null if the run finished.
 * @param {import('./run.js').Run} run
 * @returns {Cause | null}
 */
export function causeOf(run) {
  const { why } = run;
  if (!why) return null;
  const failure = why.failure;
  const world = why.world;
  if (failure && (!world || world.tick >= failure.causes.at(-1)?.tick)) {
    const first = failure.causes.at(-1) ?? failure;
    const sentence = split(first.text);
    const title = reasonIn(run, first.text) ?? reasonIn(run, failure.text) ?? sentence.head;
    const [, executing] = /while it executed (.*?) \(table/.exec(failure.text) ?? [];
    return {
      tick: first.tick,
      process: idOf(first.process ?? ''),
      title,
      detail: executing ?? '',
      kind: 'failure',
    };
  }
  if (world && (failure || why.ended !== 'finished')) {
    const [title, ...rest] = world.text.replace(/^HWSC: /, 'Workstation: ').split(', ');
    const kind = /runs into/.test(title) ? 'contact' : 'failure';
    return { tick: world.tick, process: null, title, detail: rest.join(', '), kind };
  }
  return null;
}

/**
 * The text of the reason in a sentence; null if it has none.
 * @param {import('./run.js').Run} run
 * @param {string} sentence
 */
function reasonIn(run, sentence) {
  const found = run.reasons.filter((reason) => sentence.includes(reason.text));
  return found.sort((a, b) => b.text.length - a.text.length)[0]?.text ?? null;
}

/**
 * What to do next after the failure of a process; null for an event in the cell, of which the program has no
 * remedy.
 * @param {import('./run.js').Run} run
 */
export function remedyOf(run) {
  if (!run.cause?.process) return null;
  const reason = run.reasons.find((it) => it.text === run.cause?.title);
  return reason?.remedy ?? 'PAUSE and the same command may be enough.';
}

/**
 * The chain of the failure, from the first command to the last report.
 * @param {import('./run.js').Run} run
 * @returns {Link[]}
 */
export function chainOf(run) {
  const { why, cause } = run;
  if (!why || !cause) return [];
  const source = cause.process || !why.world ? why.failure : why.world;
  const events = run.lines
    .filter((line) => line.source === 'fault' && line.tick <= cause.tick)
    .map((line) => cell(line.tick, line.text));
  const commands = source.commands.map((/** @type {any} */ it) => command(it));
  const down = [...events, ...commands].sort((a, b) => a.tick - b.tick);
  if (source !== why.failure) {
    const first = {
      ...cell(cause.tick, why.world.text.replace(/^HWSC: /, 'Workstation: ')),
      kind: /** @type {const} */ ('cause'),
    };
    return [...down, first, ...(why.failure ? reports(why.failure.causes.toReversed(), 'report') : [])];
  }
  const [first, ...rest] = why.failure.causes.toReversed();
  return [
    ...down,
    ...reports([first], 'cause'),
    ...reports([...rest, ...why.failure.consequences], 'report'),
  ];
}

/** @param {number} tick @param {string} text @returns {Link} */
function cell(tick, text) {
  return { tick, kind: 'cell', process: null, from: 'In the cell', to: '', text, row: '', news: '' };
}

/** @param {{ tick: number, process: string, text: string }} link @returns {Link} */
function command({ tick, process, text }) {
  const { head, row } = split(text);
  const [, to, order] = /^commands (.+?): (.*?)(?:, number \d+)?$/.exec(head) ?? ['', '', head];
  const from = process === 'HWSC' ? 'Workstation' : process;
  return { tick, kind: 'command', process: idOf(process), from, to, text: order, row, news: '' };
}

/**
 * @param {{ tick: number, process: string, text: string }[]} links
 * @param {'cause' | 'report'} kind
 * @returns {Link[]}
 */
function reports(links, kind) {
  return links.map(({ tick, process, text }) => {
    const { head, row, news } = split(text);
    return { tick, kind, process: idOf(process), from: process, to: '', text: head, row, news };
  });
}

/**
 * A sentence in parts: `reports X (table T row 7: A, because B); new in this tick: C`.
 * @param {string} text
 */
function split(text) {
  const [, head, table, row, action, news] =
    /^(.*?) \(table (\S+) row (\d+): (.*?)\)(?:; new in this tick: (.*))?$/s.exec(text) ?? [
      '',
      text,
      '',
      '',
      '',
      '',
    ];
  const short = action.replace(/,? (because|in step|then) .*$/s, '').replace(/,$/, '');
  return { head, row: table ? `${table} ${row} ${short}` : '', news: news ?? '' };
}
