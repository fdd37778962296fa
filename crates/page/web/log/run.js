// What a log says about the run as a whole: commands, events, the failure, the state of the robot.

import { failuresOf } from './account.js';
import { jobLines, lineAt } from './job.js';
import { lanesOf } from './lanes.js';
import { commandsOf, linesOf } from './messages.js';
import { TABLED } from './processes.js';
import { changesOf } from './rows.js';
import { lastUpTo } from './series.js';
import { word } from './state.js';
import { TICK_S } from './units.js';

/**
 * @typedef {'error' | 'contact' | 'warning' | 'fault' | 'operator' | 'camera'} EventKind
 * @typedef {{ tick: number, kind: EventKind, text: string, weight: number }} RunEvent
 * @typedef {[number, number, number]} Point
 * @typedef {{ mover: string, obstacle: string, point: Point, depth: number, permitted: boolean }} Contact
 *   `point`: metres in the world; `depth`: inches
 * @typedef {{ tick: number, contacts: Contact[] }} Contacts
 * @typedef {'run' | 'fault' | 'estop' | 'pause' | 'done'} Mode
 */

export class Run {
  /** @param {import('./log.js').Log} log */
  constructor(log) {
    this.log = log;
    this.last = log.last;
    this.lines = linesOf(log);
    this.orders = commandsOf(this.lines);
    this.info = log.json('info.json') ?? {};
    /** @type {import('./job.js').RunCommand[]} */
    this.commands = this.info.commands ?? [];
    this.why = log.json('why.json');
    /** @type {import('./tables.js').ProcessTables[]} */
    this.tables = log.json('tables.json') ?? [];
    /** @type {{ code: number, text: string, remedy: string | null }[]} */
    this.reasons = log.json('reasons.json') ?? [];
    this.job = jobLines(log.text('job'), this.commands);
    this.contacts = contactsOf(log);
    this.vision = visionOf(log);
    this.failures = failuresOf(this.why, this.reasons);
    /** What went wrong first; null if the run finished. */
    this.cause = this.failures[0] ?? null;
    this.events = eventsOf(this);
    this.lanes = lanesOf(this);
    /** @type {{ tick: number, value: number }[] | null} */
    this.knownSpeeds = null;
    /** @type {{ tick: number, left: number, right: number }[] | null} */
    this.knownForces = null;
    this.changes = changesOf(TABLED.map((id) => log.series(`/${id}/row`)));
  }

  /** How the run ended, in words; empty if the log has no end. */
  get result() {
    return this.log.end?.get('result') ?? '';
  }

  /** Index of the line of the job in a tick. @param {number} tick */
  line(tick) {
    return lineAt(this.job, tick);
  }

  /** What touches in a tick: the log has it in the tick after. @param {number} tick */
  contactsAt(tick) {
    return this.contacts[lastUpTo(this.contacts, tick + 1, (it) => it.tick)]?.contacts ?? [];
  }

  /** The place of the first collision, metres in the world; null if there is none. */
  get collision() {
    return this.contacts.flatMap((it) => it.contacts).find((it) => !it.permitted)?.point ?? null;
  }

  /** The velocity knob, in percent. @param {number} tick */
  knob(tick) {
    const devices = this.log.series('/external/devices').latest(tick);
    return devices?.joystick ? devices.joystick.velocity / 10 : 100;
  }

  /** What the hand holds, as Subtask reports it: `kind` and `name`. @param {number} tick */
  held(tick) {
    const held = this.log.series('/subtask/status').latest(tick)?.held;
    const kind = word(held?.kind ?? 'nothing');
    return { kind, name: held?.object?.object ?? '', grip: held?.object?.grip ?? null };
  }

  /**
   * Position of the tool point, in, from the resolvers; null without a robot.
   * @param {number} tick
   * @returns {number[] | null}
   */
  toolPoint(tick) {
    const frame = this.log.series('/t3i/status').latest(tick)?.resolver_frame;
    return frame ? frame.tool.map((/** @type {number} */ value) => value / 100) : null;
  }

  /**
   * State of the robot in a tick.
   * @param {number} tick
   * @returns {{ mode: Mode, title: string, detail: string }}
   */
  mode(tick) {
    const task = this.log.series('/task/status').latest(tick);
    const { cause } = this;
    if (cause && tick >= cause.tick) {
      const mode = cause.kind === 'emergency-stop' ? 'estop' : 'fault';
      return { mode, title: cause.name.toUpperCase(), detail: `recorded, since tick ${cause.tick}` };
    }
    if (word(task?.report) === 'error') return { mode: 'fault', title: 'FAULT', detail: 'recorded' };
    if (tick >= this.last && this.result === 'finished') {
      return { mode: 'done', title: 'FINISHED', detail: `${this.job.length} lines in the job` };
    }
    if (this.knob(tick) === 0)
      return { mode: 'pause', title: 'STOPPED', detail: 'recorded, the knob is at 0 %' };
    if (task?.command === 'PAUSE') return { mode: 'pause', title: 'PAUSED', detail: 'recorded' };
    return { mode: 'run', title: 'RUNNING', detail: 'recorded' };
  }

  /**
   * Speed of the tool point over time, in/s, one value a tick with a message.
   * @returns {{ tick: number, value: number }[]}
   */
  get speeds() {
    this.knownSpeeds ??= speedsOf(this.log.series('/t3i/status'));
    return this.knownSpeeds;
  }

  /**
   * Forces of the fingers over time, lb, where they change.
   * @returns {{ tick: number, left: number, right: number }[]}
   */
  get forces() {
    this.knownForces ??= forcesOf(this.log.series('/grip/status'));
    return this.knownForces;
  }
}

/** Positions further apart are no movement of the robot but a new start of the link, in/s. */
const JUMP = 60;

/** @param {import('./series.js').Series<any>} statuses */
function speedsOf(statuses) {
  const found = [];
  /** @type {{ tick: number, tool: number[] } | null} */
  let before = null;
  for (const [tick, { resolver_frame: frame }] of statuses.each('resolver_frame')) {
    if (!frame) continue;
    const tool = frame.tool;
    const { tick: last, tool: from } = before ?? { tick: tick - 1, tool };
    const way = Math.hypot(tool[0] - from[0], tool[1] - from[1], tool[2] - from[2]) / 100;
    const value = way / ((tick - last) * TICK_S);
    if (value < JUMP) found.push({ tick, value });
    before = { tick, tool };
  }
  return found;
}

/** @param {import('./series.js').Series<any>} statuses */
function forcesOf(statuses) {
  /** @type {{ tick: number, left: number, right: number }[]} */
  const found = [];
  for (const [tick, { left_force: left, right_force: right }] of statuses) {
    const last = found.at(-1);
    if (last?.left !== left || last?.right !== right) found.push({ tick, left, right });
  }
  return found;
}

/** @param {import('./log.js').Log} log @returns {Contacts[]} */
function contactsOf(log) {
  return [...log.series('/contacts')].map(([tick, update]) => ({
    tick,
    contacts: update.entities.flatMap((/** @type {any} */ entity) => {
      const facts = new Map(entity.metadata.map((/** @type {any} */ it) => [it.key, it.value]));
      const place = entity.spheres[0]?.pose?.position;
      if (!place || !facts.has('mover')) return [];
      return [
        {
          mover: facts.get('mover'),
          obstacle: facts.get('obstacle'),
          point: [place.x, place.y, place.z],
          depth: Number(facts.get('depth_in')),
          permitted: facts.get('permitted') === 'true',
        },
      ];
    }),
  }));
}

/** The changes of what vision reports. @param {import('./log.js').Log} log */
function visionOf(log) {
  /** @type {{ tick: number, status: string }[]} */
  const found = [];
  for (const [tick, devices] of log.series('/external/devices').each('vision')) {
    const status = word(devices.vision?.status ?? 'idle');
    if (found.at(-1)?.status !== status) found.push({ tick, status });
  }
  return found;
}

/** @param {Run} run @returns {RunEvent[]} */
function eventsOf(run) {
  /** @type {RunEvent[]} */
  const found = [];
  for (const { tick, level, source, text, code } of run.lines) {
    const said = `${source}: ${text}`;
    if (source === 'fault') found.push({ tick, kind: 'fault', text: said, weight: 4 });
    else if (code.startsWith('contact.')) {
      if (code === 'contact.begins') found.push({ tick: tick - 1, kind: 'contact', text: said, weight: 5 });
    } else if (level === 'error') found.push({ tick, kind: 'error', text: said, weight: 5 });
    else if (level === 'warning') found.push({ tick, kind: 'warning', text: said, weight: 3 });
  }
  for (const [tick, { source, line }] of run.log.series('/operator')) {
    found.push({ tick, kind: 'operator', text: `${source}: ${line}`, weight: 2 });
  }
  for (const { tick } of run.log.series('/camera').messages) {
    found.push({ tick, kind: 'camera', text: 'a picture of the camera', weight: 1 });
  }
  return found.sort((a, b) => a.tick - b.tick);
}
