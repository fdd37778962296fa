// The controls of an operator: stop, PAUSE, go, the velocity knob, the job, and any line of an operator.
//
// A stop acts at once. A button that moves the robot must be held for 0.7 s. A disabled button states the reason.

import { h } from './dom.js';
import { icon } from './icons.js';

/** Steps of the knob, percent. */
export const KNOB_STEP = 5;
/** Marks of the knob, percent. */
const MARKS = [0, 25, 50, 75, 100];
/** Largest number of words that are offered. */
const OFFERED = 8;
const NOTE = [h('b', {}, 'No safety function.'), ' The emergency stops are at the robot.'];

/**
 * The effect of a button: the line that it sends, or the reason why it is disabled.
 * @typedef {{ line: string | null, text: string }} Effect
 * @typedef {{ stop: Effect, pause: Effect, go: Effect, wait: Effect, skip: Effect, leave: Effect, knob: Effect }}
 *   Effects
 */

/**
 * The effects of the buttons in the last tick.
 * @param {import('./ui.js').Context} context
 * @returns {Effects}
 */
export function effects({ run, live }) {
  const can = (/** @type {string} */ line, /** @type {string} */ text) => ({ line, text });
  const cannot = (/** @type {string} */ text) => ({ line: null, text });
  if (!live?.isConnected) {
    const all = cannot('cannot be sent');
    return { ...same(all), stop: cannot('cannot be sent: use the E-stop at the robot') };
  }
  const now = run.last;
  const { mode } = run.mode(now, '');
  const job = run.view('/job/state', now);
  const task = run.log.series('/task/status').latest(now);
  const commander = run.view('/operator/state', now)?.operator ?? '';
  const number = run.line(now) + 1;
  const waits = job ? job.phase === 'waits' : mode === 'pause';
  const isStopped = run.knob(now) === 0;
  const stop = can('stop', isStopped ? 'the knob stays at 0 %' : 'ramps to rest on its path');
  const over = job && /over|failed|ends/.test(job.phase);
  if (over) return { ...same(cannot('the job has ended')), stop };
  const pause =
    mode === 'estop'
      ? cannot('the robot has no pressure')
      : task?.command === 'PAUSE'
        ? cannot('Task has PAUSE')
        : can('PAUSE', 'takes the place of the command');
  const again = number > 0 ? `hold: PAUSE, then line ${number} again` : 'hold: the job begins';
  const go = isStopped
    ? can('go', 'hold: the knob goes back')
    : mode === 'estop'
      ? cannot('an emergency stop is pressed')
      : waits
        ? can('job go', again)
        : cannot('the job plays already');
  return {
    stop,
    pause,
    go,
    wait: waits ? cannot('the job waits') : can('job wait', `Wait after line ${number}`),
    skip: !waits
      ? cannot('only a job that waits can skip a line')
      : mode === 'estop'
        ? cannot('an emergency stop is pressed')
        : can('job skip', `Skip line ${number}`),
    leave: commander === '' ? cannot('nobody commands') : can('leave', 'Leave'),
    knob: mode === 'estop' ? cannot('the robot has no pressure') : can('joystick velocity', ''),
  };
}

/** @param {Effect} effect @returns {Effects} */
function same(effect) {
  return {
    stop: effect,
    pause: effect,
    go: effect,
    wait: effect,
    skip: effect,
    leave: effect,
    knob: effect,
  };
}

/** @param {import('./ui.js').Context} context @param {import('./dom.js').Size} size */
export function controls(context, size) {
  const { live, run, ui } = context;
  if (!live) return [];
  if (!live.mayOperate && live.isConnected) return [watching(live)];
  const does = effects(context);
  const knob = Math.round(run.knob(run.last));
  return [
    h(
      'div',
      { class: 'buttons' },
      button('stop', 'stop', 'STOP', does.stop),
      button('pause', 'pause', 'PAUSE', does.pause),
      button('go', 'run', 'GO', does.go, ui.held === 'go'),
    ),
    velocity(does.knob, live.isConnected ? knob : null),
    commanding(context, does, size),
    size === 'phone' ? null : line(context),
  ];
}

/** @param {import('./session.js').Session} live */
function watching(live) {
  const { service, right } = live.connection;
  const offered = service !== null;
  return h(
    'form',
    { class: 'watching', id: 'token-form' },
    h(
      'div',
      { class: 'words' },
      h('b', {}, 'You watch. '),
      offered
        ? 'To operate, enter the token that the run printed when it started.'
        : person(live) === null
          ? 'This run accepts no requests from here; start it with --operator network.'
          : 'To operate, log in as an operator; the run needs --operator network.',
    ),
    offered
      ? h('input', {
          id: 'token',
          type: 'password',
          autocomplete: 'off',
          placeholder: 'token: 32 letters and digits',
          'aria-label': 'token',
        })
      : null,
    offered
      ? h('button', { class: 'filled', type: 'submit' }, right === 'asked' ? 'Asked' : 'Operate')
      : null,
    h('div', { class: 'note' }, NOTE, account(live)),
  );
}

/** The person who is logged in at the gateway; null without a gateway. @param {import('./session.js').Session} live */
function person(live) {
  return location.protocol === 'https:' ? live.connection.name.replace(/^page\d+\./, '') : null;
}

/** A link to the gateway's login. @param {import('./session.js').Session} live */
function account(live) {
  const name = person(live);
  if (name === null) return null;
  return [' ', h('a', { href: '/login' }, live.isConnected ? `${name}: log out` : 'Log in again')];
}

/**
 * @param {string} id
 * @param {string} picture
 * @param {string} name
 * @param {Effect} effect
 * @param {boolean} [held]
 */
function button(id, picture, name, { line: sent, text }, held = false) {
  return h(
    'button',
    {
      class: `large ${id} ${held ? 'held' : ''}`,
      'data-operate': id,
      'aria-disabled': sent === null ? 'true' : null,
      title: sent === null ? text : null,
    },
    h('i', { class: 'fill' }),
    icon(picture),
    h('span', {}, h('b', {}, name), h('small', {}, text)),
  );
}

/** @param {Effect} effect @param {number | null} percent */
function velocity(effect, percent) {
  const at = percent ?? 100;
  const off = effect.line === null;
  return h(
    'div',
    { class: 'velocity', title: off ? effect.text : 'a tap lowers the speed, a drag of the knob raises it' },
    h(
      'div',
      { class: 'reading' },
      h('span', {}, 'Speed ', h('em', {}, 'of what the job asks')),
      h('b', {}, percent === null ? '–' : `${percent} %`),
    ),
    h(
      'div',
      {
        class: `track ${off ? 'off' : ''}`,
        id: 'knob',
        role: 'slider',
        tabindex: 0,
        'aria-label': 'velocity knob, percent',
        'aria-valuemin': 0,
        'aria-valuemax': 100,
        'aria-valuenow': at,
        'aria-disabled': off ? 'true' : null,
      },
      h('span', { class: 'done', style: `width:${at}%` }),
      MARKS.map((mark) => h('i', { style: `left:${mark}%` })),
      h('span', { class: 'handle', style: `left:${at}%` }),
    ),
  );
}

/** @param {import('./ui.js').Context} context @param {Effects} does @param {import('./dom.js').Size} size */
function commanding({ run, live, ui }, does, size) {
  const commander = run.view('/operator/state', run.last)?.operator ?? '';
  const you = commander === live?.connection.name ? ' (you)' : '';
  const who = commander === '' ? 'You may command' : `${commander}${you} commands`;
  const small = (/** @type {string} */ id, /** @type {Effect} */ effect, /** @type {string} */ name) =>
    h(
      'button',
      {
        class: `small-button ${id} ${ui.held === id ? 'held' : ''}`,
        'data-operate': id,
        'aria-disabled': effect.line === null ? 'true' : null,
        title: effect.line === null ? effect.text : null,
      },
      h('i', { class: 'fill' }),
      h('span', {}, effect.line === null ? name : effect.text),
    );
  return h(
    'div',
    { class: 'commanding' },
    size === 'phone' ? null : h('div', { class: 'who' }, live?.isConnected ? who : 'No connection'),
    h(
      'div',
      { class: 'small-buttons' },
      does.skip.line === null
        ? small('wait', does.wait, 'Wait after the line')
        : small('skip', does.skip, 'Skip'),
      small('leave', does.leave, 'Leave'),
    ),
    size === 'phone' && live?.answer?.refused ? answered(live) : null,
    h('div', { class: 'note' }, NOTE, live && account(live)),
  );
}

/** The line that was sent last, and its answer. @param {import('./session.js').Session} live */
function answered({ answer }) {
  return h(
    'output',
    { class: answer?.refused ? 'refused' : '', role: 'status' },
    answer ? [h('b', {}, answer.line), ` ${answer.refused ? 'refused: ' : ''}${answer.text}`] : '',
  );
}

/** @param {import('./ui.js').Context} context */
function line({ live, ui, run }) {
  const offered = completions(ui.typed, run.words).slice(0, OFFERED);
  return h(
    'form',
    { class: 'line', id: 'line-form' },
    h('label', { for: 'line' }, 'Line'),
    h('input', {
      id: 'line',
      class: 'mono',
      autocomplete: 'off',
      spellcheck: 'false',
      placeholder: 'vise open PFIXTURE, job wait, note TEXT …',
      disabled: !live?.isConnected,
    }),
    ui.typed === ''
      ? live && answered(live)
      : h(
          'div',
          { class: 'offered' },
          offered.map((word) => h('span', { class: 'mono' }, word)),
          offered.length > 0 ? h('em', {}, 'Tab completes') : null,
        ),
  );
}

/**
 * The words that can complete a line: requests at its start, names after it.
 * @param {string} text
 * @param {{ first: string[], names: string[] } | null} words
 */
export function completions(text, words) {
  if (!words || text === '') return [];
  const whole = words.first.filter((word) => word.startsWith(text) && word !== text);
  if (whole.length > 0 || !text.includes(' ')) return whole;
  const [, begun = ''] = / (\S*)$/.exec(text) ?? [];
  return begun === '' ? [] : words.names.filter((name) => name.startsWith(begun) && name !== begun);
}

/** The line with the part that all completions share. @param {string} text @param {string[]} offered */
export function completed(text, offered) {
  if (offered.length === 0) return text;
  const shared = offered.reduce((common, word) => {
    let length = 0;
    while (length < common.length && common[length] === word[length]) length++;
    return common.slice(0, length);
  });
  const front = offered[0].startsWith(text) ? '' : text.slice(0, text.lastIndexOf(' ') + 1);
  return `${front}${shared}${offered.length === 1 ? ' ' : ''}`;
}
