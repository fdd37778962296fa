// Notices over the picture of a run when it is not the present one.

import { h } from './dom.js';

/**
 * The notice that the picture is old, because the page shows the past or receives nothing.
 * @param {import('../log/run.js').Run} run
 * @param {import('./ui.js').Ui} ui
 * @param {import('./session.js').Session} live
 */
export function notices(run, ui, live) {
  const { loss } = live;
  if (loss?.state === 'ended') {
    return h(
      'div',
      { class: 'notice lost', role: 'alert' },
      h('h2', {}, 'The run has ended'),
      h('p', {}, 'This page keeps what it has seen, and begins again with the next run at this address.'),
      h('p', { class: 'dim' }, 'rcs-log open LOG shows the whole run, with the chain of causes.'),
    );
  }
  if (loss) {
    return h(
      'div',
      { class: 'notice lost', role: 'alert' },
      h('h2', {}, 'No connection to the controller'),
      h(
        'p',
        {},
        `The picture is of tick ${run.last}, ${loss.ago}. `,
        h('b', {}, 'The robot may still be moving.'),
      ),
      h('p', {}, 'STOP cannot be sent from here. Use the emergency stop at the robot.'),
      loss.attempt ? h('p', { class: 'dim' }, `Trying again: ${loss.attempt}`) : null,
      // With a gateway, the login may have expired.
      location.protocol === 'https:' ? h('p', {}, h('a', { href: '/login' }, 'Log in again')) : null,
    );
  }
  if (ui.following) return null;
  return h(
    'div',
    { class: 'looking-back' },
    `${live.ago(ui.tick)} `,
    h('button', { 'data-do': 'live' }, 'back to LIVE'),
  );
}
