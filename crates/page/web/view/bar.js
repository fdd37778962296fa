// The state bar: state, line of the job, hand, speed, time, and the choices of the view.

import { seconds } from '../log/units.js';
import { h } from './dom.js';
import { icon } from './icons.js';
import { VIEWS } from './ui.js';

const ICON = { run: 'run', fault: 'fault', estop: 'estop', pause: 'pause', done: 'done', lost: 'lost' };
/** A title of the state with more letters is set smaller. */
const LONG = 9;
/** Ticks of a second. */
const TICKS = 25;
/** A line of the job with at most this number of ticks has the smallest width. */
const SHORT = 420;

/**
 * The content of the bar. For a run it is the newest state, even while the page shows the past.
 * @param {import('./ui.js').Context} context
 */
function state({ run, ui, live }) {
  const loss = live?.loss;
  if (!live) return { tick: ui.tick, ...run.mode(ui.tick) };
  const tick = run.last;
  if (loss?.state === 'ended') return { tick, mode: 'done', title: 'RUN ENDED', detail: `last tick ${tick}` };
  if (loss) return { tick, mode: 'lost', title: 'NO CONNECTION', detail: `last tick ${tick}, ${loss.ago}` };
  return { tick, ...run.mode(tick, '') };
}

/** @param {import('./ui.js').Context} context */
export function bar(context) {
  const { run, ui, live } = context;
  const { tick, mode, title, detail } = state(context);
  const held = run.held(tick);
  return [
    h('h1', { class: 'hidden' }, run.log.name),
    h(
      'div',
      { class: `state ${live ? '' : 'past'}`, 'data-k': mode, role: 'status' },
      icon(ICON[/** @type {keyof typeof ICON} */ (mode)]),
      h('div', {}, h('b', { class: title.length > LONG ? 'long' : '' }, title), h('small', {}, detail)),
      live
        ? h(
            'div',
            { class: 'brief' },
            h(
              'b',
              {},
              held.kind === 'object' ? held.name : held.kind === 'nothing' ? 'hand empty' : held.kind,
            ),
            h('small', {}, `${run.knob(tick)} % speed`),
          )
        : null,
    ),
    job(run, tick, mode),
    h('div', { class: 'fact' }, h('small', {}, 'In hand'), hand(held)),
    h(
      'div',
      { class: 'fact sp' },
      h('small', {}, 'Speed'),
      h('b', {}, `${run.knob(tick)} `, h('em', {}, '%')),
    ),
    h(
      'div',
      { class: 'fact tk' },
      h(
        'div',
        { class: 'factrow' },
        ring(ui.tick),
        h(
          'div',
          {},
          h('small', {}, live ? `Tick ${ui.tick}` : `Tick ${ui.tick} of ${run.last}`),
          h('b', {}, seconds(ui.tick)),
        ),
      ),
    ),
    tools(ui, sign(context)),
  ];
}

/** @param {{ kind: string, name: string, grip: number | null }} held */
function hand(held) {
  if (held.kind !== 'object')
    return h('b', {}, held.kind === 'nothing' ? 'nothing' : held.kind.replace(/-/g, ' '));
  return h('b', {}, held.name, held.grip === null ? null : h('em', {}, ` grip ${held.grip}`));
}

/** Whether the page shows a log, the present or the past of a run. @param {import('./ui.js').Context} context */
function sign({ ui, live }) {
  if (!live) return h('span', { class: 'recorded' }, 'LOG');
  const { loss } = live;
  if (loss) return h('span', { class: 'live lost' }, loss.state === 'ended' ? 'ENDED' : 'LOST');
  if (ui.following) return h('span', { class: 'live' }, 'LIVE');
  return h('button', { class: 'live behind', 'data-do': 'live', title: 'back to the present (l)' }, 'LIVE');
}

/** @param {import('../log/run.js').Run} run @param {number} tick @param {string} mode */
function job(run, tick, mode) {
  const at = run.line(tick);
  const line = run.job[at];
  const place = at < 0 ? 'Before the job' : `Line ${at + 1} of ${run.job.length}`;
  const { cause } = run;
  const waits = run.view('/job/state', tick)?.reason;
  const reason = cause && run.why && tick >= cause.tick ? cause.title : waits || undefined;
  return h(
    'div',
    { class: 'job' },
    h(
      'div',
      { class: 'l' },
      h('b', {}, run.job.length ? place : 'No job'),
      reason && h('span', { class: 'reason' }, reason),
      h('span', {}, line?.text ?? ''),
    ),
    h(
      'div',
      { class: 'segments', role: 'img', 'aria-label': place },
      run.job.map((it, index) => segment(it, index, at, tick, mode)),
    ),
  );
}

/**
 * @param {import('../log/job.js').JobLine} line
 * @param {number} index
 * @param {number} at
 * @param {number} tick
 * @param {string} mode
 */
function segment(line, index, at, tick, mode) {
  // A line that has not ended has no known duration.
  const length = line.end === Infinity ? SHORT * 2 : line.end - line.start;
  const width = line.station ? 0.4 : Math.max(1, Math.min(6, length / SHORT));
  const done = index < at ? 'd' : index === at ? `c ${mode}` : '';
  const share =
    index === at && length > 0 && line.end !== Infinity ? Math.min(1, (tick - line.start) / length) : 1;
  return h('i', { class: done, style: `flex:${width.toFixed(2)};--f:${(share * 100).toFixed(1)}%` });
}

/** A mark for each tick of the second. @param {number} tick */
function ring(tick) {
  const now = tick % TICKS;
  const marks = Array.from({ length: TICKS }, (_, index) => {
    const turn = (index / TICKS) * 2 * Math.PI - Math.PI / 2;
    const [x, y] = [Math.cos(turn), Math.sin(turn)];
    const point = (/** @type {number} */ radius) =>
      `${(18 + x * radius).toFixed(1)} ${(18 + y * radius).toFixed(1)}`;
    const colour = index === now ? '--acc' : index < now ? '--t3' : '--line2';
    return h('path', {
      d: `M${point(13.4)}L${point(17)}`,
      stroke: `var(${colour})`,
      'stroke-width': index === now ? 2.6 : 1.5,
    });
  });
  const number = {
    x: 18,
    y: 21.6,
    'text-anchor': 'middle',
    'font-size': 10,
    'font-weight': 600,
    fill: 'var(--t2)',
  };
  return h(
    'svg',
    { class: 'ring', viewBox: '0 0 36 36', role: 'img', 'aria-label': `tick ${now} of this second` },
    marks,
    h('text', number, String(now)),
  );
}

/** @param {import('./ui.js').Ui} ui @param {import('./dom.js').Element} shown */
function tools(ui, shown) {
  const views = VIEWS.map(([view, name, text], index) =>
    h(
      'button',
      {
        'data-do': `view:${view}`,
        'aria-pressed': String(ui.view === view),
        title: `${text} (${index + 1})`,
      },
      icon(name),
      h('span', {}, text),
    ),
  );
  return h(
    'div',
    { class: 'tools' },
    shown,
    h('div', { class: 'choice views', role: 'group', 'aria-label': 'View' }, views),
    h(
      'button',
      {
        class: 'icon-button mono',
        'data-do': 'units',
        title: 'inches and pounds, or millimetres and newtons (u)',
        'aria-label': ui.units === 'in' ? 'in: inches and pounds' : 'mm: millimetres and newtons',
      },
      ui.units,
    ),
    h(
      'button',
      { class: 'icon-button', 'data-do': 'theme', title: 'dark or light (d)', 'aria-label': 'dark or light' },
      icon('theme'),
    ),
    h(
      'button',
      { class: 'icon-button', 'data-do': 'help', title: 'keys (?)', 'aria-label': 'keys' },
      icon('help'),
    ),
  );
}

const TABS = [
  ['cell', 'cell', 'Cell'],
  ['hierarchy', 'hierarchy', 'Processes'],
  ['table', 'table', 'Table'],
  ['time', 'time', 'Why'],
];

/** The tabs of a phone. @param {import('./ui.js').Context} context */
export function tabs({ run, ui }) {
  return TABS.map(([id, name, text]) =>
    h(
      'button',
      {
        'data-do': `tab:${id}`,
        'aria-current': ui.tab === id ? 'page' : null,
      },
      icon(name),
      id === 'time' && !run.cause ? 'Time' : text,
    ),
  );
}
