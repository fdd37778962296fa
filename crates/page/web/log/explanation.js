// The chain of a failure: commands down to the first cause, reports up from it.
//
// `why.json` has it as sentences, as `rcs-log why --json` prints them. They are split here for the view.

import { idOf } from './processes.js';
import { reportedChain } from './reports.js';

/**
 * @typedef {object} Link
 * @property {number} tick
 * @property {'command' | 'cause' | 'report' | 'cell' | 'then'} kind `then`: a later failure
 * @property {string | null} process id; null for the cell
 * @property {string} from name of the process, or of the kind of failure
 * @property {string} to name of the commanded process; empty for reports
 * @property {string} text
 * @property {string} row table, row and action, such as `LOCATE-OBJ 7 Fail(NothingSeen)`
 * @property {string} news what is new in this tick
 */

/**
 * What to do next after the failure of a process; null for an event in the cell, for which the program has no
 * remedy.
 * @param {import('./run.js').Run} run
 */
export function remedyOf(run) {
  if (!run.cause?.process) return null;
  const reason = run.reasons.find((it) => it.text === run.cause?.title);
  return reason?.remedy ?? 'PAUSE and the same command may be enough.';
}

/**
 * The chain of the failures, from the first command to the last report.
 * @param {import('./run.js').Run} run
 * @returns {Link[]}
 */
export function chainOf(run) {
  const { why, cause } = run;
  if (!cause) return [];
  if (!why) return reportedChain(run);
  const faults = run.lines
    .filter((line) => line.source === 'fault' && line.tick <= cause.tick)
    .map((line) => event(line.tick, 'cell', 'In the cell', line.text));
  const commands = (cause.explained ? why.failure : why.world).commands;
  const down = [...faults, ...commands.map((/** @type {any} */ it) => command(it))];
  const links = run.failures.flatMap((failure, index) => linksOf(why, failure, index === 0));
  return [...down.sort((a, b) => a.tick - b.tick), ...links.sort((a, b) => a.tick - b.tick)];
}

/**
 * A failure with the reports that it led to.
 * @param {any} why
 * @param {import('./account.js').Failure} failure
 * @param {boolean} first
 * @returns {Link[]}
 */
function linksOf(why, { tick, name, title, detail, explained }, first) {
  const kind = first ? 'cause' : 'then';
  // The head of the pane has the details of the first failure.
  if (!explained) return [event(tick, kind, name, first || !detail ? title : `${title}: ${detail}`)];
  const [root, ...rest] = why.failure.causes.toReversed();
  return [...reports([root], kind), ...reports([...rest, ...why.failure.consequences], 'report')];
}

/**
 * Something that no process reports.
 * @param {number} tick
 * @param {Link['kind']} kind
 * @param {string} from
 * @param {string} text
 * @returns {Link}
 */
function event(tick, kind, from, text) {
  return { tick, kind, process: null, from, to: '', text, row: '', news: '' };
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
 * @param {Link['kind']} kind
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
  const parts = /^(.*?) \(table (\S+) row (\d+): (.*?)\)(?:; new in this tick: (.*))?$/s.exec(text);
  const [, head, table, row, action, news] = parts ?? ['', text, '', '', '', ''];
  const short = action.replace(/,? (because|in step|then) .*$/s, '').replace(/,$/, '');
  return { head, row: table ? `${table} ${row} ${short}` : '', news: news ?? '' };
}
