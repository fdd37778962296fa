// The failures of a run: the first one, and those that followed.
//
// `why.json` has it as `rcs-log why --json` prints it: `world` is the first failure, with the others in
// `followed`. `failure` explains the first one that a process reports.

import { idOf } from './processes.js';

/**
 * @typedef {object} Failure
 * @property {number} tick
 * @property {string} kind such as `collision`
 * @property {string} name the kind for a person: `Collision`
 * @property {string | null} process id of the process that reports it; null for an event in the cell
 * @property {string} title what went wrong, in one clause
 * @property {string} detail the rest of the sentence; empty if there is none
 * @property {boolean} explained its rows are in `failure` of `why.json`
 */

/** Names of the kinds of failures. @type {Record<string, string>} */
const NAMES = {
  'emergency-stop': 'Emergency stop',
  power: 'Loss of power',
  collision: 'Collision',
  lost: 'Lost part',
  device: 'Failed device',
  'robot-controller': 'Robot warning',
  link: 'Lost link',
  'off-path': 'Off the path',
  process: 'Process error',
  'false-report': 'False report',
  misplaced: 'Misplaced part',
  job: 'Job stopped',
  program: 'Program failure',
};

/** Where the first clause of a failure ends. */
const END = /: |; |, (?=while it executed |without a command|with the hand at )/;

/**
 * The failures in their order; none if the run finished.
 * @param {any} why `why.json`
 * @param {{ text: string }[]} reasons
 * @returns {Failure[]}
 */
export function failuresOf(why, reasons) {
  const { world, failure } = why ?? {};
  const known = failure?.text;
  const root = failure?.causes.at(-1);
  const single = known ? [{ tick: failure.tick, kind: 'process', process: root?.process, text: known }] : [];
  const all = world ? [world, ...(world.followed ?? [])] : single;
  return all.map((it) => {
    const same = it.text === known || (it.table !== null && it.tick === failure?.tick);
    const explained = root !== undefined && same;
    const { title, detail } = clauses(it.process ?? '', it.text);
    return {
      tick: explained ? root.tick : it.tick,
      kind: it.kind,
      name: NAMES[it.kind] ?? 'Failure',
      process: idOf(explained ? root.process : (it.process ?? '')),
      title: (explained && (reasonIn(reasons, root.text) ?? reasonIn(reasons, it.text))) || title,
      detail,
      explained,
    };
  });
}

/**
 * The first clause of a failure, and the rest without its table: the chain shows that.
 * @param {string} process name, which the sentence may begin with
 * @param {string} text
 */
export function clauses(process, text) {
  const said = [process, 'HWSC'].find((name) => name && text.startsWith(`${name}: `));
  const sentence = text.slice(said ? said.length + 2 : 0).replace(/ \(table .*\)$/s, '');
  const end = END.exec(sentence);
  if (!end) return { title: sentence, detail: '' };
  return { title: sentence.slice(0, end.index), detail: sentence.slice(end.index + end[0].length) };
}

/**
 * The text of the reason in a sentence; null if it has none.
 * @param {{ text: string }[]} reasons
 * @param {string} sentence
 */
function reasonIn(reasons, sentence) {
  const found = reasons.filter((reason) => sentence.includes(reason.text));
  return found.sort((a, b) => b.text.length - a.text.length)[0]?.text ?? null;
}
