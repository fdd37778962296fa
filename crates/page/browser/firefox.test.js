// The page of a failed run in Firefox: `node --experimental-websocket --test crates/page/browser`. FIREFOX names
// the browser; without it the test is skipped. The robot is tested only with a display (xvfb-run is enough), because
// without a display Firefox needs a graphics processor for WebGL2.

import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { test } from 'node:test';
import { Firefox } from './firefox.js';

const PROGRAMS = resolve(process.env.RCS_PROGRAMS ?? 'target/release');
const { FIREFOX, DISPLAY } = process.env;
/** An expression: a pixel of the picture of the cell differs from its first one. */
const DRAWN = `(() => {
  const canvas = document.getElementById('gl');
  const copy = Object.assign(document.createElement('canvas'), { width: canvas.width, height: canvas.height });
  const context = copy.getContext('2d');
  context.drawImage(canvas, 0, 0);
  const { data } = context.getImageData(0, 0, copy.width, copy.height);
  return data.some((value, at) => at % 4 === 0 && Math.abs(value - data[0]) > 60);
})()`;

test('failed_log_opens_in_firefox', { skip: FIREFOX ? false : 'FIREFOX is not set' }, async () => {
  const scratch = mkdtempSync(join(tmpdir(), 'page-firefox-'));
  const log = join(scratch, 'blind.mcap');
  const run = (name, ...options) => spawnSync(join(PROGRAMS, name), options, { cwd: scratch });
  assert.equal(run('rcs-run', 'linkbar', '--faults', 'camera-blind', '--log', log).status, 1);
  assert.equal(run('rcs-log', 'page', log).status, 0);
  const firefox = await Firefox.start(FIREFOX);
  await firefox.open(`file://${log.replace('.mcap', '.html')}`, { width: 1200, height: 700 });
  await firefox.until(`document.querySelector('.why')?.innerText.includes('FIRST CAUSE')`);
  assert.match(await firefox.text(`document.querySelector('#table tr.fired').innerText`), /NothingSeen/);
  if (DISPLAY) await firefox.until(DRAWN);
  assert.deepEqual(firefox.errors, []);
  await firefox.close();
  rmSync(scratch, { recursive: true, force: true });
});
