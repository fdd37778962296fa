// The timeline: heads of the lanes, tools, and positions.

import { decisionAt } from '../log/rows.js';
import { TABLED } from '../log/processes.js';
import { clock, force, seconds, speed, TICK_S } from '../log/units.js';
import { h } from './dom.js';
import { icon } from './icons.js';
import { speedAt } from './side.js';

/** Heights, pixels. */
export const RULER = 20;
export const OVERVIEW = 26;
/** Times between marks of the ruler, seconds. */
const STEPS = [0.04, 0.2, 0.4, 1, 2, 5, 10, 20, 30, 60, 120, 300];

/**
 * @typedef {{ id: string, name: string, height: number, lane: import('../log/lanes.js').Lane | null }}
 *   Strip
 */

const RATES = [
  [0.04, '1/25'],
  [0.2, '1/5'],
  [1, '1'],
  [5, '5'],
  [25, '25'],
];
const KINDS = [
  ['move', 'moves'],
  ['hand', 'handles'],
  ['look', 'looks'],
  ['change', 'changes gripper'],
  ['pause', 'pauses'],
];

/** Converts between ticks and positions in the timeline. */
export class Scale {
  /** @param {[number, number]} window @param {number} width */
  constructor([first, last], width) {
    this.first = first;
    this.last = last;
    this.width = width;
  }

  /** @param {number} tick */
  x(tick) {
    return ((tick - this.first) / (this.last - this.first)) * this.width;
  }

  /** @param {number} x */
  tick(x) {
    return this.first + (x / this.width) * (this.last - this.first);
  }

  /** The marks of the ruler: place and text. @returns {[number, string][]} */
  marks() {
    const span = (this.last - this.first) * TICK_S;
    const step = STEPS.find((it) => (it / span) * this.width > 72) ?? 300;
    /** @type {[number, string][]} */
    const found = [];
    for (let at = Math.ceil((this.first * TICK_S) / step); at * step <= this.last * TICK_S + 1e-6; at++)
      found.push([Math.round(this.x((at * step) / TICK_S)), clock(at * step, step < 1 ? 2 : 0)]);
    return found;
  }
}

/**
 * The lanes for which the present view has room.
 * @param {import('./ui.js').Context} context
 * @param {import('./dom.js').Size} size
 * @returns {Strip[]}
 */
export function strips({ run, ui }, size) {
  const full = size === 'phone' || ui.view === 'trace';
  const few =
    ui.view === 'operate'
      ? ['workstation']
      : size === 'tablet'
        ? ['subtask', 'emove', 'prim']
        : ['task', 'subtask', 'emove', 'prim'];
  const height = full ? (size === 'phone' ? 25 : 20) : 18;
  const lanes = run.lanes.filter((lane) =>
    full ? size !== 'phone' || lane.id !== 'task' : few.includes(lane.id),
  );
  const curves =
    full && size !== 'phone'
      ? [
          { id: 'speed', name: 'Tool point', height: 30, lane: null },
          { id: 'force', name: 'Finger forces', height: 30, lane: null },
        ]
      : [];
  return [
    ...lanes.map((lane) => ({ id: lane.id, name: lane.name, height, lane })),
    { id: 'events', name: 'Events', height: 20, lane: null },
    ...curves,
  ];
}

/**
 * Height of the overview, pixels; 0 where there is none.
 * @param {import('./ui.js').Context} context
 * @param {import('./dom.js').Size} size
 */
export function overviewHeight({ ui }, size) {
  return ui.view === 'trace' || size === 'phone' ? OVERVIEW : 0;
}

/** @param {import('./ui.js').Context} context @param {import('./dom.js').Size} size */
export function timePane(context, size) {
  const { run, ui } = context;
  const shown = strips(context, size);
  const overview = overviewHeight(context, size);
  let top = overview + RULER;
  const heads = shown.map((strip) => {
    const head = h(
      'button',
      {
        class: `lane-head ${ui.process === strip.id ? 'sel' : ''}`,
        style: `top:${top}px;height:${strip.height}px`,
        'data-do': TABLED.includes(strip.id) ? `process:${strip.id}` : null,
        tabindex: TABLED.includes(strip.id) ? 0 : -1,
      },
      h('span', {}, strip.name),
      h('span', { class: 'r' }, ui.view === 'trace' && size !== 'phone' ? reading(context, strip) : ''),
    );
    top += strip.height + 1;
    return head;
  });
  return [
    tools(context, size),
    h(
      'div',
      { class: 'lanes' },
      h('div', { class: 'lane-heads', style: `height:${top + 3}px` }, heads),
      h('canvas', {
        id: 'timeline',
        style: `height:${top + 3}px`,
        tabindex: 0,
        role: 'slider',
        'aria-label': 'time',
        'aria-valuemin': 0,
        'aria-valuemax': run.last,
        'aria-valuenow': ui.tick,
        'aria-valuetext': `${seconds(ui.tick)}, tick ${ui.tick}`,
      }),
    ),
  ];
}

/** The value of a lane in this tick. @param {import('./ui.js').Context} context @param {Strip} strip */
function reading({ run, ui }, { id }) {
  if (id === 'speed') return speed(ui.units, speedAt(run, ui.tick));
  if (id === 'force') {
    const grip = run.log.series('/grip/status').latest(ui.tick);
    return grip ? `${force(ui.units, grip.left_force)} · ${force(ui.units, grip.right_force)}` : '';
  }
  const decision = TABLED.includes(id) ? decisionAt(run.log.series(`/${id}/row`), ui.tick) : null;
  return decision ? `${decision.table} ${decision.row}${decision.resting ? ' ·' : ''}` : '';
}

/** @param {import('./ui.js').Context} context @param {import('./dom.js').Size} size */
function tools({ run, ui, live }, size) {
  const button = (/** @type {string} */ action, /** @type {string} */ name, /** @type {string} */ title) =>
    h('button', { class: 'icon-button', 'data-do': action, title, 'aria-label': title }, icon(name));
  const key = (/** @type {string} */ action, /** @type {string} */ letter, /** @type {string} */ text) =>
    h('button', { class: 'text-button key', 'data-do': action, 'data-key': letter }, text);
  return h(
    'div',
    { class: 'time-tools' },
    live && ui.following ? key('hold', 'p', 'hold the picture') : null,
    live && !ui.following ? key('live', 'l', 'back to LIVE') : null,
    button('home', 'first', 'first tick (Home)'),
    button('play', ui.playing ? 'pause' : 'run', ui.playing ? 'hold' : 'play'),
    button('end', 'last', 'last tick (End)'),
    h('span', { class: 'clock' }, seconds(ui.tick), h('small', {}, `tick ${ui.tick}`)),
    h(
      'div',
      { class: 'choice', role: 'group', 'aria-label': 'rate' },
      RATES.map(([rate, name]) =>
        h(
          'button',
          {
            'data-do': `rate:${rate}`,
            'aria-pressed': String(ui.rate === rate),
            title: `play at ${name} of the robot's time`,
          },
          `${name}×`,
        ),
      ),
    ),
    h('span', { class: 'sp' }),
    ui.view === 'trace' && size === 'desk'
      ? h(
          'span',
          { class: 'legend' },
          KINDS.map(([kind, name]) => h('span', {}, h('i', { class: `kind-${kind}` }), name)),
        )
      : null,
    h('span', { class: 'sp' }),
    key('back', '[', 'tick'),
    key('on', ']', 'tick'),
    key('change', 'n', 'next change'),
    run.cause ? key('cause', 'c', 'first cause') : null,
    key('whole', '0', 'whole run'),
  );
}
