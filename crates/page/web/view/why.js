// The chain of a failure: commands go down to the cause, the deepest card, and reports go up. Without a failure, what
// was done.

import { chainOf, remedyOf } from '../log/explanation.js';
import { idOf, processOf } from '../log/processes.js';
import { amount, clock, duration, seconds, TICK_S } from '../log/units.js';
import { h, sentence } from './dom.js';
import { icon } from './icons.js';

/** Indentation of an event in the cell, in levels. */
const CELL_LEVEL = 0;

/** @param {import('./ui.js').Context} context */
export function why(context) {
  return context.run.cause ? failure(context) : finished(context);
}

/** @param {import('./ui.js').Context} context */
function failure({ run, ui }) {
  const cause = /** @type {import('../log/account.js').Failure} */ (run.cause);
  const process = cause.process ? processOf(cause.process).name : '';
  const reporter = run.failures.find((it) => it.explained)?.process;
  const evidence = (reporter && run.why?.failure?.evidence) || [];
  const data = run.why?.world?.data ?? [];
  return [
    h(
      'div',
      { class: 'why-head' },
      h(
        'div',
        { class: 'kick' },
        `${cause.name.toUpperCase()} · TICK ${cause.tick} · ${seconds(cause.tick)}`,
      ),
      h('h2', {}, process ? `${process}: ${cause.title}` : sentence(cause.title)),
      cause.detail ? h('p', {}, cause.detail) : null,
      remedy(run),
      h(
        'div',
        { class: 'why-tools' },
        h(
          'button',
          {
            class: `text-button key ${ui.tick === cause.tick ? 'on' : ''}`,
            'data-do': 'cause',
            'data-key': 'c',
          },
          'first cause',
        ),
        h('button', { class: 'text-button key', 'data-do': 'trouble', 'data-key': 't' }, 'next trouble'),
      ),
    ),
    h(
      'div',
      { class: 'scroll', tabindex: 0 },
      part('Commands down, reports up', null),
      chainOf(run).map((link) => line(link, ui, run.why ? 'FIRST CAUSE' : 'FIRST REPORT')),
      evidence.length
        ? part(
            `What ${processOf(reporter ?? '').name} sensed while it tried`,
            evidence.map((/** @type {string} */ text) => plain(text)),
          )
        : null,
      data.length
        ? part(
            'Data of the last command',
            data.map((/** @type {string} */ text) => plain(text)),
          )
        : null,
      run.why
        ? part('Try a remedy in the log', [
            h(
              'div',
              { class: 'plain mono' },
              `rcs-log fork ${run.log.name} --tick ${Math.max(1, cause.tick - 100)} --set '…'`,
            ),
          ])
        : null,
    ),
  ];
}

/** @param {import('../log/run.js').Run} run */
function remedy(run) {
  const next = remedyOf(run);
  return next ? h('p', { class: 'remedy' }, h('b', {}, 'Next: '), next) : null;
}

/**
 * @param {import('../log/explanation.js').Link} link
 * @param {import('./ui.js').Ui} ui
 * @param {string} badge of the first failure
 */
function line(link, ui, badge) {
  const kind = { command: '', cause: 'first-cause', report: 'up', cell: 'world', then: 'then' }[link.kind];
  const selected =
    ui.tick === link.tick && (link.process === null || link.process === ui.process) ? 'sel' : '';
  const target = link.process === 'workstation' ? 'task' : link.process;
  const row = link.row ? link.row.split(' ') : null;
  return h(
    'button',
    {
      class: `link ${kind} ${selected}`,
      style: `--lv:${levelOf(link)}`,
      'data-do': `seek:${link.tick}${target ? `:${target}` : ''}`,
    },
    h('span', { class: 't' }, String(link.tick)),
    h(
      'span',
      { class: 'x' },
      h(
        'span',
        { class: 'pr' },
        link.kind === 'cell' ? icon('flag') : null,
        h('b', {}, link.from),
        link.to ? [h('span', { class: 'ar' }, 'orders'), h('b', {}, link.to)] : null,
        link.kind === 'cause' ? h('span', { class: 'badge' }, badge) : null,
        link.kind === 'then' ? h('span', { class: 'badge' }, 'THEN') : null,
      ),
      h('span', { class: 'cm' }, link.text.replace(/^reports /, '')),
      row
        ? h('span', { class: 'rw' }, h('b', {}, `${row[0]} ${row[1]}`), ` ${row.slice(2).join(' ')}`)
        : null,
      link.news ? h('span', { class: 'rw' }, 'new in this tick: ', h('b', {}, link.news)) : null,
    ),
  );
}

/**
 * Depth of a link: the level of the process that got the command or that reports.
 * @param {import('../log/explanation.js').Link} link
 */
function levelOf(link) {
  const id = link.to ? idOf(link.to) : link.process;
  if (id === null) return CELL_LEVEL;
  return processOf(id).level + 1;
}

/** @param {import('./ui.js').Context} context */
function finished({ run, ui, live }) {
  const facts = run.info.facts ?? {};
  const link = run.info.link;
  const clearance = facts.clearance ?? '';
  const [, closest] = /tick (\d+)/.exec(clearance) ?? [];
  const ended = run.result === 'finished' || run.result === '';
  const count = (/** @type {string} */ level) => run.lines.filter((line) => line.level === level).length;
  return [
    h(
      'div',
      { class: 'why-head okk' },
      h(
        'div',
        { class: 'kick' },
        live
          ? run.mode(run.last, '').title
          : !run.log.file.complete
            ? 'NO END'
            : run.result === 'finished'
              ? 'FINISHED'
              : 'ENDED',
      ),
      h(
        'h2',
        {},
        live
          ? `Line ${run.line(run.last) + 1} of ${run.job.length} after ${duration(run.last)}`
          : ended
            ? `${amount(run.job.length, 'line')} in ${duration(run.last)}, no failure`
            : sentence(run.result),
      ),
      h(
        'p',
        {},
        [
          amount(run.commands.length, 'command'),
          amount(run.last, 'tick'),
          amount(run.info.warnings ?? count('warning'), 'warning'),
          amount(run.info.errors ?? count('error'), 'error'),
        ].join(' · '),
      ),
    ),
    h(
      'div',
      { class: 'scroll', tabindex: 0 },
      facts.parts ? part('Where the parts are', facts.parts.split('; ').map(plain)) : null,
      clearance
        ? part('Closest clearance', [
            h('button', { class: 'plain seek', 'data-do': `seek:${closest}` }, clearance),
          ])
        : null,
      link
        ? part('Link', [
            plain(
              [
                amount(link.frames, 'frame'),
                amount(link.naks, 'NAK'),
                amount(link.checksum_errors, 'checksum error'),
                amount(link.restarts, 'restart'),
              ].join(', '),
            ),
          ])
        : null,
      part(
        'Commands',
        run.commands.map((command) =>
          h(
            'button',
            {
              class: `command ${ui.tick >= command.first_tick && ui.tick <= command.last_tick ? 'sel' : ''}`,
              'data-do': `seek:${command.first_tick}`,
            },
            h('span', { class: 't' }, clock(command.first_tick * TICK_S, 0)),
            h('span', { class: 'cm' }, command.text),
            h(
              'span',
              { class: 'dim' },
              command.last_tick === Infinity ? 'executing' : duration(command.last_tick - command.first_tick),
            ),
          ),
        ),
      ),
    ),
  ];
}

/** @param {string} title @param {import('./dom.js').Child[] | null} content */
function part(title, content) {
  return h('div', { class: 'why-part' }, h('h2', {}, title), content);
}

/** @param {string} text */
function plain(text) {
  return h('div', { class: 'plain' }, text);
}
