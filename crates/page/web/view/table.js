// A decision table: the decision of the process as a sentence, and all rows with their matching and other conditions.

import { processOf } from '../log/processes.js';
import { decisionAt } from '../log/rows.js';
import { stateOf } from '../log/state.js';
import { actionDoc, foldRows, mismatches, nearMisses, plain, stepBefore, valueDoc } from '../log/tables.js';
import { TICK_S } from '../log/units.js';
import { h } from './dom.js';
import { columnHeads, fold, ruler, tableRow } from './table-rows.js';

/**
 * A table as it was consulted in a tick.
 * @typedef {object} Consultation
 * @property {import('../log/tables.js').Table} table
 * @property {number} number of the table in its process
 * @property {number} row that fired; 0 if the tables do not belong to this log
 * @property {Record<string, string>} values
 * @property {string} step in which the row was looked up; empty if it is not known
 * @property {boolean} decides it is the table that decided
 * @property {import('../log/rows.js').Decision} decision of the process
 * @property {boolean} failed
 */

/** Pixels at letters of 14: letter, rest of a column, number, error of the estimate, score. */
const WIDTH = { letter: 6.1, column: 22, number: 40, spare: 26, score: [54, 92, 190] };
/**
 * Heights of a line of the matrix, of the list, of the list on a phone, and of all else; pixels at letters
 * of 14.
 */
const HEIGHT = { row: 24, text: 30, phone: 56, rest: 178 };

/**
 * The content of the pane; null if the process has no table or has decided nothing.
 * @param {import('./ui.js').Context} context
 * @returns {Consultation | null}
 */
export function consultation({ run, ui }) {
  const tables = run.tables.find((it) => it.process === processOf(ui.process).name)?.tables ?? [];
  const decision = decisionAt(run.log.series(`/${ui.process}/row`), ui.tick);
  if (!decision) return null;
  const beside = decision.beside.find((it) => it.table === ui.consulted);
  const shown = beside ?? decision;
  const index = tables.findIndex((it) => it.name === shown.table);
  if (index < 0) return null;
  const table = tables[index];
  return {
    table,
    number: index + 1,
    row: shown.row,
    values: shown.values,
    step: beside ? '' : stepBefore(table, decision),
    decides: !beside,
    decision,
    failed: !beside && stateOf(run, ui.process, ui.tick).condition === 'failed',
  };
}

/**
 * @param {import('./ui.js').Context} context
 * @param {import('./dom.js').Child} panels the choice of what the pane shows
 * @param {{ width: number, height: number, em: number }} room
 */
export function tablePane(context, panels, room) {
  const shown = consultation(context);
  if (!shown) return noTable(context, panels);
  const { table, values, step, row } = shown;
  const reasons = table.rows.map((it) => mismatches(it, values, step));
  const near = row > 0 ? nearMisses(table, values, step, row) : new Map();
  const layout = layoutOf(table, room);
  const matters = (/** @type {number} */ it) => it === row || near.has(it) || reasons[it - 1].length === 0;
  const height = layout.phone ? HEIGHT.phone : layout.list ? HEIGHT.text : HEIGHT.row;
  const limit = context.ui.allRows
    ? Infinity
    : Math.max(7, Math.floor((room.height / room.em - HEIGHT.rest) / height));
  const lines = foldRows(reasons, matters, limit);
  const folds = lines.length < table.rows.length;
  return [
    head(context, shown, panels, folds),
    sentence(context, shown),
    h(
      'div',
      { class: 'table-body' },
      h(
        'div',
        { class: 'table-scroll', tabindex: 0, style: `--rollw:${layout.score}px` },
        h(
          'table',
          { class: 'rows' },
          columnHeads(shown, layout),
          h(
            'tbody',
            {},
            lines.map((line) =>
              'row' in line ? tableRow(shown, layout, line.row, reasons, near) : fold(line, layout),
            ),
          ),
        ),
        h('canvas', { class: 'score', 'aria-hidden': 'true' }),
        room.height / room.em - HEIGHT.rest - lines.length * HEIGHT.row > 110 ? about(table) : null,
      ),
      table.rows.length > 12 ? ruler(shown, reasons, near) : null,
    ),
    foot(shown, near.size),
  ];
}

/** @typedef {{ list: boolean, variables: string[], steps: boolean, score: number, phone: boolean }} Layout */

/**
 * @param {import('../log/tables.js').Table} table
 * @param {{ width: number, em: number }} room
 * @returns {Layout}
 */
function layoutOf(table, { width, em }) {
  const variables = [...new Set(table.rows.flatMap((row) => Object.keys(row.when)))];
  const steps = table.rows.some((row) => row.steps.length > 0);
  const shown = [
    ...(steps ? [table.steps.map((it) => it.name)] : []),
    ...variables.map((name) => [name, ...valuesOf(table, name)]),
    table.rows.map((row) => row.action + (row.next ? ` → ${row.next}` : '')),
  ];
  const letters = shown.reduce((sum, texts) => sum + Math.max(...texts.map((text) => text.length)), 0);
  const needed = (WIDTH.number + shown.length * WIDTH.column + letters * WIDTH.letter) * em;
  const [least, small, most] = WIDTH.score;
  const list = variables.length > 8 || needed + small > width;
  const left = list ? width * 0.15 : width - needed - WIDTH.spare;
  return {
    list,
    variables,
    steps,
    score: width < 500 ? least : Math.round(Math.max(small, Math.min(most, left))),
    phone: width < 500,
  };
}

/**
 * Values of a variable that rows name.
 * @param {import('../log/tables.js').Table} table
 * @param {string} name
 */
function valuesOf(table, name) {
  return table.rows.flatMap((row) => row.when[name]?.slice(0, 1) ?? []);
}

/**
 * @param {import('./ui.js').Context} context
 * @param {Consultation} shown
 * @param {import('./dom.js').Child} panels
 * @param {boolean} folds
 */
function head({ ui }, shown, panels, folds) {
  const others = [shown.decision, ...shown.decision.beside].filter((it) => it.table !== shown.table.name);
  const chips = others.map((it) =>
    h(
      'button',
      {
        class: 'chip',
        'data-do': `consulted:${it === shown.decision ? '' : it.table}`,
        title: it === shown.decision ? 'the table that decided' : 'also consulted in this tick',
      },
      `${it.table} ${it.row}`,
    ),
  );
  return h(
    'div',
    { class: 'pane-head' },
    h(
      'h2',
      { class: 'table-title' },
      h('span', { class: 'p' }, processOf(ui.process).name),
      shown.table.name,
      h('small', {}, `table ${shown.number}`),
    ),
    // The word and the first chip are kept together, so they wrap to the next line together.
    chips.length
      ? h('div', { class: 'chips' }, h('span', {}, h('small', {}, 'also'), chips[0]), chips.slice(1))
      : null,
    h('div', { class: 'sp' }),
    folds || ui.allRows
      ? h(
          'button',
          {
            class: `text-button key ${ui.allRows ? 'on' : ''}`,
            'data-do': 'allRows',
            'data-key': 'a',
            'aria-pressed': String(ui.allRows),
          },
          'all rows',
        )
      : null,
    panels,
  );
}

/**
 * The action of the row and its reason, as a sentence.
 * @param {import('./ui.js').Context} context
 * @param {Consultation} shown
 */
function sentence({ ui }, { table, row, values, step, decision, decides, failed }) {
  const fired = table.rows[row - 1];
  if (!fired)
    return h(
      'div',
      { class: 'decision rest' },
      h('span', { class: 'row-number' }, '–'),
      h('div', { class: 'd' }, 'The log names a row that this table does not have.'),
    );
  const resting = decides && decision.resting && !failed;
  const doc = actionDoc(table, fired.action);
  const does = fired.action.startsWith('consult') ? 'Consult the next table' : withoutStop(doc.action);
  const reasons = [];
  if (fired.steps.length > 0 && step) {
    const name = table.steps.find((it) => plain(it.name) === plain(step));
    reasons.push(
      h('span', {}, h('b', {}, `step ${name?.name ?? step}`), name?.doc ? ` – ${lower(name.doc)}` : ''),
    );
  }
  for (const variable of Object.keys(fired.when)) {
    const { answer } = valueDoc(table, variable, values[variable]);
    const value = h('b', {}, `${variable} ${values[variable] ?? ''}`);
    reasons.push(h('span', {}, value, answer ? ` – ${lower(answer)}` : ''));
  }
  const ago = ((ui.tick - decision.fired) * TICK_S).toFixed(1);
  return h(
    'div',
    { class: `decision ${failed ? 'bad' : resting ? 'rest' : ''}` },
    h('span', { class: 'row-number', title: `row ${row} of ${table.rows.length}` }, String(row)),
    h(
      'div',
      { class: 'd' },
      does + (doc.argument ? `: ${lower(doc.argument)}` : ''),
      h('span', { class: 'mono' }, fired.action + (fired.next ? ` → ${fired.next}` : '')),
    ),
    h(
      'div',
      { class: 'b' },
      reasons.length ? ['because ', ...reasons.flatMap((it, at) => (at ? [' · ', it] : [it]))] : 'always',
      decides && decision.resting
        ? h('span', { class: 'dim' }, ` — in tick ${decision.fired}, ${ago} s ago`)
        : null,
    ),
  );
}

/** The purpose of the table, and what its names mean. @param {import('../log/tables.js').Table} table */
function about(table) {
  const asked = new Set(table.rows.flatMap((row) => Object.keys(row.when)));
  const variables = table.variables.filter((it) => asked.has(it.name) && it.doc);
  const entry = (/** @type {{ name: string, doc: string }} */ it) => [
    h('dt', {}, it.name),
    h('dd', {}, it.doc),
  ];
  return h(
    'div',
    { class: 'about' },
    h('p', {}, table.doc),
    h(
      'dl',
      {},
      variables.flatMap(entry),
      table.steps.length
        ? [h('dt', { class: 'hd' }, 'steps'), h('dd', {}), table.steps.flatMap(entry)].flat()
        : null,
    ),
  );
}

/** @param {Consultation} shown @param {number} near */
function foot({ table }, near) {
  return h(
    'div',
    { class: 'table-foot' },
    h('span', {}, h('b', {}, String(table.rows.length)), ' rows; the first that fits decides'),
    near ? h('span', { class: 'nr' }, `~ ${near} would have decided with one other value`) : null,
    h('span', {}, '= fits too, but is below'),
    h('span', { class: 'mono end' }, table.source.replace('crates/levels/src/', '')),
  );
}

/** @param {import('./ui.js').Context} context @param {import('./dom.js').Child} panels */
function noTable({ run, ui }, panels) {
  const process = processOf(ui.process);
  const text = process.tabled
    ? run.tables.length
      ? 'It has decided nothing yet: it is not stepped.'
      : 'This log has no decision tables: write the page with rcs-log page.'
    : 'A neighbour: its decisions are not in this log.';
  return [
    h(
      'div',
      { class: 'pane-head' },
      h('h2', { class: 'table-title' }, process.name),
      h('div', { class: 'sp' }),
      panels,
    ),
    h(
      'div',
      { class: 'decision rest' },
      h('span', { class: 'row-number' }, '–'),
      h('div', { class: 'd' }, text),
    ),
  ];
}

/** @param {string} text */
function withoutStop(text) {
  return text.replace(/\.$/, '');
}

/** A sentence without its capital letter, to continue another one. Names do not change. @param {string} text */
function lower(text) {
  const plainText = withoutStop(text);
  return /^[A-Z][a-z]/.test(plainText) ? plainText[0].toLowerCase() + plainText.slice(1) : plainText;
}
