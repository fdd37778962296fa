// The commands of each level as bars over time.

import { isFailure, word } from './state.js';

/**
 * @typedef {'move' | 'hand' | 'look' | 'change' | 'pause'} Kind
 * @typedef {{ start: number, end: number, done: number, text: string, kind: Kind, failed: boolean }} Bar
 *   `done`: tick in which the command ended; until `end` the process waited for the next one
 * @typedef {{ id: string, name: string, bars: Bar[] }} Lane
 */

const KINDS = /** @type {[Kind, RegExp][]} */ ([
  ['pause', /PAUSE|ROBOT-INIT|STARTUP|SHUTDOWN/],
  ['look', /LOCATE|flood|precise|MOV-TO-VU/],
  ['change', /^QC|GET-ENDEFF|MOV-TO-HOL/],
  [
    'hand',
    /GRASP|GRIP|RELEASE|ACQUIRE|REMOVE|INSERT|POSITION|GET-OBJECT|GO-UNTIL|GO-WHILE|PLACE|OPEN|CLOSE|FLIP/,
  ],
]);

/** What a command does, by its name. @param {string} text @returns {Kind} */
export function kindOf(text) {
  return KINDS.find(([, pattern]) => pattern.test(text))?.[0] ?? 'move';
}

const DONE = /^(done|finished|fingers-closed|qc-(un)?locked)/;

/**
 * The lanes of a run: job, Task to Prim, Quick Change if it did anything, grippers, vision.
 * @param {import('./run.js').Run} run
 * @returns {Lane[]}
 */
export function lanesOf(run) {
  const of = (/** @type {string} */ id) => bars(run, id);
  const grippers = ['grip', 'v_grip', 'tool_grip'].flatMap(of).sort((a, b) => a.start - b.start);
  grippers.forEach((bar, index) => {
    const next = grippers[index + 1];
    if (next) [bar.end, bar.done] = [Math.min(bar.end, next.start), Math.min(bar.done, next.start)];
  });
  const job = run.commands.map((command) => ({
    start: command.first_tick,
    end: command.last_tick,
    done: command.last_tick,
    text: command.text,
    kind: kindOf(command.text),
    failed: command.status === 'error',
  }));
  const change = of('quick_change');
  return [
    { id: 'workstation', name: 'Job', bars: job },
    { id: 'task', name: 'Task', bars: of('task') },
    { id: 'subtask', name: 'Subtask', bars: of('subtask') },
    { id: 'emove', name: 'E-move', bars: of('emove') },
    { id: 'prim', name: 'Prim', bars: of('prim') },
    ...(change.length > 2 ? [{ id: 'quick_change', name: 'Quick Change', bars: change }] : []),
    { id: 'grip', name: 'Gripper', bars: grippers },
    { id: 'vision', name: 'Vision', bars: visionBars(run) },
  ];
}

/** The commands of a process. @param {import('./run.js').Run} run @param {string} id @returns {Bar[]} */
function bars(run, id) {
  const commands = run.orders.get(id) ?? [];
  const series = run.log.series(`/${id}/status`);
  const statuses = [...series.each('report')];
  return commands.map((command, index) => {
    const end = commands[index + 1]?.tick ?? run.last;
    // The answer to a command arrives at the earliest in the tick after it.
    const answers = statuses.slice(series.index(command.tick) + 1, series.index(end) + 1);
    const answer = answers.find(([, status]) => DONE.test(word(status.report)) || isFailure(status));
    const failed = answer !== undefined && isFailure(answer[1]);
    const done = answer ? answer[0] : end;
    return { start: command.tick, end, done, text: command.text, kind: kindOf(command.text), failed };
  });
}

/** Each picture that vision worked on. @param {import('./run.js').Run} run @returns {Bar[]} */
function visionBars(run) {
  return run.vision.flatMap(({ tick, status }, index) => {
    if (status !== 'busy') return [];
    const answer = run.vision[index + 1];
    const end = answer?.tick ?? run.last;
    const text = answer?.status ?? 'busy';
    return [
      {
        start: tick,
        end,
        done: end,
        text,
        kind: /** @type {Kind} */ ('look'),
        failed: !/^(done|idle|busy)$/.test(text),
      },
    ];
  });
}
