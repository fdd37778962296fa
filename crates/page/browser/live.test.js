// The page in Chromium, for runs in progress and for logs: `node --test crates/page/browser`, after a release build.
//
// RCS_PROGRAMS names the directory of the programs, CHROMIUM the browser.

import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { after, before, test } from 'node:test';
import { Browser } from './chromium.js';

const PROGRAMS = resolve(process.env.RCS_PROGRAMS ?? 'target/release');
const CHROMIUM = process.env.CHROMIUM ?? 'chromium';
/** Pixels of the robot's orange in a picture of the cell; the fence has none. */
const ROBOT = 2000;

/** @type {Browser} */
let browser;
let scratch = '';

before(() => {
  scratch = mkdtempSync(join(tmpdir(), 'page-test-'));
  browser = new Browser(CHROMIUM);
});

after(async () => {
  await browser.close();
  rmSync(scratch, { recursive: true, force: true });
});

let runs = 0;

/** A run with a live view: its address, its token, and its output when it has ended. */
class Live {
  static async start(options = ['--operator', 'network'], port = 0) {
    const live = new Live();
    const log = join(scratch, `run-${++runs}.mcap`);
    const clock = options.includes('--clock') ? [] : ['--clock', 'real'];
    const all = ['linkbar', ...clock, '--live', String(port), '--log', log, ...options];
    live.process = spawn(join(PROGRAMS, 'rcs-run'), all, { cwd: scratch });
    let [said, printed] = ['', ''];
    live.process.stdout.on('data', (part) => (printed += part));
    live.ended = new Promise((resolve) => live.process.once('exit', () => resolve(printed)));
    await new Promise((resolve, reject) => {
      live.process.once('exit', (code) => reject(new Error(`rcs-run ends with ${code}: ${said}`)));
      live.process.stderr.on('data', (part) => {
        said += part;
        const [, address] = /open (http:\S+)/.exec(said) ?? [];
        if (!address) return;
        live.address = address;
        live.token = /token (\w+)/.exec(said)?.[1] ?? '';
        resolve(undefined);
      });
    });
    return live;
  }

  async end() {
    this.process.kill('SIGINT');
    return this.ended;
  }
}

/** An expression: the state in the bar. */
const state = (text) => `document.querySelector('.state b')?.innerText === '${text}'`;

/** Number of orange pixels of the picture of the cell. */
const ORANGE = `(async () => {
  const canvas = document.getElementById('gl');
  const image = new Image();
  await new Promise((done) => requestAnimationFrame(done));
  image.src = canvas.toDataURL();
  await image.decode();
  const copy = Object.assign(document.createElement('canvas'), { width: canvas.width, height: canvas.height });
  const context = copy.getContext('2d');
  context.drawImage(image, 0, 0);
  const { data } = context.getImageData(0, 0, copy.width, copy.height);
  let found = 0;
  for (let at = 0; at < data.length; at += 4)
    if (data[at] > 120 && data[at + 1] > data[at] * 0.25 && data[at + 1] < data[at] * 0.6 && data[at + 2] < data[at] * 0.3)
      found++;
  return found;
})()`;

test('live_page_shows_robot_lit_row_and_moving_time', async () => {
  const live = await Live.start([]);
  const served = await (await fetch(live.address)).text();
  assert.ok(served.length < 400_000, `${served.length} bytes`);
  const page = await browser.open(`${live.address}#view=explain&process=t3i`);
  await page.until(state('RUNNING'));
  await page.until(`${ORANGE}.then((found) => found > ${ROBOT})`);
  await page.until(`document.querySelectorAll('#table tr.fired').length === 1`);
  const tick = () => page.value(`Number(/Tick (\\d+)/.exec(document.body.innerText)[1])`);
  const first = await tick();
  await page.until(`Number(/Tick (\\d+)/.exec(document.body.innerText)[1]) > ${first + 10}`);
  assert.match(await page.text('.live'), /LIVE/);
  assert.deepEqual(
    page.errors.filter((error) => !error.includes('favicon')),
    [],
  );
  await page.close();
  await live.end();
});

test('viewer_without_token_sees_no_buttons_and_wrong_token_is_refused', async () => {
  const live = await Live.start();
  const page = await browser.open(`${live.address}#view=operate`);
  await page.until(`document.querySelector('#controls')?.innerText.includes('You watch')`);
  assert.equal(await page.value(`document.querySelectorAll('[data-operate]').length`), 0);
  await page.value(`document.getElementById('token').focus()`);
  await page.type('0123456789abcdef0123456789abcdef');
  await page.key('Enter', 'Enter', 13);
  await new Promise((resolve) => setTimeout(resolve, 500));
  assert.equal(await page.value(`document.querySelectorAll('[data-operate]').length`), 0);
  await page.value(`document.getElementById('token').value = ''`);
  await page.type(live.token);
  await page.key('Enter', 'Enter', 13);
  await page.until(`document.querySelectorAll('[data-operate]').length > 0`);
  await page.close();
  await live.end();
});

test('operator_stops_goes_pauses_turns_the_knob_and_sends_lines', async () => {
  const live = await Live.start();
  const page = await browser.open(`${live.address}#view=operate&token=${live.token}`);
  await page.until(`document.querySelector('.large.stop')`);
  assert.match(await page.text('#controls'), /No safety function/);
  assert.doesNotMatch(await page.value('location.href'), /token/);
  await page.until(state('RUNNING'));
  await page.press('.large.stop');
  await page.until(state('STOPPED'));
  // A tap is not a hold.
  await page.press('.large.go');
  await new Promise((resolve) => setTimeout(resolve, 800));
  assert.ok(await page.value(state('STOPPED')));
  await page.press('.large.go', 900);
  await page.until(state('RUNNING'));
  // A tap in the middle of the knob lowers the speed to half.
  await page.press('#knob');
  await page.until(`document.querySelector('.reading b').innerText === '50 %'`);
  await page.press('.large.pause');
  await page.until(state('PAUSED'));
  assert.match(await page.value(`document.querySelector('.large.pause').title`), /PAUSE/);
  const send = async (line) => {
    await page.value(`document.getElementById('line').focus()`);
    await page.type(line);
    await page.key('Enter', 'Enter', 13);
  };
  await send('bord 2 stop');
  await page.until(`document.querySelector('output.refused')?.innerText.includes('the nearest is board')`);
  await send('note <img src=x onerror=document.title=1>');
  await page.until(`document.querySelector('output')?.innerText.includes('tick')`);
  await page.value(`location.hash = 'view=trace&panel=messages'`);
  await page.until(`document.querySelector('#table')?.innerText.includes('Messages')`);
  assert.equal(await page.value(`document.querySelectorAll('img[src=x]').length`), 0);
  assert.notEqual(await page.value('document.title'), '1');
  await page.close();
  await live.end();
});

/** Counts the draw calls of the picture of the cell. */
const COUNT_CALLS = `{
  window.calls = 0;
  for (const name of ['drawArrays', 'drawElements']) {
    const draw = WebGL2RenderingContext.prototype[name];
    WebGL2RenderingContext.prototype[name] = function (...values) {
      window.calls++;
      return draw.apply(this, values);
    };
  }
}`;

/** Records the time when the page shows a lost connection. */
const WATCH_LOSS = `{
  window.lostAt = 0;
  const observer = new MutationObserver(() => {
    if (!(${state('NO CONNECTION')})) return;
    window.lostAt = Date.now();
    observer.disconnect();
  });
  observer.observe(document.body, { subtree: true, childList: true, characterData: true });
}`;

test('lost_connection_shows_and_comes_back', async (t) => {
  const live = await Live.start();
  const page = await browser.open(`${live.address}#view=operate&token=${live.token}`);
  await page.until(`document.querySelector('.large.stop')`);
  await page.value(WATCH_LOSS);
  const begin = Date.now();
  live.process.kill('SIGSTOP');
  t.diagnostic(`the page shows the loss after ${(await page.until('window.lostAt')) - begin} ms`);
  // Messages that were on their way may restore the connection once more.
  await page.until(`${state('NO CONNECTION')}
    && document.querySelectorAll('.large:not([aria-disabled])').length === 0
    && document.querySelector('.notice.lost')?.innerText.includes('The robot may still be moving')`);
  live.process.kill('SIGCONT');
  await page.until(state('RUNNING'));
  const port = Number(new URL(live.address).port);
  await live.end();
  await page.until(state('RUN ENDED'));
  const next = await Live.start([], port);
  await page.until(state('RUNNING'));
  await page.close();
  await next.end();
});

test('failed_log_opens_at_its_cause_with_the_chain', async () => {
  const log = join(scratch, 'blind.mcap');
  const run = spawnSync(join(PROGRAMS, 'rcs-run'), ['linkbar', '--faults', 'camera-blind', '--log', log], {
    cwd: scratch,
  });
  assert.equal(run.status, 1, String(run.stderr));
  const written = spawnSync(join(PROGRAMS, 'rcs-log'), ['page', log]);
  assert.equal(written.status, 0, String(written.stderr));
  const page = await browser.open(`file://${log.replace('.mcap', '.html')}`);
  await page.until(`document.querySelector('.why')?.innerText.includes('FIRST CAUSE')`);
  assert.match(await page.text('.why-head'), /vision sees no object/);
  assert.match(await page.text('#table tr.fired'), /NothingSeen/);
  await page.until(`${ORANGE}.then((found) => found > ${ROBOT / 4})`);
  await page.value(COUNT_CALLS);
  await page.key('[', 'BracketLeft');
  await page.until('window.calls > 0');
  const calls = await page.value('new Promise((done) => setTimeout(() => done(window.calls), 200))');
  assert.ok(calls <= 60, `${calls} draw calls for a tick`);
  assert.match(await page.text('.recorded'), /LOG/);
  assert.deepEqual(page.errors, []);
  await page.close();
});

test('failed_run_shows_what_its_processes_report', async () => {
  // The job waits for an operator at its start, and then instead of failing.
  const live = await Live.start([
    ...['--operator', 'network', '--stand-by', '--faults', 'camera-blind', '--clock', '2x'],
  ]);
  const page = await browser.open(`${live.address}#view=operate&token=${live.token}`, {
    width: 1200,
    height: 600,
  });
  await page.until(`document.querySelector('.large.stop')`);
  // A viewer becomes an operator with its first request.
  await page.value(`document.getElementById('line').focus()`);
  await page.type('job go');
  await page.key('Enter', 'Enter', 13);
  await page.until(state('FAULT'));
  await page.value(`location.hash = 'view=trace'`);
  await page.until(`document.querySelector('.why')?.innerText.includes('FIRST REPORT')`);
  const chain = await page.text('.why');
  for (const text of ['Workstation', 'Subtask', 'LOCATE-OBJ', 'vision sees no object'])
    assert.ok(chain.includes(text), `${text} is not in ${chain}`);
  await page.close();
  await live.end();
});

test('ten_pages_beside_a_run_change_no_bit', async () => {
  // Ten pages on few processors can cause missed slots of the grid, which stop the robot by default.
  const live = await Live.start(['--json', '--operator', 'none', '--overrun', 'count']);
  const pages = await Promise.all(
    [...Array(10)].map(() => browser.open(live.address, { width: 700, height: 500 })),
  );
  await Promise.all(pages.map((page) => page.until(`document.querySelector('.live')`)));
  const beside = JSON.parse(await live.end());
  const options = ['linkbar', '--json', '--log', 'none', '--ticks', String(beside.ticks)];
  const alone = spawnSync(join(PROGRAMS, 'rcs-run'), options, { cwd: scratch });
  // In real time the robot ramps down after the last tick.
  assert.equal(beside.digest_before_ramp, JSON.parse(String(alone.stdout)).digest);
  await Promise.all(pages.map((page) => page.close()));
});
