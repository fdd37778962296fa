import assert from 'node:assert/strict';
import { test } from 'node:test';
import { reportedChain, Reports } from './reports.js';

const line = (tick, source, text, level = 'info', code = '') => ({ tick, source, text, level, code });
const LINES = [
  line(78, 'Task', 'command 5: MOVE PART at UNIT_1 to PFIXTURE'),
  line(80, 'Task', '-> Subtask: GET-OBJECT PART at UNIT_1'),
  line(81, 'Subtask', '-> E-move: MOV-TO-VU PART at UNIT_1'),
  line(90, 'fault', 'fault 1 begins: the camera is blind', 'warning', 'fault.begins'),
  line(607, 'Subtask', '-> E-move: LOCATE-OBJ PART at UNIT_1'),
  line(
    623,
    'E-move',
    'vision sees no object (LOCATE-OBJ row 7: Flooding, sight Missing => Fail(NothingSeen))',
    'error',
  ),
  line(624, 'Subtask', 'vision sees no object (ORDERED row 4: emove Error => PassUp)', 'error'),
  line(625, 'Task', 'command 5: error', 'error'),
];

/** The state of the reports after some lines. */
function reported(lines) {
  const reports = new Reports();
  reports.add(lines);
  return { reports, chain: reportedChain({ lines, reports }) };
}

test('chain_has_the_commands_in_force_and_the_reports_in_their_order', () => {
  const { reports, chain } = reported(LINES);
  assert.deepEqual(
    [reports.first?.tick, reports.first?.process, reports.first?.title],
    [623, 'emove', 'vision sees no object'],
  );
  assert.deepEqual(
    chain.map(({ tick, kind, from, to, row }) => [tick, kind, from, to, row]),
    [
      [78, 'command', 'Workstation', 'Task', ''],
      [80, 'command', 'Task', 'Subtask', ''],
      [90, 'cell', 'In the cell', '', ''],
      [607, 'command', 'Subtask', 'E-move', ''],
      [623, 'cause', 'E-move', '', 'LOCATE-OBJ 7 Fail(NothingSeen)'],
      [624, 'report', 'Subtask', '', 'ORDERED 4 PassUp'],
    ],
  );
});

test('later_report_begins_another_failure', () => {
  const later = line(5437, 'cell', 'left_finger runs into PART, 0.05 in deep', 'error', 'contact.begins');
  const { reports } = reported([...LINES, later]);
  assert.deepEqual([reports.list.length, reports.first?.kind, reports.first?.tick], [1, 'collision', 5436]);
});

test('run_without_a_report_has_no_chain', () => {
  const { reports, chain } = reported(LINES.slice(0, 5));
  assert.deepEqual([reports.first, chain], [null, []]);
});
