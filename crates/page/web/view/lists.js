// Lists that replace the table: the fields of all buffers, and the messages.

import { duration, seconds } from '../log/units.js';
import { h } from './dom.js';
import { icon } from './icons.js';

/** Topics that are not buffers. */
const NO_BUFFERS = /^\/(tf|tf_static|meshes|names|log|camera|contacts|joint_states|operator)$|\/row$/;
/** Greatest number of fields that are shown. */
const LIMIT = 200;

/** @typedef {{ name: string, value: unknown, since: number }} Field */

/** Topics with buffers. @param {import('../log/log.js').Log} log */
export function bufferTopics(log) {
  return log.topics.filter((topic) => !NO_BUFFERS.test(topic));
}

/**
 * The fields of all buffers in a tick, with the tick in which each got its value.
 * @param {import('../log/run.js').Run} run
 * @param {number} tick
 * @param {string} filter
 * @returns {Field[]}
 */
export function fieldsAt(run, tick, filter) {
  const found = bufferTopics(run.log).flatMap((topic) => {
    const series = run.log.series(topic);
    const index = series.index(tick);
    if (index < 0) return [];
    const before = index > 0 ? new Map(leaves(topic, series.get(index - 1))) : new Map();
    return leaves(topic, series.get(index)).map(([name, value]) => ({
      name,
      value,
      since: before.get(name) === value ? 0 : series.tick(index),
    }));
  });
  const text = filter.toLowerCase();
  return found.filter((field) => field.name.toLowerCase().includes(text));
}

/**
 * The values of a message with their paths.
 * @param {string} path
 * @param {any} value
 * @returns {[string, unknown][]}
 */
export function leaves(path, value) {
  if (value instanceof Uint8Array) return [[path, `${value.length} bytes`]];
  if (value === null || typeof value !== 'object') return [[path, value]];
  return Object.entries(value).flatMap(([key, part]) =>
    leaves(`${path}${path.includes('.') || path.startsWith('/') ? '.' : ''}${key}`, part),
  );
}

/** @param {import('./ui.js').Context} context @param {import('./dom.js').Child} panels */
export function fieldsPane({ run, ui }, panels) {
  const fields = fieldsAt(run, ui.tick, ui.filter);
  const shown = fields.sort((a, b) => b.since - a.since).slice(0, LIMIT);
  return [
    h(
      'div',
      { class: 'pane-head' },
      h(
        'label',
        { class: 'find' },
        h('span', { class: 'kb', 'data-key': '/' }),
        h('input', {
          id: 'find',
          value: ui.filter,
          placeholder: 'name of a field or buffer',
          spellcheck: 'false',
          'aria-label': 'filter fields',
        }),
      ),
      h('span', { class: 'dim small' }, `${shown.length} of ${fields.length}`),
      panels,
    ),
    h(
      'div',
      { class: 'list', tabindex: 0 },
      shown.map((field) => {
        const ago = ui.tick - field.since;
        return h(
          'div',
          { class: `field ${field.since && ago < 2 ? 'chg' : ''}` },
          h('span', { class: 'k', title: field.name }, field.name),
          h(
            'span',
            { class: 'v' },
            field.value === null ? 'none' : field.value === '' ? '""' : String(field.value),
          ),
          h(
            'span',
            { class: 'a' },
            !field.since ? '' : ago < 2 ? ['now', '1 tick ago'][ago] : `${duration(ago)} ago`,
          ),
        );
      }),
      shown.length === 0 ? h('div', { class: 'pane-head dim' }, 'No field has this text in its name.') : null,
    ),
    h('div', { class: 'table-foot' }, h('span', {}, 'fields that changed last are first')),
  ];
}

/** @param {import('./ui.js').Context} context @param {import('./dom.js').Child} panels */
export function messagesPane({ run, ui }, panels) {
  const shown = run.lines.filter((line) => line.level !== 'debug');
  return [
    h(
      'div',
      { class: 'pane-head' },
      h('h2', { class: 'table-title' }, 'Messages'),
      h('div', { class: 'sp' }),
      panels,
    ),
    h(
      'div',
      { class: 'list', tabindex: 0 },
      shown.map((line) =>
        h(
          'button',
          {
            class: `log-line ${line.tick > ui.tick ? 'fut' : ''} ${line.level}`,
            'data-do': `seek:${line.tick}`,
          },
          h('span', { class: 't' }, seconds(line.tick)),
          line.level === 'error' ? icon('fault') : line.level === 'warning' ? icon('flag') : h('span', {}),
          h('span', { class: 'p' }, line.source),
          h('span', {}, line.text),
        ),
      ),
    ),
  ];
}
