import assert from 'node:assert/strict';
import { test } from 'node:test';
import { failuresOf } from './account.js';
import { chainOf, remedyOf } from './explanation.js';

const reasons = [
  { code: 23, text: 'vision sees no object', remedy: null },
  { code: 4, text: 'the joystick box is on', remedy: 'switch it off' },
];
const commands = [
  {
    tick: 78,
    process: 'HWSC',
    text: 'commands Task: MOVE LINKBAR1_BH at UNIT_1 sector 4 to PFIXTURE, number 5',
  },
  {
    tick: 80,
    process: 'Task',
    text:
      'commands Subtask: GET-OBJECT LINKBAR1_BH at UNIT_1, number 6 ' +
      '(table MOVE row 7: GetObject, then Object, because step is Gripper)',
  },
];
const failure = {
  tick: 623,
  text:
    'E-move: vision sees no object, while it executed LOCATE-OBJ LINKBAR1_BH at UNIT_1 ' +
    '(table LOCATE-OBJ row 7: Flooding => Fail(NothingSeen))',
  commands,
  causes: [
    {
      tick: 623,
      process: 'E-move',
      text:
        'reports error-state: vision sees no object (table LOCATE-OBJ row 7: Fail(NothingSeen), ' +
        'because step is Flooding, sight is Missing); new in this tick: sight is Missing',
    },
  ],
  consequences: [
    {
      tick: 624,
      process: 'Subtask',
      text:
        'reports error-state: vision sees no object ' +
        '(table ORDERED row 4: PassUp in step locating, because emove is Error)',
    },
  ],
};
const report = { tick: 623, kind: 'process', process: 'E-move', table: 'LOCATE-OBJ', text: failure.text };
const hit = {
  tick: 332,
  kind: 'collision',
  process: 'cell',
  table: null,
  text: 'the robot ran into pot_2_near: right_finger was 0.568 in deep at (-54.94, -18.89, -13.02 in)',
};
const lost = { ...hit, tick: 700, kind: 'lost', text: 'the part is lost; it is on the floor' };

/** @param {any} why */
function run(why) {
  const lines = [{ tick: 73, source: 'fault', text: 'fault 1 begins', level: 'warning', code: '' }];
  const failures = failuresOf(why, reasons);
  return /** @type {any} */ ({ why, reasons, lines, failures, cause: failures[0] ?? null });
}

/** @param {any} why */
function chain(why) {
  return chainOf(run(why)).map((it) => [it.tick, it.kind, it.from, it.to]);
}

test('chain_leads_from_the_first_command_to_the_last_report', () => {
  const why = { world: { ...report, followed: [], commands: [], data: [] }, failure, ended: null };
  const failed = run(why);
  assert.deepEqual(
    [failed.cause.tick, failed.cause.process, failed.cause.title, failed.cause.detail],
    [623, 'emove', 'vision sees no object', 'while it executed LOCATE-OBJ LINKBAR1_BH at UNIT_1'],
  );
  assert.deepEqual(chain(why), [
    [73, 'cell', 'In the cell', ''],
    [78, 'command', 'Workstation', 'Task'],
    [80, 'command', 'Task', 'Subtask'],
    [623, 'cause', 'E-move', ''],
    [624, 'report', 'Subtask', ''],
  ]);
  const links = chainOf(failed);
  assert.deepEqual(
    [links[2].text, links[2].row, links[3].row, links[3].news],
    [
      'GET-OBJECT LINKBAR1_BH at UNIT_1',
      'MOVE 7 GetObject',
      'LOCATE-OBJ 7 Fail(NothingSeen)',
      'sight is Missing',
    ],
  );
  assert.equal(remedyOf(failed), 'PAUSE and the same command may be enough.');
});

test('failures_that_followed_are_steps_of_the_chain_in_their_order', () => {
  const why = { world: { ...hit, followed: [report, lost], commands, data: [] }, failure, ended: null };
  assert.deepEqual(chain(why), [
    [73, 'cell', 'In the cell', ''],
    [78, 'command', 'Workstation', 'Task'],
    [80, 'command', 'Task', 'Subtask'],
    [332, 'cause', 'Collision', ''],
    [623, 'then', 'E-move', ''],
    [624, 'report', 'Subtask', ''],
    [700, 'then', 'Lost part', ''],
  ]);
  const texts = chainOf(run(why)).map((it) => it.text);
  assert.deepEqual(
    [texts[3], texts[6]],
    ['the robot ran into pot_2_near', 'the part is lost: it is on the floor'],
  );
  assert.equal(remedyOf(run(why)), null);
});

test('finished_run_has_no_chain', () => {
  assert.deepEqual(chain({ world: null, failure: null, ended: 'finished' }), []);
  assert.deepEqual(chain(null), []);
});
