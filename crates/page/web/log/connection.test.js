import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Connection, LOOK } from './connection.js';

/** A socket whose answers the test gives. */
class Socket {
  static OPEN = 1;
  static last;
  constructor() {
    this.readyState = Socket.OPEN;
    this.sent = [];
    Socket.last = this;
  }
  send(data) {
    this.sent.push(data);
  }
  close() {
    this.readyState = 3;
  }
}

/** A connection whose time advances only by `pass`. */
function connected(t) {
  const clock = { now: 10_000 };
  t.mock.method(performance, 'now', () => clock.now);
  globalThis.WebSocket = Socket;
  t.mock.timers.enable({ apis: ['setTimeout'] });
  const nothing = () => {};
  const receiver = { begin: nothing, open: nothing, message: nothing, time: nothing, changed: nothing };
  const connection = new Connection('ws://run/', receiver);
  const tick = () => {
    const bytes = new DataView(new ArrayBuffer(9));
    bytes.setUint8(0, 2);
    Socket.last.onmessage({ data: bytes.buffer });
  };
  const pass = (milliseconds) => {
    for (const end = clock.now + milliseconds; clock.now < end;) {
      clock.now += LOOK;
      connection.watch();
    }
  };
  return { connection, clock, tick, pass };
}

test('silence_is_a_loss_within_a_second', (t) => {
  const { connection, tick, pass } = connected(t);
  tick();
  assert.equal(connection.state, 'ok');
  pass(500);
  assert.equal(connection.state, 'ok');
  pass(400);
  assert.equal(connection.state, 'lost');
  tick();
  assert.equal(connection.state, 'ok');
});

test('page_that_was_held_up_reads_before_it_decides', (t) => {
  const { connection, clock, tick } = connected(t);
  tick();
  clock.now += 5000;
  connection.watch();
  tick();
  connection.watch();
  assert.equal(connection.state, 'ok');
});

test('closed_socket_is_a_loss_at_once_and_is_opened_again', (t) => {
  const { connection, tick, pass } = connected(t);
  tick();
  const first = Socket.last;
  first.onclose({ code: 1006 });
  assert.equal(connection.state, 'lost');
  pass(300);
  assert.notEqual(Socket.last, first);
  tick();
  assert.equal(connection.state, 'ok');
});

test('run_that_has_ended_is_no_loss', (t) => {
  const { connection, tick } = connected(t);
  tick();
  Socket.last.onclose({ code: 1001 });
  assert.equal(connection.state, 'ended');
});

test('open_requests_fail_with_the_connection', async (t) => {
  const { connection, tick } = connected(t);
  tick();
  connection.service = 7;
  const answer = connection.ask('stop');
  Socket.last.onclose({ code: 1006 });
  await assert.rejects(answer, /connection was lost/);
  await assert.rejects(connection.ask('stop'), /nothing was sent/);
});
