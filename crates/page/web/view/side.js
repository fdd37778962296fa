// Information for the operator next to the cell: job, hand, robot, messages.

import { processOf } from '../log/processes.js';
import { remedyOf } from '../log/explanation.js';
import { bareLength, duration, force, length, seconds, speed } from '../log/units.js';
import { h, sentence, windowSize } from './dom.js';
import { icon } from './icons.js';

/**
 * Joints with their limits, degrees: those of `geometry::kinematics::T3`.
 * @type {[string, number, number][]}
 */
const JOINTS = [
  ['base', -210, 30],
  ['shoulder', 0, 90],
  ['elbow', -165, -10],
  ['pitch', -90, 90],
  ['yaw', -90, 90],
  ['roll', -135, 135],
];
/** A joint nearer to a limit than this is marked, degrees. */
const NEAR = 10;
/** Lines of the job before the present one, lines in all, and messages. */
const SHOWN = { before: 1, lines: 12, linesOnPhone: 6, messages: 5 };

/** @param {import('./ui.js').Context} context */
export function side({ run, ui }) {
  return [
    failureCard(run, ui),
    jobBlock(run, ui),
    handBlock(run, ui),
    robotBlock(run, ui),
    messages(run, ui),
  ];
}

/** @param {import('../log/run.js').Run} run @param {import('./ui.js').Ui} ui */
function failureCard(run, ui) {
  const { cause } = run;
  if (!cause) return waitCard(run, ui);
  if (ui.tick < cause.tick) return null;
  const next = remedyOf(run);
  const process = cause.process ? processOf(cause.process).name : 'in the cell';
  const kick = [cause.name.toUpperCase(), process, `tick ${cause.tick}`, seconds(cause.tick)];
  return h(
    'div',
    { class: 'failure-card' },
    h('div', { class: 'kick' }, kick.join(' · ')),
    h('h2', {}, sentence(cause.title)),
    cause.detail ? h('div', { class: 'who' }, cause.detail) : null,
    next ? h('div', { class: 'who' }, h('b', {}, 'Next: '), next) : null,
    h('button', { class: 'text-button key', 'data-do': 'cause', 'data-key': 'c' }, 'why'),
  );
}

/** Why the job waits or has failed, and the remedy. @param {import('../log/run.js').Run} run @param {import('./ui.js').Ui} ui */
function waitCard(run, ui) {
  const job = run.view('/job/state', ui.tick);
  if (!job?.reason) return null;
  const { mode, title } = run.mode(ui.tick, '');
  return h(
    'div',
    { class: mode === 'pause' ? 'failure-card waits' : 'failure-card' },
    h('div', { class: 'kick' }, `${title} · the job ${job.phase === 'failed' ? 'has failed' : 'waits'}`),
    h('h2', {}, sentence(job.reason)),
    job.remedy ? h('div', { class: 'who' }, h('b', {}, 'Next: '), job.remedy) : null,
  );
}

/** @param {import('../log/run.js').Run} run @param {import('./ui.js').Ui} ui */
function jobBlock(run, ui) {
  const at = run.line(ui.tick);
  const { mode } = run.mode(ui.tick);
  const room = windowSize() === 'phone' ? SHOWN.linesOnPhone : SHOWN.lines;
  const first = Math.max(0, Math.min(at - SHOWN.before, run.job.length - room));
  const shown = run.job.slice(first, first + room);
  const rest = run.job.length - first - shown.length;
  const lines = shown.map((line, index) => {
    const number = first + index;
    const place = number < at ? 'past' : number === at ? `cur ${mode}` : 'fut';
    const [verb, ...words] = line.text.split(' ');
    // The duration of a line that ended before the page was opened is unknown.
    const unknown = line.station || number > at || line.end === line.start;
    const time = unknown ? '' : duration(Math.min(ui.tick, line.end) - line.start);
    return h(
      'div',
      {
        class: `job-line ${line.station ? 'ws' : ''} ${place}`,
        'aria-current': number === at ? 'step' : null,
      },
      h('span', { class: 'no' }, String(number + 1)),
      h('span', { class: 'tx' }, line.station ? line.text : [h('b', {}, verb), ` ${words.join(' ')}`]),
      h('span', { class: 'du' }, number < at && time === '' ? icon('done') : time),
    );
  });
  return block(
    'Job',
    `${run.log.run.get('job') ?? ''} · ${run.job.length} lines`,
    first > 0
      ? h(
          'div',
          { class: 'job-line past' },
          h('span', { class: 'no' }, '…'),
          h('span', { class: 'tx' }, `${first} before`),
        )
      : null,
    lines,
    rest > 0
      ? h(
          'div',
          { class: 'job-line fut' },
          h('span', { class: 'no' }, '…'),
          h('span', { class: 'tx' }, `${rest} more`),
        )
      : null,
  );
}

/** @param {import('../log/run.js').Run} run @param {import('./ui.js').Ui} ui */
function handBlock(run, ui) {
  const held = run.held(ui.tick);
  const grip = run.log.series('/grip/status').latest(ui.tick);
  const name =
    held.kind === 'object'
      ? held.name
      : held.kind === 'nothing'
        ? 'holds nothing'
        : held.kind.replace(/-/g, ' ');
  return block(
    'Hand',
    'parts gripper',
    h(
      'div',
      { class: 'hand' },
      grip ? fingers(grip, held.kind === 'object') : h('span', {}),
      h(
        'div',
        {},
        h('b', { class: 'held' }, name),
        grip
          ? facts([
              ['opening', length(ui.units, grip.position / 100)],
              ['forces', `${force(ui.units, grip.left_force)} · ${force(ui.units, grip.right_force)}`],
            ])
          : h('span', { class: 'dim' }, 'no reading'),
      ),
    ),
  );
}

/** A drawing of the fingers at their opening. @param {any} grip @param {boolean} holds */
export function fingers(grip, holds) {
  const open = 7 + (Math.max(0, Math.min(5, grip.position / 100)) / 5) * 40;
  const line = (/** @type {string} */ d, /** @type {string} */ colour, width = 1) =>
    h('path', { d, stroke: `var(${colour})`, 'stroke-width': width, fill: 'none' });
  const fill = (/** @type {string} */ d, /** @type {string} */ colour) =>
    h('path', { d, fill: `var(${colour})` });
  const [left, right] = [59 - open, 59 + open];
  return h(
    'svg',
    {
      viewBox: '0 0 118 84',
      role: 'img',
      'aria-label': `fingers ${(grip.position / 100).toFixed(2)} in apart`,
    },
    fill('M20 8h78v12H20z', '--line2'),
    fill('M52 1h14v8H52z', '--line2'),
    holds ? fill(`M${left + 5} 40H${right - 5}V64H${left + 5}Z`, '--run') : null,
    fill(`M${left - 7} 20h10v46h-6v-14l-4-8z`, '--t2'),
    fill(`M${right - 3} 20h10v24l-4 8v14h-6z`, '--t2'),
    grip.left_force ? line(`M${left - 10} 58h-${4 + Math.min(26, grip.left_force / 2)}`, '--t1', 3) : null,
    grip.right_force ? line(`M${right + 10} 58h${4 + Math.min(26, grip.right_force / 2)}`, '--t1', 3) : null,
    line(`M${left + 3} 76H${right - 3}M${left + 3} 73v6M${right - 3} 73v6`, '--t3'),
  );
}

/**
 * Angles of the joints, degrees; null if the log has none.
 * @param {import('../log/run.js').Run} run
 * @param {number} tick
 * @returns {number[] | null}
 */
export function jointAngles(run, tick) {
  const joints = run.log.series('/joint_states').latest(tick);
  return joints
    ? joints.position.slice(0, JOINTS.length).map((/** @type {number} */ value) => (value * 180) / Math.PI)
    : null;
}

/**
 * The joint that is nearest to a limit: its name, and the distance in degrees.
 * @param {number[]} angles
 * @returns {[string, number]}
 */
export function nearestLimit(angles) {
  const all = JOINTS.map(
    ([name, low, high], index) =>
      /** @type {[string, number]} */ ([name, Math.min(angles[index] - low, high - angles[index])]),
  );
  return all.reduce((best, it) => (it[1] < best[1] ? it : best));
}

/** @param {import('../log/run.js').Run} run @param {import('./ui.js').Ui} ui */
function robotBlock(run, ui) {
  const point = run.toolPoint(ui.tick);
  const angles = jointAngles(run, ui.tick);
  const near = angles ? nearestLimit(angles) : null;
  return block(
    'Robot',
    near ? `nearest to a limit: ${near[0]}, ${near[1].toFixed(1)}°` : '',
    point
      ? facts([
          [`tool point, ${ui.units}`, point.map((value) => bareLength(ui.units, value)).join('  ')],
          ['speed', speed(ui.units, speedAt(run, ui.tick))],
        ])
      : null,
    angles?.map((angle, index) => {
      const [name, low, high] = JOINTS[index];
      const place = ((angle - low) / (high - low)) * 100;
      return h(
        'div',
        { class: 'joint' },
        h('span', { class: 'mid' }, name),
        h(
          'span',
          { class: 'tr', style: `--lim:${((NEAR / (high - low)) * 100).toFixed(1)}%` },
          h('i', { style: `left:${place.toFixed(1)}%` }),
        ),
        h('span', {}, `${angle.toFixed(1)}°`),
      );
    }) ?? [],
  );
}

/** Speed of the tool point, in/s; 0 at rest. @param {import('../log/run.js').Run} run @param {number} tick */
export function speedAt(run, tick) {
  const speeds = run.speeds;
  let [low, high] = [0, speeds.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (speeds[middle].tick <= tick) low = middle + 1;
    else high = middle;
  }
  const last = speeds[low - 1];
  // An unchanged status is not written, so an old status means that the robot is at rest.
  return last && tick - last.tick <= 1 ? last.value : 0;
}

/** @param {import('../log/run.js').Run} run @param {import('./ui.js').Ui} ui */
function messages(run, ui) {
  const shown = run.lines
    .filter((line) => line.tick <= ui.tick && line.level !== 'debug')
    .slice(-SHOWN.messages)
    .reverse();
  return block(
    'Messages',
    '',
    shown.map((line) =>
      h(
        'div',
        { class: `message ${line.level}` },
        h('span', { class: 'no mono' }, seconds(line.tick)),
        h('span', { class: 'tx' }, `${line.source}: ${line.text}`),
      ),
    ),
  );
}

/** @param {string} title @param {string} note @param {import('./dom.js').Children[]} content */
function block(title, note, ...content) {
  return h('div', { class: 'block' }, h('h2', {}, title, ' ', h('span', {}, note)), content.flat());
}

/** @param {[string, string][]} pairs */
function facts(pairs) {
  return h(
    'dl',
    { class: 'facts' },
    pairs.flatMap(([name, value]) => [h('dt', {}, name), h('dd', {}, value)]),
  );
}
