// Malicious logs: none of their scripts runs, and the page is never blank.
//
// RCS_PROGRAMS names the directory of the programs, CHROMIUM the browser.

import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { after, before, test } from 'node:test';
import { deflateSync, inflateSync } from 'node:zlib';
import { Browser } from './chromium.js';

const PROGRAMS = resolve(process.env.RCS_PROGRAMS ?? 'target/release');
const MAGIC = 8;
const CODE = { chunk: 0x06, attachment: 0x09 };
const BEGIN = 'id="log-data">';

/** @type {Browser} */
let browser;
let scratch = '';
/** The page of a failed run, and the log inside. */
let [page, log] = ['', Buffer.alloc(0)];

before(() => {
  scratch = mkdtempSync(join(tmpdir(), 'page-hostile-'));
  const file = join(scratch, 'blind.mcap');
  const program = (name, ...options) => spawnSync(join(PROGRAMS, name), options, { cwd: scratch });
  assert.equal(program('rcs-run', 'linkbar', '--faults', 'camera-blind', '--log', file).status, 1);
  assert.equal(program('rcs-log', 'page', file).status, 0);
  page = readFileSync(file.replace('.mcap', '.html'), 'latin1');
  const begin = page.indexOf(BEGIN) + BEGIN.length;
  log = Buffer.from(page.slice(begin, page.indexOf('<', begin)), 'base64');
  browser = new Browser(process.env.CHROMIUM ?? 'chromium');
});

after(async () => {
  await browser.close();
  rmSync(scratch, { recursive: true, force: true });
});

/** The log with changed contents of its chunks and files. */
function changed(change) {
  const parts = [log.subarray(0, MAGIC)];
  const put = (code, body) => {
    const head = Buffer.alloc(9);
    head[0] = code;
    head.writeBigUInt64LE(BigInt(body.length), 1);
    parts.push(head, body);
  };
  const sized = (data, bytes) => {
    const size = Buffer.alloc(8);
    size.writeBigUInt64LE(BigInt(data.length));
    return Buffer.concat([size.subarray(0, bytes), data]);
  };
  for (let at = MAGIC; at + 9 <= log.length - MAGIC;) {
    const code = log[at];
    const body = log.subarray(at + 9, at + 9 + Number(log.readBigUInt64LE(at + 1)));
    at += 9 + body.length;
    if (code === CODE.chunk) {
      // The header has times, size, checksum, and the name of the compression; the data follow.
      const names = 32 + body.readUInt32LE(28);
      const data = change(inflateSync(body.subarray(names + 8)), '');
      const head = Buffer.from(body.subarray(0, names));
      head.writeBigUInt64LE(BigInt(data.length), 16);
      put(code, Buffer.concat([head, sized(deflateSync(data), 8)]));
    } else if (code === CODE.attachment) {
      const type = 20 + body.readUInt32LE(16);
      const start = type + 4 + body.readUInt32LE(type);
      const name = body.toString('utf8', 20, type);
      const data = change(inflateSync(body.subarray(start + 8, body.length - 4)), name);
      put(code, Buffer.concat([body.subarray(0, start), sized(deflateSync(data), 8), Buffer.alloc(4)]));
    } else put(code, body);
  }
  return Buffer.concat([...parts, log.subarray(0, MAGIC)]);
}

/** Replace a text by one of the same length, in arbitrary bytes. */
function replaced(data, from, to) {
  assert.equal(from.length, to.length);
  return Buffer.from(data.toString('latin1').replaceAll(from, to), 'latin1');
}

/** Open a page with another log inside; returns the page when it shows something. */
async function open(name, bytes) {
  const begin = page.indexOf(BEGIN) + BEGIN.length;
  const file = join(scratch, name);
  const text = page.slice(0, begin) + bytes.toString('base64') + page.slice(page.indexOf('<', begin));
  writeFileSync(file, text, 'latin1');
  // The picture is small, because it is drawn without a graphics processor.
  const opened = await browser.open(`file://${file}`, { width: 1200, height: 600 });
  await opened.until(
    `document.querySelector('.state b')?.innerText || document.querySelector('.notice h1')?.innerText`,
  );
  return opened;
}

/** Checks that the page has no element from a text of the log, and that no script of the log has run. */
async function isHarmless(opened) {
  assert.equal(
    await opened.value(`document.querySelectorAll('img[src="x"], script[src], iframe').length`),
    0,
  );
  assert.equal(await opened.value('window.harm ?? 0'), 0);
}

test('html_in_names_of_a_log_stays_text', async () => {
  const bytes = changed((data) => replaced(data, 'LINKBAR1_BH', '<img src=x>'));
  const opened = await open('html.html', bytes);
  for (const view of ['operate', 'explain', 'trace', 'trace&panel=fields', 'trace&panel=messages']) {
    await opened.value(`location.hash = 'view=${view}'`);
    const [name, panel = 'panel=table'] = view.split('&');
    await opened.until(`document.getElementById('app').dataset.view === '${name}'`);
    if (panel !== 'panel=table') await opened.until(`document.querySelector('#table .list')`);
    await opened.until(`document.body.innerText.includes('<img src=x>')`);
    await isHarmless(opened);
  }
  assert.deepEqual(opened.errors, []);
  await opened.close();
});

test('script_in_the_name_of_a_log_does_not_run', async () => {
  const text = '</script><script>harm=1</script><img src=x onerror=harm=1>';
  const opened = await open(
    'script.html',
    changed((data, name) => {
      if (!name.startsWith('why.json')) return data;
      const why = JSON.parse(String(data));
      [why.world.text, why.failure.text, why.failure.causes[0].text] = [text, text, text];
      return Buffer.from(JSON.stringify(why));
    }),
  );
  await opened.until(`document.body.innerText.includes('harm=1')`);
  await isHarmless(opened);
  await opened.close();
});

test('text_of_ten_megabytes_leaves_the_page_usable', async () => {
  const opened = await open(
    'long.html',
    changed((data, name) => {
      if (!name.startsWith('why.json')) return data;
      const why = JSON.parse(String(data));
      why.failure.evidence = ['x'.repeat(10 << 20)];
      return Buffer.from(JSON.stringify(why));
    }),
  );
  await opened.until(`document.querySelector('.state b')?.innerText`);
  await opened.key('1', 'Digit1');
  await opened.until(`document.getElementById('app').dataset.view === 'operate'`);
  assert.deepEqual(opened.errors, []);
  await opened.close();
});

test('numbers_that_are_none_leave_the_page_usable', async () => {
  const one = '\x00\x00\x00\x00\x00\x00\xf0\x3f';
  const opened = await open(
    'nan.html',
    changed((data, name) => (name ? data : replaced(data, one, '\x00\x00\x00\x00\x00\x00\xf8\x7f'))),
  );
  await opened.until(`document.querySelector('.state b')?.innerText === 'PROCESS ERROR'`);
  assert.deepEqual(opened.errors, []);
  await opened.close();
});

test('damaged_log_shows_what_is_wrong', async () => {
  // The lengths in every message with a text are removed.
  const opened = await open(
    'damaged.html',
    changed((data, name) => (name ? data : replaced(data, 'LINKBAR1_BH', '\xff'.repeat(11)))),
  );
  await opened.until(`document.querySelector('.state b')?.innerText`);
  await opened.close();
  const half = await open('half.html', log.subarray(0, log.length / 3));
  await half.until(
    `document.querySelector('.state b')?.innerText || document.querySelector('.notice p')?.innerText`,
  );
  await half.close();
  const other = await open('other.html', Buffer.from('this is not a log'));
  await other.until(
    `document.querySelector('.notice')?.innerText.includes('does not begin as an MCAP file')`,
  );
  await other.close();
});
