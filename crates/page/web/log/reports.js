// The failure that a run reports while it is in progress. The answer of `rcs-log why` exists only for a log.
//
// The reports are shown in their order, with the commands in force. No cause is searched for.

import { idOf } from './processes.js';

/** After this number of ticks without a report, the next report begins another failure. */
const APART = 250;
/** Codes of errors that are not reports of a failure: the end of a contact, and the summary at the end of a run. */
const NO_REPORT = ['contact.ends', 'run.failed'];

/** @typedef {import('./messages.js').Line} Line */

export class Reports {
  constructor() {
    /** Reports of the last failure. @type {Line[]} */
    this.list = [];
  }

  /** @param {Line[]} lines */
  add(lines) {
    for (const line of lines.filter(isReport)) {
      const last = this.list.at(-1);
      if (last && line.tick - last.tick > APART) this.list = [];
      this.list.push(line);
    }
  }

  /** The first report of the last failure; null if there is none. @returns {import('./account.js').Failure | null} */
  get first() {
    const [line] = this.list;
    if (!line) return null;
    const process = idOf(line.source);
    const isContact = line.code === 'contact.begins';
    return {
      // A contact is reported one tick later.
      tick: isContact ? line.tick - 1 : line.tick,
      kind: process ? 'process' : isContact ? 'collision' : 'cell',
      name: process ? 'Reported failure' : isContact ? 'Collision' : 'In the cell',
      process,
      title: parts(line.text).text,
      detail: '',
      explained: false,
    };
  }
}

/** @param {Line} line */
function isReport({ level, source, text, code }) {
  // The line with the status of Task's command is not a report.
  return (
    level === 'error' && !NO_REPORT.includes(code) && !(source === 'Task' && /^command \d+: /.test(text))
  );
}

/**
 * A report in parts: `vision sees no object (LOCATE-OBJ row 7: sight Missing => Fail(NothingSeen))`.
 * @param {string} line
 */
function parts(line) {
  const [, text, table, row, action] = /^(.*) \((\S+) row (\d+): .*?=> (.*)\)$/s.exec(line) ?? ['', line];
  return { text, row: table ? `${table} ${row} ${action}` : '' };
}

/**
 * The commands in force at the first report, from the highest process down, and the reports.
 * @param {import('./run.js').Run} run
 * @returns {import('./explanation.js').Link[]}
 */
export function reportedChain({ lines, reports }) {
  const { first, list } = reports;
  if (!first) return [];
  /** @type {import('./explanation.js').Link[]} */
  const found = [];
  const before = lines.filter((line) => line.tick <= first.tick);
  const nothing = { to: '', row: '', news: '' };
  for (let name = list[0].source; ;) {
    const order = before.findLast((line) => line.text.startsWith(`-> ${name}: `));
    if (!order) break;
    const text = order.text.slice(name.length + 5);
    found.unshift({
      ...nothing,
      tick: order.tick,
      kind: 'command',
      process: idOf(order.source),
      from: order.source,
      to: name,
      text,
    });
    name = order.source;
  }
  const task = before.findLast(({ source, text }) => source === 'Task' && /^command \d+: [A-Z]/.test(text));
  if (task) {
    const text = task.text.replace(/^command \d+: /, '');
    found.unshift({
      ...nothing,
      tick: task.tick,
      kind: 'command',
      process: 'workstation',
      from: 'Workstation',
      to: 'Task',
      text,
    });
  }
  for (const fault of before.filter(({ code }) => code === 'fault.begins'))
    found.push({
      ...nothing,
      tick: fault.tick,
      kind: 'cell',
      process: null,
      from: 'In the cell',
      text: fault.text,
    });
  found.sort((a, b) => a.tick - b.tick);
  list.forEach((line, index) => {
    const { text, row } = parts(line.text);
    const process = idOf(line.source);
    const from = process ? line.source : 'In the cell';
    found.push({
      ...nothing,
      tick: line.tick,
      kind: index === 0 ? 'cause' : 'report',
      process,
      from,
      text,
      row,
    });
  });
  return found;
}
