// What buttons and keys do.

import { PROCESSES } from '../log/processes.js';
import { camerasOf, wholeRun, windowOf } from './ui.js';

/** Ticks of a second. */
const SECOND = 25;
/** Smallest number of ticks in the window of the timeline. */
const LEAST = 12;

/** Keys with their actions and their texts in the list of keys. @type {[string[], string, string, string][]} */
export const KEYS = [
  [['1'], 'view:operate', '1 2 3', 'Operate, Explain, Trace'],
  [['2'], 'view:explain', '', ''],
  [['3'], 'view:trace', '', ''],
  [[' '], 'play', 'Space', 'log: play or hold; run: STOP'],
  [['p'], 'hold', 'p  l', 'run: hold the picture; back to the present'],
  [['l'], 'live', '', ''],
  [['['], 'back', '[ ]  { }', 'a tick, a second back and on'],
  [[']'], 'on', '', ''],
  [['{'], 'secondBack', '', ''],
  [['}'], 'secondOn', '', ''],
  [['n'], 'change', 'n  N', 'next, previous change of a row'],
  [['N'], 'changeBefore', '', ''],
  [['t'], 'trouble', 't  T', 'next, previous trouble'],
  [['T'], 'troubleBefore', '', ''],
  [['c'], 'cause', 'c', 'first cause, with its process'],
  [['j'], 'processBelow', 'j  k', 'process below, above'],
  [['k'], 'processAbove', '', ''],
  [['a'], 'allRows', 'a', 'all rows, or those that matter'],
  [['f'], 'panel:table', 'f  m  /', 'table, messages, filter fields'],
  [['m'], 'panel:messages', '', ''],
  [['/'], 'find', '', ''],
  [['+', '='], 'nearer', '+ − 0', 'zoom in time; whole run'],
  [['-'], 'further', '', ''],
  [['0'], 'whole', '', ''],
  [['Home'], 'home', 'Home End', 'first, last tick'],
  [['End'], 'end', '', ''],
  [['g'], 'nextCamera', 'g', 'next place of the camera'],
  [['u'], 'units', 'u  d  b', 'units; dark or light; bigger, for a projector'],
  [['d'], 'theme', '', ''],
  [['b'], 'big', '', ''],
  [['?'], 'help', '?', 'this list'],
];

/** The action of a key; undefined if it has none. @param {string} key */
export function actionOf(key) {
  return KEYS.find(([keys]) => keys.includes(key))?.[1];
}

/**
 * Move to a tick; the window of the timeline follows.
 * @param {import('./ui.js').Context} context
 * @param {number} tick
 */
export function seek({ run, ui }, tick) {
  ui.tick = Math.max(1, Math.min(run.last, Math.round(tick)));
  ui.playing = false;
  ui.following = false;
  follow(ui);
}

/** Show the newest tick; the timeline moves if needed. @param {import('./ui.js').Context} context */
export function followRun({ run, ui }) {
  ui.tick = run.last;
  const [first, last] = ui.window;
  const width = last - first;
  if (ui.tick > last - width * 0.04 || ui.tick < first)
    ui.window = [ui.tick - width * 0.7, ui.tick + width * 0.3];
  if (ui.window[0] < 0) ui.window = [0, width];
}

/** Move the window so that the tick is in it. @param {import('./ui.js').Ui} ui */
export function follow(ui) {
  const [first, last] = ui.window;
  if (ui.tick >= first && ui.tick <= last) return;
  const begin = Math.max(0, ui.tick - (last - first) / 2);
  ui.window = [begin, begin + last - first];
}

/**
 * Show a part or a multiple of the window around a tick.
 * @param {import('./ui.js').Context} context
 * @param {number} factor
 * @param {number} tick
 */
export function zoom({ run, ui }, factor, tick) {
  const [first, last] = ui.window;
  const [, most] = wholeRun(run);
  const width = Math.min(most, Math.max(LEAST, (last - first) * factor));
  const begin = tick - ((tick - first) / (last - first)) * width;
  const start = Math.max(0, Math.min(most - width, begin));
  ui.window = [start, start + width];
}

/** Show the table of a process. @param {import('./ui.js').Ui} ui @param {string} id @param {boolean} phone */
function select(ui, id, phone) {
  ui.process = id;
  ui.consulted = null;
  ui.panel = 'table';
  if (phone) ui.tab = 'table';
}

/** @param {import('./ui.js').Ui} ui @param {number} step */
function neighbour(ui, step) {
  const index = PROCESSES.findIndex((process) => process.id === ui.process) + step;
  select(ui, PROCESSES[Math.max(0, Math.min(PROCESSES.length - 1, index))].id, false);
}

/** Grave events by their ticks. @param {import('../log/run.js').Run} run */
function troubles(run) {
  return run.events.filter((event) => event.weight >= 3).map((event) => event.tick);
}

/**
 * Carry out an action such as `seek:623:emove`.
 * @param {import('./ui.js').Context} context
 * @param {string} action
 * @param {boolean} phone
 * @returns {boolean} false if the page has to do it, since it is about the page and not about the log
 */
export function act(context, action, phone) {
  const { run, ui } = context;
  const [name, first = '', second = ''] = action.split(':');
  const next = (/** @type {number[]} */ ticks) => ticks.find((tick) => tick > ui.tick);
  const before = (/** @type {number[]} */ ticks) => ticks.findLast((tick) => tick < ui.tick);
  const to = (/** @type {number | undefined} */ tick) => tick !== undefined && seek(context, tick);
  switch (name) {
    case 'view':
      ui.view = /** @type {import('./ui.js').View} */ (first);
      break;
    case 'tab':
      ui.tab = first;
      break;
    case 'panel':
      ui.panel = /** @type {import('./ui.js').Panel} */ (first);
      break;
    case 'process':
      select(ui, first, phone);
      break;
    case 'consulted':
      ui.consulted = first || null;
      break;
    case 'processBelow':
      neighbour(ui, 1);
      break;
    case 'processAbove':
      neighbour(ui, -1);
      break;
    case 'seek':
      seek(context, Number(first));
      if (second) select(ui, second, phone);
      break;
    case 'back':
      seek(context, ui.tick - 1);
      break;
    case 'on':
      seek(context, ui.tick + 1);
      break;
    case 'secondBack':
      seek(context, ui.tick - SECOND);
      break;
    case 'secondOn':
      seek(context, ui.tick + SECOND);
      break;
    case 'home':
      seek(context, 1);
      break;
    case 'end':
      seek(context, run.last);
      ui.following = context.live !== null;
      break;
    case 'live':
      if (!context.live) break;
      seek(context, run.last);
      ui.following = true;
      break;
    case 'hold':
      if (context.live) ui.following = false;
      break;
    case 'change':
      to(next(run.changes));
      break;
    case 'changeBefore':
      to(before(run.changes));
      break;
    case 'trouble':
      to(next(troubles(run)) ?? troubles(run)[0]);
      break;
    case 'troubleBefore':
      to(before(troubles(run)));
      break;
    case 'cause':
      if (!run.cause) break;
      ui.window = windowOf(run);
      seek(context, run.cause.tick);
      select(ui, run.cause.process ?? 'prim', false);
      if (ui.view === 'operate') ui.view = 'trace';
      break;
    case 'play':
      if (!ui.playing && ui.tick >= run.last) seek(context, 1);
      ui.playing = !ui.playing;
      break;
    case 'rate':
      ui.rate = Number(first);
      break;
    case 'nearer':
      zoom(context, 0.6, ui.tick);
      break;
    case 'further':
      zoom(context, 1 / 0.6, ui.tick);
      break;
    case 'whole':
      ui.window = wholeRun(run);
      break;
    case 'camera':
      [ui.camera, ui.turned] = [first, false];
      break;
    case 'nextCamera': {
      const shown = camerasOf(run);
      [ui.camera, ui.turned] = [shown[(shown.indexOf(ui.camera) + 1) % shown.length], false];
      break;
    }
    case 'allRows':
      ui.allRows = !ui.allRows;
      break;
    case 'units':
      ui.units = ui.units === 'in' ? 'mm' : 'in';
      break;
    case 'theme':
      ui.theme = ui.theme === 'dark' ? 'light' : 'dark';
      break;
    case 'big':
      ui.big = !ui.big;
      break;
    default:
      return false;
  }
  return true;
}
