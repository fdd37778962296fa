// The connection to the live view of a run: Foxglove's WebSocket protocol, with channels, time and services.
//
// The protocol is docs/live.md "Content" and "Requests". The server sends the time in every tick, so silence means
// that the run or the connection stands still.

import { textOf } from './bytes.js';

const SUBPROTOCOL = 'foxglove.sdk.v1';
/** Codes of binary messages. */
const CODE = { message: 1, time: 2, response: 3, request: 2 };
/** Topics that the page does not read: bytes for programs, and data that it computes from other topics. */
const LEFT_OUT = ['/replay', '/trail', '/t3i/link_tx', '/robot_description'];
/** Silence after which the connection is treated as lost, milliseconds. */
const SILENCE = 700;
/** Interval of checking the connection, milliseconds. Added to the silence it is well below a second. */
export const LOOK = 50;
/** Pauses before the attempts to connect again, milliseconds; the last one repeats. */
const PAUSES = [250, 500, 1000, 2000];
/** Time limit of an answer, milliseconds: that of the run, and the transmission. */
const PATIENCE = 3000;
/** The service for any line of an operator. */
const REQUEST = '/operator/request';
const TOKEN = '/operator/token';
/** Name of this client among the operators, whether it may send requests, and the seconds of the past that it wants. */
const NAME = '/viewer/name';
const ACCESS = '/operator/access';
const PAST = '/viewer/past';
/** Most seconds of the past that the server keeps. */
const KEPT = 60;
/** Level of a status that refuses something. */
const ERROR = 2;
/** Close code of a run that has ended. */
const AWAY = 1001;

/**
 * @typedef {'connecting' | 'ok' | 'lost' | 'ended'} State
 * @typedef {object} Receiver
 * @property {(info: any) => void} begin facts of the server, at the start of each connection
 * @property {(channel: import('./mcap.js').Channel) => void} open
 * @property {(topic: string, time: bigint, data: Uint8Array) => void} message
 * @property {(time: bigint) => void} time
 * @property {() => void} changed the state of the connection or of the token has changed
 */

export class Connection {
  /** @param {string} address @param {Receiver} receiver */
  constructor(address, receiver) {
    this.address = address;
    this.receiver = receiver;
    /** @type {State} */
    this.state = 'connecting';
    /** Time of the last tick that arrived, as `performance.now` has it; null before the first. @type {number | null} */
    this.heard = null;
    /** Time of the last message, or of the last attempt. */
    this.received = performance.now();
    /** The time of the last tick when a check found it too old. @type {number | null} */
    this.suspect = null;
    this.attempts = 0;
    /** Time of the next attempt. */
    this.next = 0;
    /** @type {WebSocket | null} */
    this.socket = null;
    /** @type {Map<number, string>} Topics by subscription. */
    this.topics = new Map();
    /** Number of the service for requests; null if the run accepts none. @type {number | null} */
    this.service = null;
    this.token = '';
    /** Name of this client among the operators of the run. */
    this.name = '';
    /** @type {'none' | 'asked' | 'accepted'} */
    this.right = 'none';
    /** @type {Map<number, { resolve: (answer: string) => void, reject: (error: Error) => void }>} */
    this.calls = new Map();
    this.call = 0;
    this.connect();
  }

  connect() {
    const socket = new WebSocket(this.address, SUBPROTOCOL);
    socket.binaryType = 'arraybuffer';
    this.socket = socket;
    this.topics.clear();
    this.service = null;
    this.right = 'none';
    this.received = performance.now();
    socket.onmessage = ({ data }) => {
      if (this.socket === socket) this.take(data);
    };
    socket.onclose = ({ code }) => {
      if (this.socket === socket) this.lose(code === AWAY ? 'ended' : 'lost');
    };
  }

  /** Check for silence, and connect again when it is time. Call it every `LOOK` milliseconds. */
  watch() {
    const now = performance.now();
    const { heard } = this;
    const isOld = heard !== null && now - heard > SILENCE;
    // A delayed page first reads the messages that have arrived meanwhile, so only the second check decides.
    if (this.state === 'ok' && isOld && this.suspect === heard) this.become('lost');
    this.suspect = isOld ? heard : null;
    // An attempt that gets no answer is given up.
    if (this.socket && this.state !== 'ok' && now - this.received > 2 * PATIENCE) this.lose('lost');
    if (!this.socket && now >= this.next) this.connect();
  }

  /** @param {State} state */
  become(state) {
    if (this.state === state) return;
    this.state = state;
    this.receiver.changed();
  }

  /** The connection has ended. @param {State} state */
  lose(state) {
    this.socket?.close();
    this.socket = null;
    this.next = performance.now() + PAUSES[Math.min(this.attempts, PAUSES.length - 1)];
    this.attempts += 1;
    for (const { reject } of this.calls.values()) reject(new Error('the connection was lost'));
    this.calls.clear();
    this.right = 'none';
    this.become(this.state === 'ended' ? 'ended' : state);
    this.receiver.changed();
  }

  /** @param {string | ArrayBuffer} data */
  take(data) {
    this.received = performance.now();
    if (typeof data === 'string') {
      this.text(JSON.parse(data));
      return;
    }
    const view = new DataView(data);
    const code = view.getUint8(0);
    if (code === CODE.time) {
      // Only a run sends the time, so the connection is treated as alive from the first tick on.
      [this.heard, this.attempts] = [this.received, 0];
      this.become('ok');
      this.receiver.time(view.getBigUint64(1, true));
    } else if (code === CODE.message) {
      const topic = this.topics.get(view.getUint32(1, true));
      if (topic) this.receiver.message(topic, view.getBigUint64(5, true), new Uint8Array(data, 13));
    } else if (code === CODE.response) {
      const length = view.getUint32(9, true);
      const { answer } = JSON.parse(textOf(new Uint8Array(data, 13 + length)));
      this.answered(view.getUint32(5, true), (call) => call.resolve(String(answer)));
    }
  }

  /** Seconds of the past whose messages the page has not received. */
  missed() {
    if (this.heard === null) return KEPT;
    return Math.min(KEPT, Math.ceil((performance.now() - this.heard) / 1000) + 1);
  }

  /** @param {any} message */
  text(message) {
    if (message.op === 'serverInfo') {
      this.receiver.begin(message);
      this.send({ op: 'getParameters', parameterNames: [NAME, ACCESS], id: NAME });
      this.send({ op: 'setParameters', parameters: [{ name: PAST, value: this.missed() }] });
    } else if (message.op === 'advertise') this.advertised(message.channels);
    else if (message.op === 'advertiseServices') {
      const found = message.services.find((/** @type {any} */ it) => it.name === REQUEST);
      this.service = found?.id ?? null;
      if (this.token) this.authorize(this.token);
      this.receiver.changed();
    } else if (message.op === 'serviceCallFailure') {
      this.answered(message.callId, (call) => call.reject(new Error(message.message)));
    } else if (message.op === 'parameterValues' && message.id === NAME) {
      const values = new Map(message.parameters.map((/** @type {any} */ it) => [it.name, it.value]));
      this.name = String(values.get(NAME) ?? '');
      // A gateway has checked the person, so no token is needed.
      if (values.get(ACCESS) === 'granted') this.right = 'accepted';
      this.receiver.changed();
    } else if (message.op === 'parameterValues' && message.id === TOKEN) {
      this.right = 'accepted';
      this.receiver.changed();
    } else if (message.op === 'status' && message.level === ERROR && this.right === 'asked') {
      // Of all messages, the run can refuse only the token.
      this.right = 'none';
      this.receiver.changed();
    }
  }

  /** @param {any[]} channels */
  advertised(channels) {
    const wanted = channels.filter((channel) => !LEFT_OUT.includes(channel.topic));
    for (const { id, topic, encoding, schemaName, schemaEncoding, schema } of wanted) {
      const data =
        schemaEncoding === 'protobuf'
          ? Uint8Array.from(atob(schema), (letter) => letter.charCodeAt(0))
          : new Uint8Array();
      this.receiver.open({
        id,
        topic,
        encoding,
        schema: { name: schemaName, encoding: schemaEncoding, data },
      });
      this.topics.set(id, topic);
    }
    const subscriptions = wanted.map(({ id }) => ({ id, channelId: id }));
    if (subscriptions.length > 0) this.send({ op: 'subscribe', subscriptions });
  }

  /** @param {object} message */
  send(message) {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  /** Show the token to the run. @param {string} token */
  authorize(token) {
    this.token = token;
    this.right = 'asked';
    this.send({ op: 'setParameters', parameters: [{ name: TOKEN, value: token }], id: TOKEN });
    this.receiver.changed();
  }

  /**
   * Send a line as an operator.
   * @param {string} line
   * @returns {Promise<string>} the answer of the run
   * @throws {Error} the refusal, or that there is no answer
   */
  ask(line) {
    const { socket, service } = this;
    if (socket?.readyState !== WebSocket.OPEN || service === null)
      return Promise.reject(new Error('there is no connection: nothing was sent'));
    const call = (this.call = (this.call + 1) >>> 0);
    const payload = new TextEncoder().encode(JSON.stringify({ token: this.token, line }));
    const bytes = new Uint8Array(17 + payload.length);
    const view = new DataView(bytes.buffer);
    view.setUint8(0, CODE.request);
    [service, call, 4].forEach((number, at) => view.setUint32(1 + 4 * at, number, true));
    bytes.set(new TextEncoder().encode('json'), 13);
    bytes.set(payload, 17);
    socket.send(bytes);
    return new Promise((resolve, reject) => {
      this.calls.set(call, { resolve, reject });
      setTimeout(
        () =>
          this.answered(call, (it) => it.reject(new Error('the run has not answered: look at the robot'))),
        PATIENCE,
      );
    });
  }

  /**
   * @param {number} call
   * @param {(call: { resolve: (answer: string) => void, reject: (error: Error) => void }) => void} end
   */
  answered(call, end) {
    const waiting = this.calls.get(call);
    this.calls.delete(call);
    if (waiting) end(waiting);
  }
}
