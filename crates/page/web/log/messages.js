// The lines on `/log`: commands to each level, events in the cell, warnings and errors.

/**
 * @typedef {'debug' | 'info' | 'warning' | 'error'} Level
 * @typedef {{ tick: number, level: Level, source: string, text: string, code: string }} Line
 * @typedef {{ tick: number, text: string, number: string }} Command
 */

import { idOf } from './processes.js';

/** @type {Record<string, Line['level']>} */
const LEVELS = { DEBUG: 'debug', INFO: 'info', WARNING: 'warning', ERROR: 'error', FATAL: 'error' };

/** A line of a message on `/log`. @param {number} tick @param {any} message @returns {Line} */
export function lineOf(tick, { level, name, message, file }) {
  return { tick, level: LEVELS[level] ?? 'info', source: name, text: message, code: file };
}

/**
 * The commands that each process got. Task's begin with a number: `command 5: MOVE LINKBAR1_BH from
 * UNIT_1:4`.
 * @param {Line[]} lines
 * @returns {Map<string, Command[]>}
 */
export function commandsOf(lines) {
  /** @type {Map<string, Command[]>} */
  const commands = new Map();
  const add = (/** @type {string} */ id, /** @type {Command} */ command) => {
    const known = commands.get(id);
    if (known) known.push(command);
    else commands.set(id, [command]);
  };
  for (const { tick, source, text } of lines) {
    const down = /^-> ([^:]+): (.*)$/s.exec(text);
    const id = down && idOf(down[1]);
    if (down && id) add(id, { tick, text: down[2], number: '' });
    const task = source === 'Task' ? /^command (\d+): (.*)$/s.exec(text) : null;
    // A line with the new status of a command has the same form, in small letters.
    if (task && /^[A-Z]/.test(task[2])) add('task', { tick, text: task[2], number: task[1] });
  }
  return commands;
}
