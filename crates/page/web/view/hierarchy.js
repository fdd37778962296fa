// The hierarchy: a card for each process with command, status and row.

import { processOf } from '../log/processes.js';
import { stateOf } from '../log/state.js';
import { TICK_S } from '../log/units.js';
import { context2d, h } from './dom.js';
import { icon } from './icons.js';

const ICON = { executing: 'executing', done: 'done', idle: 'idle', off: 'off', failed: 'fault' };
/** Classes of the cards by condition. */
const KIND = { executing: 'exec', done: 'ok', idle: 'idle', off: 'off', failed: 'bad' };
/** Ticks in the strip of a card. */
const STRIP = 200;

/**
 * Rows of the grid: a process, the kind of the line to its right, and the processes to the right of the line.
 * @type {[string, string, string[]][]}
 */
const ROWS = [
  ['task', 'one', ['data']],
  ['subtask', 'one', ['pedestal', 'hand', 'table']],
  ['emove', 'top', ['vision']],
  ['prim', 'mid', ['quick_change']],
  ['t3i', 'mid', ['grip']],
  ['robot', 'end', ['v_grip', 'tool_grip']],
];

/** @type {Record<string, string>} */
const LINES = {
  one: 'M0 25H20',
  top: 'M0 25H20M10 25V56',
  mid: 'M10 -6V56M10 25H20',
  end: 'M10 -6V25H20',
};

/** @param {import('./ui.js').Context} context */
export function hierarchy(context) {
  const rows = ROWS.flatMap(([id, line, right]) => [
    card(context, id),
    h(
      'div',
      { class: 'bus', 'aria-hidden': 'true' },
      h(
        'svg',
        { viewBox: '0 0 20 50', preserveAspectRatio: 'none' },
        h('path', {
          d: LINES[line],
          stroke: 'var(--line2)',
          fill: 'none',
          'vector-effect': 'non-scaling-stroke',
        }),
      ),
    ),
    right.length === 1
      ? card(context, right[0], 'kid')
      : h(
          'div',
          { class: `${right.length === 3 ? 'three' : 'two'} kid` },
          right.map((other) => card(context, other)),
        ),
  ]);
  return h(
    'div',
    { class: 'hierarchy-grid' },
    card(context, 'workstation'),
    h('div', { class: 'bus' }),
    h(
      'div',
      { class: 'hint' },
      h('span', {}, 'commands go ', h('i', {}, 'down ↓'), ' one level a tick'),
      h('span', {}, 'statuses ', h('i', {}, 'up ↑')),
    ),
    rows,
  );
}

/** @param {import('./ui.js').Context} context @param {string} id @param {string} [kind] */
function card({ run, ui }, id, kind = '') {
  const process = processOf(id);
  const state = stateOf(run, id, ui.tick);
  const [verb, rest] = firstWord(state.command);
  const { cause } = run;
  const isCause = cause?.process === id && ui.tick >= cause.tick && state.condition === 'failed';
  const classes = [
    'card',
    KIND[state.condition],
    kind,
    ui.process === id && 'sel',
    isCause && 'cause',
    state.fresh && 'fresh',
  ];
  return h(
    'button',
    {
      class: classes.filter(Boolean).join(' '),
      'data-do': `process:${id}`,
      'data-process': id,
      'aria-pressed': String(ui.process === id),
      title: `${process.name}: ${state.command || state.status}${state.reason ? `, ${state.reason}` : ''}`,
    },
    icon(ICON[state.condition], 'g'),
    h('span', { class: 'n' }, process.short ?? process.name),
    h('span', { class: 'w' }, state.condition === 'off' ? null : row(state.decision, ui.tick)),
    h('span', { class: 'c' }, state.command ? [h('b', {}, verb), rest] : state.status),
    h(
      'span',
      { class: 's' },
      state.command ? state.status : null,
      state.command && state.number ? h('span', { class: 'mono' }, ` ${state.number}`) : null,
    ),
    h('canvas', { 'data-strip': id, 'aria-hidden': 'true' }),
  );
}

/** @param {string} command @returns {[string, string]} */
function firstWord(command) {
  const space = command.indexOf(' ');
  return space < 0 ? [command, ''] : [command.slice(0, space), command.slice(space)];
}

/** @param {import('../log/rows.js').Decision | null} decision @param {number} tick */
function row(decision, tick) {
  if (!decision) return null;
  if (!decision.resting) return [`${decision.table} `, h('b', {}, String(decision.row))];
  return `${decision.table} ${decision.row} · ${((tick - decision.fired) * TICK_S).toFixed(0)} s`;
}

/**
 * Paint the last eight seconds of a process: a stroke where another row fired, a thin line while it rested.
 * @param {import('./ui.js').Context} context
 * @param {HTMLCanvasElement} canvas
 * @param {string} id
 * @param {Record<string, string>} colour
 */
export function paintStrip({ run, ui }, canvas, id, colour) {
  const width = canvas.clientWidth;
  const context = context2d(canvas, width, 3);
  if (!context || width === 0) return;
  const rows = run.log.series(`/${id}/row`);
  const x = (/** @type {number} */ tick) => ((tick - ui.tick + STRIP) / STRIP) * width;
  for (
    let index = Math.max(0, rows.index(ui.tick - STRIP));
    index < rows.length && rows.tick(index) <= ui.tick;
    index++
  ) {
    const { row: fired, resting } = rows.get(index);
    if (fired === 0) continue;
    const start = Math.max(rows.tick(index), ui.tick - STRIP);
    const end = index + 1 < rows.length ? Math.min(rows.tick(index + 1), ui.tick + 1) : ui.tick + 1;
    context.fillStyle = resting ? colour.line : colour['acc-ln'];
    context.fillRect(x(start), resting ? 2 : 0, x(end) - x(start), resting ? 1 : 3);
    if (resting || rows.tick(index) <= ui.tick - STRIP) continue;
    context.fillStyle = colour.acc;
    context.fillRect(x(start), 0, 1.6, 3);
  }
}
