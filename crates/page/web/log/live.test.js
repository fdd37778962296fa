import assert from 'node:assert/strict';
import { test } from 'node:test';
import { JobProgress } from './job.js';
import { Lanes } from './lanes.js';
import { LiveLog } from './live.js';
import { Mcap } from './mcap.js';
import { Reader, Series } from './series.js';

/** A log of a run whose messages are numbers. */
function liveLog() {
  const log = new LiveLog('run', new Mcap());
  log.loaded.set('/a', new Series([], ([value]) => value));
  return log;
}

const arrival = (tick, value, size = 1) => {
  const data = new Uint8Array(size);
  data[0] = value;
  return { topic: '/a', tick, data };
};

test('messages_are_shown_when_their_tick_is_complete', () => {
  const log = liveLog();
  log.take(arrival(5, 1));
  log.take(arrival(6, 2));
  assert.equal(log.series('/a').latest(9), null);
  log.complete(5);
  assert.deepEqual([log.series('/a').latest(9), log.last, log.first], [1, 5, 5]);
  log.complete(6);
  assert.equal(log.series('/a').latest(9), 2);
});

test('reader_returns_each_message_once_also_after_a_trim', () => {
  const log = liveLog();
  const reader = new Reader(log, '/a');
  log.take(arrival(1, 1));
  log.complete(1);
  assert.deepEqual([...reader.fresh()], [[1, 1]]);
  log.take(arrival(2, 2));
  log.take(arrival(3, 3));
  log.complete(3);
  log.series('/a').trim(3);
  assert.deepEqual(
    [...reader.fresh()],
    [
      [2, 2],
      [3, 3],
    ],
  );
  assert.deepEqual([...reader.fresh()], []);
});

test('oldest_messages_go_but_the_valid_value_stays', () => {
  const log = liveLog();
  for (let tick = 1; tick <= 100; tick++) {
    log.take(arrival(tick, tick, 1 << 20));
    log.complete(tick);
  }
  assert.equal(log.trim(), true);
  assert.equal(log.trim(), false);
  const series = log.series('/a');
  assert.deepEqual([log.first, series.tick(0), series.latest(log.first)], [26, 25, 26]);
  assert.equal(log.bytes, series.length << 20);
});

test('lanes_grow_as_commands_and_answers_arrive', () => {
  const log = liveLog();
  log.loaded.set('/prim/status', new Series([], ([done]) => ({ report: done ? 'done' : 'executing' })));
  const lanes = new Lanes(log);
  const update = (orders, statuses, last) => {
    statuses.forEach(([tick, done]) => log.series('/prim/status').push({ tick, data: [done] }));
    const commands = orders.map(([tick, text]) => ({ tick, text, number: '' }));
    lanes.update(new Map([['prim', commands]]), last);
    return lanes.of('prim').map(({ start, done, end, text }) => [start, done, end, text]);
  };
  assert.deepEqual(update([[3, 'GOTO-PT']], [[3, 1]], 6), [[3, 6, 6, 'GOTO-PT']]);
  assert.deepEqual(update([], [[8, 1]], 9), [[3, 8, 9, 'GOTO-PT']]);
  // An answer in the tick in which the next command arrives belongs to the first command.
  assert.deepEqual(update([[12, 'GO-THRU']], [[12, 1]], 13), [
    [3, 8, 12, 'GOTO-PT'],
    [12, 13, 13, 'GO-THRU'],
  ]);
});

test('job_lines_get_their_ticks_from_the_states_of_the_job', () => {
  const log = liveLog();
  const messages = { '/job/lines': [], '/job/state': [] };
  const push = (topic, tick, message) => {
    log.loaded.get(topic).push({ tick, data: messages[topic].push(message) - 1 });
  };
  for (const topic of Object.keys(messages))
    log.loaded.set(topic, new Series([], (index) => messages[topic][index]));
  const progress = new JobProgress(log);
  assert.equal(progress.update(), null);
  const lines = [
    { text: 'vise open PFIXTURE', is_command: false },
    { text: 'MOVE A +2 UNIT_1 4 +2 PFIXTURE 0 -- 0', is_command: true },
  ];
  push('/job/lines', 1, { lines });
  push('/job/state', 1, { index: 0, began: 0, phase: 'plays', outcome: '' });
  push('/job/state', 10, { index: 1, began: 9, phase: 'plays', outcome: 'executing' });
  push('/job/state', 30, { index: 2, began: 29, phase: 'plays', outcome: 'executing' });
  // The same lines again are not another job.
  push('/job/lines', 40, { lines });
  const shown = () => progress.update()?.map(({ text, start, end }) => [text, start, end]);
  assert.deepEqual(shown(), [
    ['vise open PFIXTURE', 10, 30],
    ['MOVE A from UNIT_1:4 to PFIXTURE', 30, Infinity],
  ]);
  push('/job/state', 60, { index: 2, began: 29, phase: 'over', outcome: 'finished' });
  assert.equal(shown()?.[1][2], 60);
});
