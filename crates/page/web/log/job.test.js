import assert from 'node:assert/strict';
import { test } from 'node:test';
import { jobLines, lineAt } from './job.js';

const JOB = `# a comment
** tray UNIT_1 4 LINKBAR1_BH
== MOVE LINKBAR1_BH +2 UNIT_1 4 +2 PFIXTURE 0 -- 0
** vise close PFIXTURE
== POSITION H-LINKBAR1_BH +1 PFIXTURE 0 +0 -- 0 -- 0
== MOVE -- +0 -- 0 +0 HOME 0 -- 0
`;
const commands = [
  { text: 'PAUSE', first_tick: 2, last_tick: 71, status: 'finished' },
  { text: 'MOVE LINKBAR1_BH from UNIT_1:4 to PFIXTURE', first_tick: 78, last_tick: 2499, status: 'finished' },
  { text: 'POSITION H-LINKBAR1_BH from PFIXTURE', first_tick: 2505, last_tick: 2662, status: 'error' },
];

test('lines_have_the_ticks_of_their_commands', () => {
  const lines = jobLines(JOB, commands);
  assert.deepEqual(
    lines.map(({ start, end }) => [start, end]),
    [
      [0, 0],
      [78, 2499],
      [2499, 2499],
      [2505, 2662],
      [Infinity, Infinity],
    ],
  );
  assert.deepEqual(
    [0, 77, 78, 2500, 2600].map((tick) => lineAt(lines, tick)),
    [0, 0, 1, 2, 3],
  );
});

test('lines_that_did_not_begin_are_put_in_words', () => {
  const lines = jobLines(JOB, []);
  assert.deepEqual(
    lines.map((line) => line.text),
    [
      'tray UNIT_1 4 LINKBAR1_BH',
      'MOVE LINKBAR1_BH from UNIT_1:4 to PFIXTURE',
      'vise close PFIXTURE',
      'POSITION H-LINKBAR1_BH from PFIXTURE',
      'MOVE to HOME',
    ],
  );
  // Only the first line can run before a command has begun.
  assert.equal(lineAt(lines, 100), 0);
});
