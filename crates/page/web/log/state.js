// The state of a process in a tick: its command, its status, and its decision.

import { decisionAt } from './rows.js';
import { lastUpTo } from './series.js';

/**
 * @typedef {'executing' | 'done' | 'idle' | 'off' | 'failed'} Condition
 * @typedef {object} ProcessState
 * @property {string} command
 * @property {string} number of the command; empty if it is not known
 * @property {string} status
 * @property {string} reason why it failed; empty if it did not
 * @property {Condition} condition
 * @property {boolean} fresh the command arrived in this tick or the one before
 * @property {import('./rows.js').Decision | null} decision
 */

/**
 * An identifier of a message as the program writes it: `error_state` is `error-state`.
 * @param {unknown} value
 */
export function word(value) {
  return String(value ?? '').replace(/_/g, '-');
}

/** A reason of a message as text; empty for none. @param {unknown} value */
export function reasonText(value) {
  const text = String(value ?? 'NONE');
  return text === 'NONE' || text === 'no_error' ? '' : text.replace(/_/g, ' ');
}

/** Returns true if a status reports a failure. @param {any} status */
export function isFailure(status) {
  return /err|link-off|lost|nothing-seen|not-recogni|timeout/.test(word(status.report));
}

/** @type {ProcessState} */
const NOTHING = {
  command: '',
  number: '',
  status: 'idle',
  reason: '',
  condition: 'idle',
  fresh: false,
  decision: null,
};

/**
 * @param {import('./run.js').Run} run
 * @param {string} id
 * @param {number} tick
 * @returns {ProcessState}
 */
export function stateOf(run, id, tick) {
  if (id === 'robot') return robotState(run, tick);
  if (id === 'vision') return visionState(run, tick);
  if (id === 'data') return dataState(run, tick);
  const own = id === 'workstation' ? 'task' : id;
  const orders = run.orders.get(own) ?? [];
  const order = orders[lastUpTo(orders, tick, (it) => it.tick)];
  const status = run.log.series(`/${own}/status`).latest(tick);
  const decision = id === 'workstation' ? null : decisionAt(run.log.series(`/${id}/row`), tick);
  if (!status) return { ...NOTHING, decision };
  const report = word(status.report);
  const reason = reasonText(status.reason ?? status.fault);
  // A gripper off the arm is not executed, and T3 Interface gets a command in every tick.
  const dormant = id.endsWith('_grip') && !order;
  const line = own === 'task' ? run.job[run.line(tick)]?.text : undefined;
  const command = order?.text ?? line ?? (id === 't3i' ? word(status.command) : '');
  return {
    command,
    number: String(status.echo ?? ''),
    status: dormant ? 'dormant' : report,
    reason,
    condition: dormant ? 'off' : isFailure(status) ? 'failed' : conditionOf(report, command),
    fresh: order !== undefined && tick - order.tick < 2 && order.tick > 1,
    decision,
  };
}

/** @param {string} report @param {string} command @returns {Condition} */
function conditionOf(report, command) {
  if (/exec|busy|ready/.test(report)) return 'executing';
  return /done|finished|locked|closed|open/.test(report) && command !== '' ? 'done' : 'idle';
}

/** @param {import('./run.js').Run} run @param {number} tick @returns {ProcessState} */
function robotState(run, tick) {
  const status = run.log.series('/t3i/status').latest(tick);
  if (!status) return { ...NOTHING, status: 'not connected', condition: 'off' };
  const { frames, acknowledged } = status.counters;
  return {
    ...NOTHING,
    command: `${frames} frames sent, ${acknowledged} answered`,
    status: status.link_running ? 'link runs' : 'link is down',
    condition: status.link_running ? 'executing' : 'failed',
  };
}

/** @param {import('./run.js').Run} run @param {number} tick @returns {ProcessState} */
function visionState(run, tick) {
  const at = run.vision[lastUpTo(run.vision, tick, (it) => it.tick)];
  const request = run.log.series('/emove/vision').latest(tick);
  if (!at || !request || at.status === 'idle') return { ...NOTHING, status: 'not asked', condition: 'off' };
  const failed = !/^(done|busy)$/.test(at.status);
  return {
    ...NOTHING,
    command: `${word(request.picture)}, object ${request.object_id}`,
    number: String(request.number),
    status: at.status,
    condition: failed ? 'failed' : at.status === 'busy' ? 'executing' : 'done',
  };
}

/** @param {import('./run.js').Run} run @param {number} tick @returns {ProcessState} */
function dataState(run, tick) {
  const command = run.log.series('/task/data_base_command').latest(tick);
  if (!command?.command || command.command === 'NONE')
    return { ...NOTHING, status: 'not asked', condition: 'off' };
  return {
    ...NOTHING,
    command: word(command.command),
    number: String(command.number ?? ''),
    status: 'asked',
    condition: 'executing',
  };
}
