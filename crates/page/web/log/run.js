// Facts of the whole run: commands, events, the failure, the state of the robot.

import { failuresOf } from './account.js';
import { JobProgress, jobLines, lineAt } from './job.js';
import { Lanes } from './lanes.js';
import { commandsOf, lineOf } from './messages.js';
import { TABLED } from './processes.js';
import { Reports } from './reports.js';
import { lastUpTo, Reader } from './series.js';
import { reasonText, word } from './state.js';
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

/** Topics whose messages the run reads and keeps. */
const READ = {
  log: '/log',
  operator: '/operator',
  camera: '/camera',
  contacts: '/contacts',
  devices: '/external/devices',
  robot: '/t3i/status',
  grip: '/grip/status',
};

export class Run {
  /** @param {import('./log.js').Log} log */
  constructor(log) {
    this.log = log;
    this.last = 0;
    /** @type {import('./messages.js').Line[]} */
    this.lines = [];
    /** @type {Map<string, import('./messages.js').Command[]>} */
    this.orders = new Map();
    const info = log.json('info.json');
    this.info = info ?? {};
    /** True if `rcs-log info` has listed the commands. */
    this.counted = info !== null;
    /** @type {import('./job.js').RunCommand[]} */
    this.commands = this.info.commands ?? [];
    this.why = log.json('why.json');
    /** @type {import('./tables.js').ProcessTables[]} */
    this.tables = log.json('tables.json') ?? [];
    /** @type {{ code: number, text: string, remedy: string | null }[]} */
    this.reasons = log.json('reasons.json') ?? [];
    /** Words of an operator's lines; null for a log. @type {{ first: string[], names: string[] } | null} */
    this.words = log.json('words.json');
    /** @type {import('./job.js').JobLine[]} */
    this.job = [];
    this.progress = new JobProgress(log);
    /** @type {Contacts[]} */
    this.contacts = [];
    /** Changes of what vision reports. @type {{ tick: number, status: string }[]} */
    this.vision = [];
    this.failures = failuresOf(this.why, this.reasons);
    this.reports = new Reports();
    /**
     * The first failure. Without `why.json` the first report of the last failure; null if nothing failed.
     * @type {import('./account.js').Failure | null}
     */
    this.cause = this.failures[0] ?? null;
    /** @type {RunEvent[]} */
    this.events = [];
    this.tracks = new Lanes(log);
    /** @type {import('./lanes.js').Lane[]} */
    this.lanes = [];
    /** Ticks in which any process decided another row, sorted. @type {number[]} */
    this.changes = [];
    this.knownSpeeds = new Speeds(log);
    /** @type {{ tick: number, left: number, right: number }[]} */
    this.knownForces = [];
    this.readers = {
      log: new Reader(log, READ.log),
      operator: new Reader(log, READ.operator),
      camera: new Reader(log, READ.camera),
      contacts: new Reader(log, READ.contacts),
      vision: new Reader(log, READ.devices, 'vision'),
      grip: new Reader(log, READ.grip),
      rows: TABLED.map((id) => new Reader(log, `/${id}/row`)),
    };
    this.update();
  }

  /** Process the messages up to the last tick: all of a log, or those since the last call. */
  update() {
    const { log, readers } = this;
    this.last = log.last;
    const lines = [...readers.log.fresh()].map(([tick, message]) => lineOf(tick, message));
    const orders = commandsOf(lines);
    append(this.lines, lines);
    if (!this.why) {
      this.reports.add(lines);
      this.cause = this.reports.first;
    }
    for (const [id, list] of orders) {
      const known = this.orders.get(id);
      if (known) append(known, list);
      else this.orders.set(id, list);
    }
    append(this.contacts, contactsOf(readers.contacts.fresh()));
    for (const [tick, devices] of readers.vision.fresh()) {
      const status = word(devices.vision?.status ?? 'idle');
      if (this.vision.at(-1)?.status !== status) this.vision.push({ tick, status });
    }
    append(this.events, eventsOf(lines, readers.operator.fresh(), readers.camera.messages()));
    this.tracks.update(orders, this.last);
    if (!this.counted) this.commands = commandsOfTask(this.tracks.of('task'), this.tracks.tracks.get('task'));
    this.lanes = this.tracks.all(this.commands, this.vision, this.last);
    this.job = this.progress.update() ?? jobLines(log.text('job'), this.commands);
    const ticks = new Set(readers.rows.flatMap((reader) => reader.messages().map(({ tick }) => tick)));
    append(
      this.changes,
      [...ticks].sort((a, b) => a - b),
    );
  }

  /** Remove the data from before a tick. @param {number} tick */
  trim(tick) {
    const recent = (/** @type {{ tick: number }} */ it) => it.tick >= tick;
    this.lines = this.lines.filter(recent);
    this.events = this.events.filter(recent);
    this.changes = this.changes.filter((it) => it >= tick);
    this.contacts = this.contacts.slice(
      Math.max(
        0,
        lastUpTo(this.contacts, tick, (it) => it.tick),
      ),
    );
    this.vision = this.vision.slice(
      Math.max(
        0,
        lastUpTo(this.vision, tick, (it) => it.tick),
      ),
    );
    this.tracks.trim(tick);
    this.knownSpeeds.list = this.knownSpeeds.list.filter(recent);
    this.knownForces = this.knownForces.filter(recent);
  }

  /**
   * The state of the job, of those who command or of the robot controller; null if the log has none.
   * @param {'/job/state' | '/operator/state' | '/cell/controller'} topic
   * @param {number} tick
   */
  view(topic, tick) {
    return this.log.series(topic).latest(tick);
  }

  /** The end of the run as a sentence; empty if the log has no end. */
  get result() {
    return this.log.end?.get('result') ?? '';
  }

  /** Index of the line of the job in a tick. @param {number} tick */
  line(tick) {
    return lineAt(this.job, tick);
  }

  /** The contacts in a tick, which the log contains one tick later. @param {number} tick */
  contactsAt(tick) {
    return this.contacts[lastUpTo(this.contacts, tick + 1, (it) => it.tick)]?.contacts ?? [];
  }

  /** The place of the first collision, metres in the world; null if there is none. */
  get collision() {
    return this.contacts.flatMap((it) => it.contacts).find((it) => !it.permitted)?.point ?? null;
  }

  /**
   * The part that vision did not find, its location, and the expected place in metres; null if vision found it.
   * @param {number} tick
   * @returns {{ part: string, location: string, place: Point } | null}
   */
  missed(tick) {
    const seen = this.vision[lastUpTo(this.vision, tick, (it) => it.tick)]?.status ?? 'idle';
    if (/^(idle|busy|done)$/.test(seen)) return null;
    const orders = this.orders.get('task') ?? [];
    const order = orders[lastUpTo(orders, tick, (it) => it.tick)]?.text ?? '';
    const [, part, location, sector] = /^\S+ (\S+) from ([^ :]+)(?::(\d+))?/.exec(order) ?? [];
    const places = this.log.series('/cell/places').latest(tick)?.places ?? [];
    const found = places.find(
      (/** @type {any} */ it) => it.location === location && it.sector === Number(sector ?? 0),
    );
    if (!found) return null;
    return {
      part,
      location: sector ? `${location} sector ${sector}` : location,
      place: [found.x, found.y, found.z],
    };
  }

  /** The expected place of the part that vision did not find; null if the run failed otherwise. */
  get expected() {
    return this.cause && this.missed(this.cause.tick);
  }

  /**
   * The parts in the cell: frame, name, and where they are in words.
   * @param {number} tick
   * @returns {{ frame: string, name: string, where: string }[]}
   */
  parts(tick) {
    const parts = this.log.series('/cell/parts').latest(tick)?.parts ?? [];
    return parts.map((/** @type {any} */ { frame, name, location, sector, held, clamped }) => {
      const place = location && sector > 0 ? `${location} sector ${sector}` : location;
      return { frame, name, where: held ? 'held' : clamped ? `clamped in ${place}` : place };
    });
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
   * State of the robot in a tick. `note` states the source, such as `recorded`.
   * @param {number} tick
   * @param {string} [note]
   * @returns {{ mode: Mode, title: string, detail: string }}
   */
  mode(tick, note = 'recorded') {
    const task = this.log.series('/task/status').latest(tick);
    const job = this.view('/job/state', tick);
    const pressed = this.view('/cell/controller', tick)?.pressed ?? [];
    const { cause } = this;
    const noted = (/** @type {string} */ text) => [note, text].filter(Boolean).join(', ');
    // A run in progress may have recovered since the failure.
    if (cause && this.why && tick >= cause.tick) {
      const mode = cause.kind === 'emergency-stop' ? 'estop' : 'fault';
      return { mode, title: cause.name.toUpperCase(), detail: noted(`since tick ${cause.tick}`) };
    }
    if (pressed.length > 0) return { mode: 'estop', title: 'E-STOP', detail: noted(pressed.join(', ')) };
    if (job?.phase === 'failed' || word(task?.report) === 'error') {
      return { mode: 'fault', title: 'FAULT', detail: noted(reasonText(task?.reason)) };
    }
    if (job?.phase === 'over' || (tick >= this.last && this.result === 'finished')) {
      return { mode: 'done', title: 'FINISHED', detail: `${this.job.length} lines in the job` };
    }
    if (this.knob(tick) === 0)
      return { mode: 'pause', title: 'STOPPED', detail: noted('the knob is at 0 %') };
    if (task?.command === 'PAUSE') {
      const waits = job?.phase === 'waits';
      return { mode: 'pause', title: 'PAUSED', detail: noted(waits ? 'the job waits' : '') };
    }
    const { kind, name } = this.held(tick);
    const carries = kind === 'object' && note === '' ? `carries ${name}` : '';
    return { mode: 'run', title: 'RUNNING', detail: noted(carries) };
  }

  /**
   * Speed of the tool point over time, in/s, one value a tick with a message.
   * @returns {{ tick: number, value: number }[]}
   */
  get speeds() {
    return this.knownSpeeds.update();
  }

  /**
   * Forces of the fingers over time, lb, where they change.
   * @returns {{ tick: number, left: number, right: number }[]}
   */
  get forces() {
    for (const [tick, { left_force: left, right_force: right }] of this.readers.grip.fresh()) {
      const last = this.knownForces.at(-1);
      if (last?.left !== left || last?.right !== right) this.knownForces.push({ tick, left, right });
    }
    return this.knownForces;
  }
}

/** @template T @param {T[]} list @param {T[]} more */
function append(list, more) {
  for (const item of more) list.push(item);
}

/**
 * The commands of Task as `rcs-log info` counts them, for a run that is not over.
 * @param {import('./lanes.js').Bar[]} bars
 * @param {{ answered: boolean } | undefined} track
 * @returns {import('./job.js').RunCommand[]}
 */
function commandsOfTask(bars, track) {
  return bars.map(({ start, done, text, failed }, index) => {
    const open = index === bars.length - 1 && !track?.answered;
    const status = open ? 'executing' : failed ? 'error' : 'finished';
    return { text, first_tick: start, last_tick: open ? Infinity : done, status };
  });
}

/** Positions further apart are a new start of the link and not a motion of the robot, in/s. */
const JUMP = 60;

/** Speed of the tool point over time. */
class Speeds {
  /** @param {import('./log.js').Log} log */
  constructor(log) {
    this.reader = new Reader(log, READ.robot, 'resolver_frame');
    /** @type {{ tick: number, value: number }[]} */
    this.list = [];
    /** @type {{ tick: number, tool: number[] } | null} */
    this.before = null;
  }

  update() {
    for (const [tick, { resolver_frame: frame }] of this.reader.fresh()) {
      if (!frame) continue;
      const tool = frame.tool;
      const { tick: last, tool: from } = this.before ?? { tick: tick - 1, tool };
      const way = Math.hypot(tool[0] - from[0], tool[1] - from[1], tool[2] - from[2]) / 100;
      const value = way / (Math.max(1, tick - last) * TICK_S);
      if (value < JUMP) this.list.push({ tick, value });
      this.before = { tick, tool };
    }
    return this.list;
  }
}

/** @param {Iterable<[number, any]>} messages @returns {Contacts[]} */
function contactsOf(messages) {
  return [...messages].map(([tick, update]) => ({
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

/**
 * @param {import('./messages.js').Line[]} lines
 * @param {Iterable<[number, any]>} requests
 * @param {{ tick: number }[]} pictures
 * @returns {RunEvent[]}
 */
function eventsOf(lines, requests, pictures) {
  /** @type {RunEvent[]} */
  const found = [];
  for (const { tick, level, source, text, code } of lines) {
    const said = `${source}: ${text}`;
    if (source === 'fault') found.push({ tick, kind: 'fault', text: said, weight: 4 });
    else if (code.startsWith('contact.')) {
      if (code === 'contact.begins') found.push({ tick: tick - 1, kind: 'contact', text: said, weight: 5 });
    } else if (level === 'error') found.push({ tick, kind: 'error', text: said, weight: 5 });
    else if (level === 'warning') found.push({ tick, kind: 'warning', text: said, weight: 3 });
  }
  for (const [tick, { source, line }] of requests) {
    found.push({ tick, kind: 'operator', text: `${source}: ${line}`, weight: 2 });
  }
  for (const { tick } of pictures) {
    found.push({ tick, kind: 'camera', text: 'a picture of the camera', weight: 1 });
  }
  return found.sort((a, b) => a.tick - b.tick);
}
