// The instruments below the cell: hand, tool point, vision.

import { stateOf } from '../log/state.js';
import { amount, bareLength, duration, force, length, speed } from '../log/units.js';
import { h } from './dom.js';
import { fingers, jointAngles, nearestLimit, speedAt } from './side.js';

/** @param {import('./ui.js').Context} context */
export function instruments({ run, ui }) {
  const grip = run.log.series('/grip/status').latest(ui.tick);
  const held = run.held(ui.tick);
  const point = run.toolPoint(ui.tick);
  const angles = jointAngles(run, ui.tick);
  const near = angles ? nearestLimit(angles) : null;
  const limit = near ? ` · ${near[0]} ${near[1].toFixed(1)}° from its limit` : '';
  return [
    h(
      'div',
      { class: 'instrument' },
      grip ? fingers(grip, held.kind === 'object') : null,
      h(
        'div',
        {},
        h('small', {}, 'Hand'),
        h('b', {}, held.kind === 'object' ? held.name : held.kind.replace(/-/g, ' ')),
        grip ? h('span', {}, `${length(ui.units, grip.position / 100)} apart`) : null,
        grip
          ? h('span', {}, `${force(ui.units, grip.left_force)} · ${force(ui.units, grip.right_force)}`)
          : null,
      ),
    ),
    instrument(
      `Tool point, ${ui.units}`,
      h('b', { class: 'mono' }, point ? point.map((value) => bareLength(ui.units, value)).join('  ') : '–'),
      h('span', {}, `${speed(ui.units, speedAt(run, ui.tick))}${limit}`),
    ),
    ui.view === 'explain' ? vision(run, ui) : null,
  ];
}

/** @param {import('../log/run.js').Run} run @param {import('./ui.js').Ui} ui */
function vision(run, ui) {
  const state = stateOf(run, 'vision', ui.tick);
  const answers = run.vision.filter((it) => it.tick <= ui.tick && !/^(idle|busy)$/.test(it.status));
  const last = answers.at(-1);
  return instrument(
    'Vision',
    h('b', {}, state.status.replace(/-/g, ' ')),
    last ? h('span', {}, `${amount(answers.length, 'answer')}, the last at tick ${last.tick},`) : null,
    last ? h('span', {}, `${duration(ui.tick - last.tick)} ago`) : null,
  );
}

/** @param {string} name @param {import('./dom.js').Child[]} content */
function instrument(name, ...content) {
  return h('div', { class: 'instrument' }, h('div', {}, h('small', {}, name), content));
}
