// The rows that a process decided, from its topic `/PROCESS/row`.

/**
 * @typedef {object} RowMessage
 * @property {string} table
 * @property {number} table_number
 * @property {number} row 0 if the process has decided nothing yet
 * @property {string} action
 * @property {string} next
 * @property {string} step step of the command after the row
 * @property {string} [step_before] step in which the row was looked up; logs of earlier versions lack it
 * @property {boolean} resting no row fired in this tick: the process rests
 * @property {string} values
 * @property {string} beside
 * @property {number} fired_tick
 */

/**
 * A table that was consulted in a tick.
 * @typedef {{ table: string, row: number, values: Record<string, string> }} Consulted
 */

/**
 * What a process decided.
 * @typedef {object} Decision
 * @property {number} since tick from which the message holds
 * @property {number} fired tick in which the row fired last
 * @property {string} table
 * @property {number} row
 * @property {Record<string, string>} values
 * @property {string} step step of the command after the row
 * @property {string} before step of the command before the message: the row was looked up in it, or in `step`
 * @property {string | undefined} lookedUp step in which the row was looked up, if the log has it
 * @property {string} next step that the row names; empty if the step stays
 * @property {boolean} resting
 * @property {Consulted[]} beside other tables of the same tick
 */

/**
 * The row of a process in a tick; null if it has decided nothing yet.
 * @param {import('./series.js').Series<RowMessage>} rows
 * @param {number} tick
 * @returns {Decision | null}
 */
export function decisionAt(rows, tick) {
  const index = rows.index(tick);
  if (index < 0) return null;
  const message = rows.get(index);
  if (message.row === 0) return null;
  const before = index > 0 ? rows.get(index - 1).step : '';
  return {
    since: rows.tick(index),
    // A row that fires in every tick is written once, and fires until the message changes.
    fired: message.resting ? message.fired_tick : tick,
    table: message.table,
    row: message.row,
    values: valuesOf(message.values),
    step: message.step,
    before,
    lookedUp: message.step_before,
    next: message.next,
    resting: message.resting,
    beside: besideOf(message.beside),
  };
}

/** The values of a text such as `work Busy, clock Running`. @param {string} text */
export function valuesOf(text) {
  /** @type {Record<string, string>} */
  const values = {};
  for (const part of text.split(', ')) {
    const [name, value] = part.split(' ');
    if (value) values[name] = value;
  }
  return values;
}

/**
 * The tables of `SEARCH row 1 (place Known); ATTEND row 3 (pause Other)`.
 * @param {string} text
 * @returns {Consulted[]}
 */
export function besideOf(text) {
  return text.split('; ').flatMap((part) => {
    const match = /^(.+) row (\d+) \((.*)\)$/.exec(part);
    return match ? [{ table: match[1], row: Number(match[2]), values: valuesOf(match[3]) }] : [];
  });
}

/**
 * The rows of one table over a stretch of ticks, also where it was consulted beside another.
 * @param {import('./series.js').Series<RowMessage>} rows
 * @param {string} table
 * @param {number} from
 * @param {number} to last tick
 * @returns {{ row: number, start: number, end: number, resting: boolean }[]} `end` is the tick after it
 */
export function rowsBetween(rows, table, from, to) {
  const found = [];
  for (let index = Math.max(0, rows.index(from)); index < rows.length && rows.tick(index) <= to; index++) {
    const message = rows.get(index);
    const own = message.table === table;
    const row = own ? message.row : besideOf(message.beside).find((it) => it.table === table)?.row;
    if (!row) continue;
    const start = Math.max(rows.tick(index), from);
    const end = index + 1 < rows.length ? Math.min(rows.tick(index + 1), to + 1) : to + 1;
    found.push({ row, start, end, resting: own && message.resting });
  }
  return found;
}
