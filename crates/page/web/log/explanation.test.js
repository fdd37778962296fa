import assert from 'node:assert/strict';
import { test } from 'node:test';
import { causeOf, chainOf, remedyOf } from './explanation.js';

const reasons = [
  { code: 23, text: 'vision sees no object', remedy: null },
  { code: 4, text: 'the joystick box is on', remedy: 'switch it off' },
];
const first = {
  tick: 623,
  process: 'E-move',
  text: 'reports error-state: vision sees no object (table LOCATE-OBJ row 7: Fail(NothingSeen), because step is Flooding, sight is Missing); new in this tick: sight is Missing',
};
const failure = {
  tick: 623,
  text: 'E-move: vision sees no object, while it executed LOCATE-OBJ LINKBAR1_BH at UNIT_1 (table LOCATE-OBJ row 7: Flooding => Fail(NothingSeen))',
  commands: [
    {
      tick: 78,
      process: 'HWSC',
      text: 'commands Task: MOVE LINKBAR1_BH at UNIT_1 sector 4 to PFIXTURE, number 5',
    },
    {
      tick: 80,
      process: 'Task',
      text: 'commands Subtask: GET-OBJECT LINKBAR1_BH at UNIT_1, number 6 (table MOVE row 7: GetObject, then Object, because step is Gripper)',
    },
  ],
  causes: [first],
  consequences: [
    {
      tick: 624,
      process: 'Subtask',
      text: 'reports error-state: vision sees no object (table ORDERED row 4: PassUp in step locating, because emove is Error)',
    },
  ],
};
const world = {
  tick: 332,
  text: 'right_finger runs into pot_2_near, 0.007 in deep, during MOV-TO-VU',
  commands: failure.commands,
  data: [],
};

function run(why) {
  const lines = [{ tick: 73, source: 'fault', text: 'fault 1 begins', level: 'warning', code: '' }];
  const made = { why, reasons, lines, cause: null };
  made.cause = causeOf(made);
  return made;
}

test('a_failure_is_told_from_the_first_command_to_the_last_report', () => {
  const failed = run({ world: { ...world, tick: 623 }, failure, ended: null });
  assert.deepEqual(failed.cause, {
    tick: 623,
    process: 'emove',
    title: 'vision sees no object',
    detail: 'LOCATE-OBJ LINKBAR1_BH at UNIT_1',
    kind: 'failure',
  });
  const chain = chainOf(failed);
  assert.deepEqual(
    chain.map((it) => [it.tick, it.kind, it.from, it.to]),
    [
      [73, 'cell', 'In the cell', ''],
      [78, 'command', 'Workstation', 'Task'],
      [80, 'command', 'Task', 'Subtask'],
      [623, 'cause', 'E-move', ''],
      [624, 'report', 'Subtask', ''],
    ],
  );
  assert.deepEqual(
    [chain[2].text, chain[2].row, chain[3].row, chain[3].news],
    [
      'GET-OBJECT LINKBAR1_BH at UNIT_1',
      'MOVE 7 GetObject',
      'LOCATE-OBJ 7 Fail(NothingSeen)',
      'sight is Missing',
    ],
  );
  assert.equal(remedyOf(failed), 'PAUSE and the same command may be enough.');
});

test('a_contact_before_any_failure_is_the_cause', () => {
  const hit = run({ world, failure: null, ended: 'the robot ran into pot_2_near' });
  assert.deepEqual(
    [hit.cause?.kind, hit.cause?.title, hit.cause?.process],
    ['contact', 'right_finger runs into pot_2_near', null],
  );
  assert.equal(chainOf(hit).at(-1)?.kind, 'cause');
  assert.equal(remedyOf(hit), null);
});

test('a_run_that_finished_has_no_cause', () => {
  assert.equal(run({ world: null, failure: null, ended: 'finished' }).cause, null);
  assert.equal(run(null).cause, null);
});
