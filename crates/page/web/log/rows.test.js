import assert from 'node:assert/strict';
import { test } from 'node:test';
import { besideOf, decisionAt, rowsBetween, valuesOf } from './rows.js';
import { lastUpTo, Series } from './series.js';

const message = (
  row,
  { table = 'GO-THRU', step = 'going', resting = false, fired = 0, beside = '', next = '' } = {},
) => ({
  table,
  table_number: 1,
  row,
  action: '',
  next,
  step,
  resting,
  values: 'way Kept',
  beside,
  fired_tick: fired,
});

/** A series of values that need no decoding. */
function series(values) {
  return new Series(
    values.map(([tick, data]) => ({ tick, data })),
    (data) => data,
  );
}

const rows = series([
  [5, message(0)],
  [10, message(1, { step: 'start', next: 'Going' })],
  [12, message(3)],
  [20, message(3, { resting: true, fired: 19 })],
  [30, message(2, { table: 'PAUSE', beside: 'ATTEND row 6 (course Rest); GO-THRU row 4 (way Kept)' })],
]);

test('a_decision_holds_from_its_message_to_the_next', () => {
  assert.equal(decisionAt(rows, 4), null);
  assert.equal(decisionAt(rows, 7), null);
  assert.deepEqual(
    [decisionAt(rows, 15)?.row, decisionAt(rows, 15)?.fired, decisionAt(rows, 15)?.before],
    [3, 15, 'start'],
  );
  assert.deepEqual([decisionAt(rows, 25)?.resting, decisionAt(rows, 25)?.fired], [true, 19]);
});

test('values_and_tables_beside_are_read_from_their_texts', () => {
  assert.deepEqual(valuesOf('work Busy, clock Running'), { work: 'Busy', clock: 'Running' });
  assert.deepEqual(valuesOf(''), {});
  assert.deepEqual(besideOf('PATH-CLOCK row 4 (first_pause Sent, t3i Finished)'), [
    { table: 'PATH-CLOCK', row: 4, values: { first_pause: 'Sent', t3i: 'Finished' } },
  ]);
  assert.deepEqual(besideOf(''), []);
});

test('the_rows_of_a_table_are_found_beside_another_one_too', () => {
  const found = rowsBetween(rows, 'GO-THRU', 11, 32);
  assert.deepEqual(
    found.map(({ row, start, end, resting }) => [row, start, end, resting]),
    [
      [1, 11, 12, false],
      [3, 12, 20, false],
      [3, 20, 30, true],
      [4, 30, 33, false],
    ],
  );
});

test('the_last_item_up_to_a_value_is_found', () => {
  const key = (it) => it;
  assert.deepEqual(
    [0, 1, 2, 3, 9].map((value) => lastUpTo([1, 3, 3], value, key)),
    [-1, 0, 0, 2, 2],
  );
});
