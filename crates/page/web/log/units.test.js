import assert from 'node:assert/strict';
import { test } from 'node:test';
import { amount, bareLength, clock, duration, force, length, seconds, speed } from './units.js';

test('lengths_and_forces_follow_the_units', () => {
  assert.deepEqual(
    [length('in', 0.714), length('mm', 0.714), bareLength('mm', -1, 3)],
    ['0.71 in', '18.1 mm', '-25.40'],
  );
  assert.deepEqual([force('in', 30), force('mm', 30)], ['30 lb', '133 N']);
  assert.deepEqual([speed('in', 2), speed('mm', 2)], ['2.0 in/s', '51 mm/s']);
});

test('times_are_those_of_ticks', () => {
  assert.equal(seconds(623), '24.92 s');
  assert.deepEqual([duration(152), duration(1499), duration(5972)], ['6.1 s', '1 min 00 s', '3 min 59 s']);
  assert.deepEqual([clock(12, 0), clock(98, 0), clock(61.5, 2)], ['12 s', '1:38', '1:01.50']);
});

test('amounts_have_their_plural', () => {
  assert.deepEqual(
    [amount(0, 'error'), amount(1, 'error'), amount(2, 'error')],
    ['0 errors', '1 error', '2 errors'],
  );
});
