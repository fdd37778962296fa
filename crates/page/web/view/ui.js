// The choices of the person at the page, which are not in the log.

/**
 * @typedef {'operate' | 'explain' | 'trace'} View
 * @typedef {'table' | 'fields' | 'messages'} Panel
 * @typedef {import('../log/units.js').Units} Units
 *
 * @typedef {object} Ui
 * @property {View} view
 * @property {string} tab part that a phone shows
 * @property {Panel} panel
 * @property {string} process whose table is shown
 * @property {string | null} consulted another table of the same tick; null for the one that decided
 * @property {number} tick
 * @property {boolean} playing
 * @property {number} rate
 * @property {[number, number]} window first and last tick of the timeline
 * @property {string} camera
 * @property {boolean} turned the camera is no longer where its button puts it
 * @property {boolean} allRows
 * @property {string} filter of the fields
 * @property {string[]} watched fields that are curves
 * @property {string | null} pointed process under the pointer
 * @property {Units} units
 * @property {'dark' | 'light'} theme
 * @property {boolean} big letters for a projector
 * @property {boolean} following the shown tick is the newest one of a run in progress
 * @property {string} typed line of an operator that is not sent
 * @property {string | null} held button that is held down
 */

/**
 * @typedef {{ run: import('../log/run.js').Run, ui: Ui, live: import('./session.js').Session | null }} Context
 *   `live`: null for a log
 */

export const VIEWS = /** @type {[View, string, string][]} */ ([
  ['operate', 'cell', 'Operate'],
  ['explain', 'hierarchy', 'Explain'],
  ['trace', 'time', 'Trace'],
]);

/**
 * The camera presets for which the run has a target.
 * @param {import('../log/run.js').Run} run
 */
export function camerasOf(run) {
  return [
    'cell',
    'gripper',
    'top',
    ...(run.expected ? ['place'] : []),
    ...(run.collision ? ['contact'] : []),
  ];
}

/** Ticks in the timeline of a run in progress. */
const LIVE_WINDOW = 1500;

/**
 * The window of the timeline that shows a failure with the command that led to it.
 * @param {import('../log/run.js').Run} run
 * @returns {[number, number]}
 */
export function windowOf(run) {
  const cause = run.cause?.tick;
  if (cause === undefined) return wholeRun(run);
  const command = run.lanes.find((lane) => lane.id === 'subtask')?.bars.findLast((bar) => bar.start <= cause);
  const begin = Math.max(command?.start ?? 0, cause - 420);
  const end = Math.min(run.last, cause + 40);
  const width = Math.max(200, end - begin);
  return [Math.max(0, begin - width * 0.32), end + width * 0.12];
}

/** The window with all ticks. @param {import('../log/run.js').Run} run @returns {[number, number]} */
export function wholeRun(run) {
  return [0, Math.max(25, run.last * 1.02)];
}

/** @param {import('../log/run.js').Run} run @param {boolean} isLive @returns {Ui} */
export function firstUi(run, isLive) {
  // The page of a run starts at the present tick.
  const cause = isLive ? null : run.cause;
  return {
    view: cause ? 'trace' : 'explain',
    tab: cause ? 'time' : 'cell',
    panel: 'table',
    process: cause?.process ?? (cause?.kind === 'collision' ? 'prim' : 'emove'),
    consulted: null,
    tick: cause?.tick ?? run.last,
    playing: false,
    rate: 1,
    window: isLive
      ? [Math.max(0, run.last - LIVE_WINDOW * 0.7), run.last + LIVE_WINDOW * 0.3]
      : windowOf(run),
    camera:
      cause?.kind === 'collision' && run.collision ? 'contact' : cause && run.expected ? 'place' : 'cell',
    turned: false,
    allRows: false,
    filter: '',
    watched: [],
    pointed: null,
    units: 'in',
    theme: matchMedia('(prefers-color-scheme: light)').matches ? 'light' : 'dark',
    big: false,
    following: isLive,
    typed: '',
    held: null,
  };
}
