// The rows of a decision table: heads with the values of this tick, matching and other conditions, and folds.

import { STEP, actionDoc, plain, valueDoc } from '../log/tables.js';
import { h } from './dom.js';

/** @param {import('./table.js').Consultation} shown @param {import('./table.js').Layout} layout */
export function columnHeads({ table, row, values, step }, { list, variables, steps, score, phone }) {
  const used = table.rows[row - 1];
  const column = (/** @type {string} */ name, /** @type {string} */ value, /** @type {boolean} */ isUsed) =>
    h(
      'th',
      { class: isUsed ? 'used' : '', title: name === STEP ? null : valueDoc(table, name, '').question },
      name,
      h('b', {}, value || '–'),
    );
  const stepName = table.steps.find((it) => plain(it.name) === plain(step))?.name ?? step;
  const cells = list
    ? [
        h(
          'th',
          {},
          'values now',
          h(
            'b',
            { class: 'wrap' },
            Object.entries(values)
              .slice(0, 14)
              .map((it) => it.join(' '))
              .join(' · '),
          ),
        ),
      ]
    : [
        ...(steps ? [column(STEP, stepName, (used?.steps.length ?? 0) > 0)] : []),
        ...variables.map((name) => column(name, values[name], name in (used?.when ?? {}))),
      ];
  return h(
    'thead',
    {},
    h(
      'tr',
      {},
      h(
        'th',
        { class: 'score-cell' },
        phone ? h('span', { class: 'hidden' }, 'last 4 s') : `last ${score < 150 ? 4 : 8} s`,
      ),
      h('th', {}, h('span', { class: 'hidden' }, 'row')),
      cells,
      list && phone ? null : h('th', {}, 'action', h('b', {}, '\u00a0')),
    ),
  );
}

/**
 * @param {import('./table.js').Consultation} shown
 * @param {import('./table.js').Layout} layout
 * @param {number} number
 * @param {string[][]} reasons
 * @param {Map<number, { variable: string, value: string }>} near
 */
export function tableRow(
  { table, row: fired, values, step, decision, decides, failed },
  { list, variables, steps, phone },
  number,
  reasons,
  near,
) {
  const row = table.rows[number - 1];
  const isFired = number === fired;
  const miss = near.get(number);
  const resting = decides && decision.resting && !failed;
  const kind = isFired
    ? `fired ${resting ? 'rest' : ''}`
    : miss
      ? 'near'
      : reasons[number - 1].length === 0
        ? 'also'
        : reasons[number - 1].length > 2
          ? 'far'
          : '';
  const value = (/** @type {string} */ name) =>
    miss?.variable === name
      ? h('span', { class: 'nm', title: `with ${name} ${miss.value} this row would decide` }, miss.value)
      : condition(row.when[name], values[name], name);
  const stepCell = () =>
    row.steps.length === 0
      ? h('span', { class: 'm' }, 'any')
      : condition(
          row.steps,
          row.steps.find((it) => plain(it) === plain(step)) ?? (step ? '?' : undefined),
          STEP,
        );
  const action = [row.action, row.next ? h('em', {}, ` → ${row.next}`) : null];
  const asked = [...new Set([...Object.keys(row.when), ...(miss ? [miss.variable] : [])])];
  const cells = list
    ? [
        h(
          'td',
          { class: 'cond' },
          row.steps.length > 0 ? h('span', {}, h('span', { class: 'v' }, STEP), stepCell()) : null,
          asked.map((name) => h('span', {}, h('span', { class: 'v' }, name), value(name))),
          row.steps.length === 0 && asked.length === 0 ? h('span', { class: 'm' }, 'always') : null,
          phone ? h('div', { class: 'act' }, action) : null,
        ),
      ]
    : [...(steps ? [h('td', {}, stepCell())] : []), ...variables.map((name) => h('td', {}, value(name)))];
  return h(
    'tr',
    { class: kind, 'data-row': number, 'aria-current': isFired ? 'true' : null },
    h('td', { class: 'score-cell' }),
    h('td', { class: 'no' }, String(number)),
    cells,
    list && phone ? null : h('td', { class: 'act', title: actionDoc(table, row.action).action }, action),
  );
}

/**
 * The cell of a condition, which fits, does not fit, or is unknown.
 * @param {string[] | undefined} allowed
 * @param {string | undefined} value
 * @param {string} name
 */
function condition(allowed, value, name) {
  if (!allowed) return null;
  const known = value !== undefined;
  const fits = known && allowed.includes(value);
  const more = allowed.length > 1 ? h('span', { class: 'm' }, ` +${allowed.length - 1}`) : null;
  const state = !known ? 'q' : fits ? 'y' : 'n';
  return h(
    'span',
    { title: `${name}: ${allowed.join(' or ')}` },
    h('span', { class: state }, fits ? value : allowed[0]),
    more,
  );
}

/** @param {{ first: number, last: number, by: string }} line @param {import('./table.js').Layout} layout */
export function fold({ first, last, by }, { list, variables, steps }) {
  const columns = list ? 2 : variables.length + (steps ? 1 : 0) + 1;
  return h(
    'tr',
    { class: 'fold', 'data-do': 'allRows', 'data-rows': `${first}-${last}` },
    h('td', { class: 'score-cell' }),
    h('td', { class: 'no' }, `${first}–${last}`),
    h(
      'td',
      { colspan: columns },
      `${last - first + 1} rows that do not fit`,
      by ? [', most of them by ', h('b', {}, by)] : null,
    ),
  );
}

/**
 * A ruler at the right with a mark for each row.
 * @param {import('./table.js').Consultation} shown
 * @param {string[][]} reasons
 * @param {Map<number, unknown>} near
 */
export function ruler({ row }, reasons, near) {
  const kind = (/** @type {number} */ number) =>
    number === row ? 'f' : near.has(number) ? 'n' : reasons[number - 1].length === 0 ? 'a' : '';
  return h(
    'div',
    { class: 'ruler', title: `all ${reasons.length} rows`, 'aria-hidden': 'true' },
    reasons.map((_, index) => h('i', { class: kind(index + 1) })),
  );
}
