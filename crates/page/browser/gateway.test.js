// The page behind `rcs-gateway page`, in Chromium. RCS_GATEWAY names the program; without it the tests are skipped.
//
// RCS_PROGRAMS names the directory of the other programs, CHROMIUM the browser, RCS_PICTURES a directory for
// pictures.

import assert from 'node:assert/strict';
import { execFileSync, spawn } from 'node:child_process';
import { existsSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:net';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { after, before, test } from 'node:test';
import { Browser } from './chromium.js';

const PROGRAMS = resolve(process.env.RCS_PROGRAMS ?? 'target/release');
const CHROMIUM = process.env.CHROMIUM ?? 'chromium';
const GATEWAY = process.env.RCS_GATEWAY;
const PICTURES = process.env.RCS_PICTURES;
const skip = GATEWAY ? false : 'RCS_GATEWAY is not set';
const KEYS = resolve(import.meta.dirname, '../../../tools/keys.sh');

/** @type {Browser} */
let browser;
let scratch = '';
let address = '';
let [run, gateway] = [null, null];
const secrets = {};

/** Start a program, and wait until its standard error has a text. */
function start(program, options, text) {
  const started = spawn(program, options, { cwd: scratch });
  let said = '';
  return new Promise((done, fail) => {
    started.once('exit', (code) => fail(new Error(`${program} ends with ${code}: ${said}`)));
    started.stderr.on('data', (part) => {
      said += part;
      if (said.includes(text)) done(started);
    });
  });
}

function freePort() {
  return new Promise((done) => {
    const server = createServer().listen(0, '127.0.0.1', () => {
      const { port } = /** @type {import('node:net').AddressInfo} */ (server.address());
      server.close(() => done(port));
    });
  });
}

before(async () => {
  if (skip) return;
  scratch = mkdtempSync(join(tmpdir(), 'page-gateway-'));
  execFileSync(KEYS, ['keys', 't3', '127.0.0.1', 'unused'], { cwd: scratch, stdio: 'ignore' });
  for (const [name, role] of [
    ['anna', 'operator'],
    ['vera', 'viewer'],
  ]) {
    const added = ['person', 'add', name, '--role', role, '--people', 'people'];
    [secrets[name]] = String(execFileSync(GATEWAY, added, { cwd: scratch })).split('\n');
  }
  const live = ['linkbar', '--clock', 'real', '--overrun', 'count', '--log', 'run.mcap', '--operator', 'network'];
  const options = [...live, '--live', '0', '--live-socket', 'unix:live.sock'];
  run = await start(join(PROGRAMS, 'rcs-run'), options, 'open http');
  const port = await freePort();
  const served = ['page', 't3', `tls/127.0.0.1:${port}`, '--run', 'unix:live.sock'];
  gateway = await start(GATEWAY, [...served, '--keys', 'keys', '--people', 'people'], 'page of t3 at');
  address = `https://127.0.0.1:${port}/`;
  browser = new Browser(CHROMIUM, ['--ignore-certificate-errors']);
});

after(async () => {
  await browser?.close();
  run?.kill('SIGINT');
  gateway?.kill('SIGTERM');
  if (existsSync(scratch)) rmSync(scratch, { recursive: true, force: true });
});

const state = (text) => `document.querySelector('.state b')?.innerText === '${text}'`;

async function picture(page, name) {
  if (PICTURES) writeFileSync(join(PICTURES, `${name}.png`), await page.picture());
}

/** The view in which a person operates; the login does not keep the view of an address. */
const OPERATE = `location.hash = 'view=operate'`;

/** A page in which a person logs in. */
async function logIn(name, secret = secrets[name], size = {}) {
  const page = await browser.open(address, size);
  await page.until(`location.pathname === '/login' && document.querySelector('input[name=secret]')`);
  for (const [field, text] of [
    ['name', name],
    ['secret', secret],
  ]) {
    await page.value(`document.querySelector('input[name=${field}]').focus()`);
    await page.type(text);
  }
  await picture(page, `login-${name}`);
  await page.press('button');
  return page;
}

test('viewer_behind_gateway_sees_the_run_and_no_buttons', { skip }, async () => {
  const page = await logIn('vera');
  await page.until(state('RUNNING'));
  await page.value(OPERATE);
  await page.until(`document.querySelector('#controls')?.innerText.includes('log in as an operator')`);
  assert.equal(await page.value(`document.querySelectorAll('[data-operate], #token').length`), 0);
  await picture(page, 'viewer');
  await page.close();
});

test('operator_behind_gateway_operates_without_a_token_until_logging_out', { skip }, async (t) => {
  const page = await logIn('anna', secrets.anna, { width: 1024, height: 768, touch: true });
  await page.until(state('RUNNING'));
  await page.value(OPERATE);
  await page.until(`document.querySelector('.large.stop')`);
  await page.press('.large.stop');
  await page.until(state('STOPPED'));
  await page.press('.large.go', 900);
  await page.until(state('RUNNING'));
  await page.until(`document.querySelector('#controls').innerText.includes('anna: log out')`);
  await picture(page, 'operator');
  const stopped = [
    ['gateway', gateway],
    ['run', run],
  ];
  for (const [name, process] of stopped) {
    process.kill('SIGSTOP');
    const begin = Date.now();
    await page.until(state('NO CONNECTION'));
    t.diagnostic(`the page has seen the loss of the ${name} after ${Date.now() - begin} ms`);
    await picture(page, `lost-${name}`);
    process.kill('SIGCONT');
    await page.until(state('RUNNING'));
  }
  assert.deepEqual(
    page.errors.filter((error) => !error.includes('favicon')),
    [],
  );
  await page.press('.note a');
  await page.until(`document.querySelector('main')?.innerText.includes('logged in as anna, operator')`);
  await picture(page, 'account');
  await page.press('button');
  await page.until(`document.querySelector('input[name=secret]')`);
  await page.close();
});

test('wrong_secret_is_refused_on_the_login_page', { skip }, async () => {
  const page = await logIn('anna', '0000-0000-0000-0000');
  await page.until(`document.querySelector('[role=alert]')?.innerText === 'Wrong name or secret.'`);
  await picture(page, 'refused');
  await page.close();
});
