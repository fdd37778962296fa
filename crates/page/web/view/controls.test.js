import assert from 'node:assert/strict';
import { test } from 'node:test';
import { completed, completions, effects } from './controls.js';

const WORDS = {
  first: ['job go', 'job skip', 'job wait', 'note', 'stop'],
  names: ['PFIXTURE', 'UNIT_1', 'UNIT_2'],
};

test('line_is_completed_as_far_as_all_words_agree', () => {
  const full = (text) => completed(text, completions(text, WORDS));
  assert.equal(full('j'), 'job ');
  assert.equal(full('job s'), 'job skip ');
  assert.equal(full('vise open P'), 'vise open PFIXTURE ');
  assert.equal(full('tray U'), 'tray UNIT_');
  assert.equal(full('zzz'), 'zzz');
  assert.equal(full('tray '), 'tray ');
});

/** What the buttons do in a state of the run. */
function buttons({ mode = 'run', knob = 100, phase = 'plays', command = 'MOVE', connected = true }) {
  const run = {
    last: 9,
    mode: () => ({ mode }),
    knob: () => knob,
    line: () => 2,
    view: (topic) => (topic === '/job/state' ? { phase } : { operator: 'viewer-1' }),
    log: { series: () => ({ latest: () => ({ command }) }) },
  };
  const { stop, pause, go, skip } = effects({ run, ui: {}, live: { isConnected: connected } });
  return [stop, pause, go, skip].map(({ line }) => line);
}

test('buttons_send_what_fits_the_state_or_nothing', () => {
  assert.deepEqual(buttons({}), ['stop', 'PAUSE', null, null]);
  assert.deepEqual(buttons({ mode: 'pause', knob: 0 }), ['stop', 'PAUSE', 'go', null]);
  const paused = { mode: 'pause', phase: 'waits', command: 'PAUSE' };
  assert.deepEqual(buttons(paused), ['stop', null, 'job go', 'job skip']);
  assert.deepEqual(buttons({ mode: 'estop', phase: 'waits' }), ['stop', null, null, null]);
  assert.deepEqual(buttons({ phase: 'over' }), ['stop', null, null, null]);
  assert.deepEqual(buttons({ connected: false }), [null, null, null, null]);
});
