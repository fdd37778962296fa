// Decision tables: the rows that fit, why others do not, and the rows that another value would have fired.

/**
 * @typedef {{ name: string, doc: string }} Named
 * @typedef {{ steps: string[], when: Record<string, string[]>, action: string, next: string | null }} Row
 * @typedef {{ name: string, doc: string, values: Named[] }} Variable
 * @typedef {{ name: string, doc: string, arguments: Named[] }} Action
 * @typedef {object} Table
 * @property {string} name
 * @property {string} doc
 * @property {string} source
 * @property {Named[]} steps
 * @property {Variable[]} variables
 * @property {Action[]} actions
 * @property {Row[]} rows
 * @typedef {{ process: string, tables: Table[] }} ProcessTables
 * @typedef {Record<string, string>} Values
 */

/** Name of the step in the list of reasons why a row does not fit. */
export const STEP = 'step';

/** A step in the form of another text: `letting-go` and `LettingGo` are the same. @param {string} text */
export function plain(text) {
  return text.replace(/[-_ ]/g, '').toLowerCase();
}

/**
 * The variables for which a row does not fit, `step` among them; none if it fits. An unknown value fits.
 * @param {Row} row
 * @param {Values} values
 * @param {string} step empty if it is not known
 */
export function mismatches(row, values, step) {
  const found = [];
  if (row.steps.length > 0 && step !== '' && !row.steps.some((it) => plain(it) === plain(step)))
    found.push(STEP);
  for (const [name, allowed] of Object.entries(row.when)) {
    if (values[name] !== undefined && !allowed.includes(values[name])) found.push(name);
  }
  return found;
}

/**
 * Number of the first row that fits; 0 if none does.
 * @param {Table} table
 * @param {Values} values
 * @param {string} step
 */
export function firstRow(table, values, step) {
  return table.rows.findIndex((row) => mismatches(row, values, step).length === 0) + 1;
}

/**
 * The rows that would have fired if one variable had had another value.
 * @param {Table} table
 * @param {Values} values
 * @param {string} step
 * @param {number} fired number of the row that fired
 * @returns {Map<number, { variable: string, value: string }>} by number
 */
export function nearMisses(table, values, step, fired) {
  const found = new Map();
  for (const variable of table.variables) {
    if (values[variable.name] === undefined) continue;
    for (const { name: value } of variable.values) {
      if (value === values[variable.name]) continue;
      const row = firstRow(table, { ...values, [variable.name]: value }, step);
      if (row > 0 && row !== fired && !found.has(row)) found.set(row, { variable: variable.name, value });
    }
  }
  return found;
}

/**
 * The step in which a row was looked up. A log of an earlier version has the step after the row only; then this is
 * the step that explains the row: the one before the message, the one after it, or the first one of the table.
 * @param {Table} table
 * @param {import('./rows.js').Decision} decision
 */
export function stepBefore(table, { row, values, before, step, next, lookedUp }) {
  if (table.steps.length === 0) return '';
  if (lookedUp) return lookedUp;
  const candidates = [next ? before : step, before, table.steps[0].name, step].filter((it) => it !== '');
  return candidates.find((it) => firstRow(table, values, it) === row) ?? candidates[0] ?? '';
}

/** The doc of a value of a variable. @param {Table} table @param {string} variable @param {string} value */
export function valueDoc(table, variable, value) {
  const of = table.variables.find((it) => it.name === variable);
  return { question: of?.doc ?? '', answer: of?.values.find((it) => it.name === value)?.doc ?? '' };
}

/** The doc of an action such as `Fail(NothingSeen)`. @param {Table} table @param {string} call */
export function actionDoc(table, call) {
  const [, name, argument] = /^(\w+)(?:\((.*)\))?$/.exec(call) ?? ['', call, ''];
  const action = table.actions.find((it) => it.name === name);
  return {
    action: action?.doc ?? '',
    argument: action?.arguments.find((it) => it.name === argument)?.doc ?? '',
  };
}

/** @typedef {{ row: number } | { first: number, last: number, by: string }} Line */

/**
 * The lines of a table with a limit: rows that fit or nearly fit stay, others fold. A line is a row, or the
 * numbers of
 * folded rows with the variable that most of them do not fit by.
 * @param {string[][]} reasons why each row does not fit
 * @param {(row: number) => boolean} matters
 * @param {number} limit greatest number of lines
 * @returns {Line[]}
 */
export function foldRows(reasons, matters, limit) {
  /** @type {Line[]} */
  const rows = reasons.map((_, index) => ({ row: index + 1 }));
  if (rows.length <= limit) return rows;
  const runs = [];
  for (let first = 1; first <= reasons.length; first++) {
    let last = first;
    while (last <= reasons.length && !matters(last)) last++;
    if (last - first > 1) runs.push({ first, last: last - 1 });
    first = Math.max(first, last);
  }
  // The longest sequences of rows fold first, until the rest fits.
  const folded = new Set();
  let lines = rows.length;
  for (const run of [...runs].sort((a, b) => b.last - b.first - (a.last - a.first))) {
    if (lines <= limit) break;
    folded.add(run);
    lines -= run.last - run.first;
  }
  /** @type {Line[]} */
  const found = [];
  for (let row = 1; row <= reasons.length; row++) {
    const run = runs.find((it) => it.first === row && folded.has(it));
    if (!run) {
      found.push({ row });
      continue;
    }
    found.push({ ...run, by: commonest(reasons.slice(run.first - 1, run.last).map((it) => it[0] ?? '')) });
    row = run.last;
  }
  return found;
}

/** @param {string[]} texts */
function commonest(texts) {
  const count = (/** @type {string} */ text) => texts.filter((it) => it === text).length;
  return [...new Set(texts)].sort((a, b) => count(b) - count(a))[0] ?? '';
}
