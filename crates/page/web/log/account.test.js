import assert from 'node:assert/strict';
import { test } from 'node:test';
import { clauses, failuresOf } from './account.js';

const stop =
  'the E-stop on the joystick box was pressed, with the hand at (-51.1 12.9 -16.1 in); ' +
  'the arm has come to rest';
const link =
  'T3 Interface: not responding, while it executed POINT ' +
  '(table RECEIVE row 6: Accepting, link Failed => Ignore)';

test('title_is_the_first_clause_and_never_ends_in_a_coordinate', () => {
  const texts = [
    ['cell', 'the robot ran into pot_2: it was 0.568 in deep at (-54.94, -18.89, -13.02 in); and 2 more'],
    ['T3', stop],
    ['T3 Interface', link],
    ['cell', 'HWSC: the jaw of the vise does not move'],
    ['cell', 'a confirmation is false: E-move reports MOV-OBJ-TO, but LINKBAR1 is 0.42 in from its place'],
  ];
  assert.deepEqual(
    texts.map(([process, text]) => clauses(process, text)),
    [
      {
        title: 'the robot ran into pot_2',
        detail: 'it was 0.568 in deep at (-54.94, -18.89, -13.02 in); and 2 more',
      },
      {
        title: 'the E-stop on the joystick box was pressed',
        detail: 'with the hand at (-51.1 12.9 -16.1 in); the arm has come to rest',
      },
      { title: 'not responding', detail: 'while it executed POINT' },
      { title: 'the jaw of the vise does not move', detail: '' },
      {
        title: 'a confirmation is false',
        detail: 'E-move reports MOV-OBJ-TO, but LINKBAR1 is 0.42 in from its place',
      },
    ],
  );
});

test('failures_are_listed_in_order_with_the_names_of_their_kinds', () => {
  const reported = { tick: 1280, kind: 'link', process: 'T3 Interface', table: 'RECEIVE', text: link };
  const hit = {
    tick: 1282,
    kind: 'collision',
    process: 'cell',
    table: null,
    text: 'the robot ran into pot_2: x',
  };
  const why = {
    world: {
      tick: 1279,
      kind: 'emergency-stop',
      process: 'T3',
      table: null,
      text: stop,
      followed: [reported, hit],
    },
    failure: { ...reported, causes: [{ tick: 1280, process: 'T3 Interface', text: 'reports error' }] },
  };
  assert.deepEqual(
    failuresOf(why, []).map((it) => [it.tick, it.name, it.process, it.title, it.explained]),
    [
      [1279, 'Emergency stop', null, 'the E-stop on the joystick box was pressed', false],
      [1280, 'Lost link', 't3i', 'not responding', true],
      [1282, 'Collision', null, 'the robot ran into pot_2', false],
    ],
  );
});

test('failure_without_an_account_is_a_process_error', () => {
  const failure = {
    tick: 9,
    text: link,
    causes: [{ tick: 8, process: 'T3 Interface', text: 'reports error' }],
  };
  assert.deepEqual(
    failuresOf({ world: null, failure }, []).map((it) => [it.tick, it.kind, it.process]),
    [[8, 'process', 't3i']],
  );
});

test('finished_run_has_no_failure', () => {
  assert.deepEqual(failuresOf({ world: null, failure: null, ended: 'finished' }, []), []);
  assert.deepEqual(failuresOf(null, []), []);
});
