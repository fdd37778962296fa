import assert from 'node:assert/strict';
import { test } from 'node:test';
import { firstRow, foldRows, mismatches, nearMisses, stepBefore } from './tables.js';

const named = (...names) => names.map((name) => ({ name, doc: '' }));
const row = (steps, when, action = 'Wait', next = null) => ({ steps, when, action, next });
/** The example of `rcs_core::table`. */
const table = {
  name: 'CLOSE-DOOR',
  doc: '',
  source: '',
  actions: [],
  steps: named('Start', 'Closing'),
  variables: [{ name: 'door', doc: '', values: named('Open', 'Shut', 'Stuck') }],
  rows: [
    row([], { door: ['Shut'] }, 'Finish'),
    row(['Start'], { door: ['Open', 'Stuck'] }, 'Close', 'Closing'),
    row(['Closing'], { door: ['Open'] }),
    row(['Closing'], { door: ['Stuck'] }, 'Fail(DoorStuck)'),
  ],
};

test('a_row_names_what_does_not_fit', () => {
  assert.deepEqual(mismatches(table.rows[2], { door: 'Shut' }, 'start'), ['step', 'door']);
  assert.deepEqual(mismatches(table.rows[2], { door: 'Open' }, 'closing'), []);
  assert.deepEqual(mismatches(table.rows[2], {}, ''), []);
  assert.equal(firstRow(table, { door: 'Stuck' }, 'closing'), 4);
});

test('near_misses_are_rows_that_one_other_value_would_have_fired', () => {
  const near = nearMisses(table, { door: 'Stuck' }, 'closing', 4);
  assert.deepEqual(
    [...near],
    [
      [3, { variable: 'door', value: 'Open' }],
      [1, { variable: 'door', value: 'Shut' }],
    ],
  );
});

test('the_step_before_a_row_is_the_one_that_explains_it', () => {
  const decision = (fired, before, step, next = '', lookedUp = undefined) =>
    stepBefore(table, {
      row: fired,
      values: { door: 'Open' },
      before,
      step,
      next,
      lookedUp,
      table: '',
      since: 0,
      fired: 0,
      resting: false,
      beside: [],
    });
  assert.equal(decision(2, 'start', 'closing', 'Closing'), 'start');
  assert.equal(decision(3, 'closing', 'closing'), 'closing');
  assert.equal(decision(3, 'closing', 'closing', '', 'opening'), 'opening');
  // A new command begins in the first step, for any step of the previous command.
  assert.equal(decision(2, 'closing', 'closing', 'Closing'), 'Start');
});

test('rows_that_do_not_fit_fold_until_the_table_has_room', () => {
  const reasons = [...Array(20)].map((_, index) => (index === 9 ? [] : index < 9 ? ['step'] : ['door']));
  assert.equal(foldRows(reasons, (it) => it === 10, 20).length, 20);
  const folded = foldRows(reasons, (it) => it === 10, 14);
  assert.deepEqual(folded.slice(-2), [{ row: 10 }, { first: 11, last: 20, by: 'door' }]);
  assert.deepEqual(
    foldRows(reasons, (it) => it === 10, 3),
    [{ first: 1, last: 9, by: 'step' }, { row: 10 }, { first: 11, last: 20, by: 'door' }],
  );
});
