#!/usr/bin/env node
// Makes the pictures of the documentation that show the cell or the page, and the example page.
//
//     node viewers/pictures.js             makes those whose inputs have changed
//     node viewers/pictures.js NAME...     makes these
//     node viewers/pictures.js --check     lists those whose inputs have changed; fails if there are any
//
// It needs Node and Chromium, and a release build. RCS_PROGRAMS names the directory of the programs, CHROMIUM the
// browser. A picture is current if the digest of its inputs is the one in viewers/pictures.txt; its inputs are the page,
// this program, and the job with what it did when its golden was made.

import { spawnSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { existsSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { Browser } from '../crates/page/browser/chromium.js';

const ROOT = resolve(dirname(fileURLToPath(import.meta.url)), '..');
const PROGRAMS = resolve(process.env.RCS_PROGRAMS ?? join(ROOT, 'target/release'));
const DIGESTS = join(ROOT, 'viewers/pictures.txt');
/** Size of a moment on a sheet, pixels. */
const MOMENT = { width: 350, height: 300, columns: 3 };
/** Quality of WebP, up to 100. */
const QUALITY = 50;

/**
 * Ticks of the film and the time for which each is shown, milliseconds; then the view changes.
 * @type {{ hash: string, shots: [number, number][] }[]}
 */
const FILM = [
  {
    hash: 'view=explain&camera=place&process=emove&theme=dark',
    shots: [...steps(500, 604, 8, 110), ...steps(606, 622, 2, 220), [622, 300], [623, 2200]],
  },
  { hash: 'view=trace&camera=place&process=emove&theme=dark', shots: [[623, 4000]] },
];

/**
 * @typedef {object} Drawing
 * @property {string} job
 * @property {string} [faults]
 * @property {string} golden whose text says what the run does
 * @property {(made: Studio, page: string) => Promise<Buffer>} make
 *
 * @type {Record<string, Drawing>}
 */
const PICTURES = {
  'docs/example.html': blind(async (_, page) => readFileSync(page)),
  'docs/page.webp': blind((studio, page) => studio.film(page, FILM, { width: 1280, height: 900 })),
  'docs/page.png': blind((studio, page) => studio.picture(page, 'theme=light', { width: 1440, height: 900 })),
  'docs/cell.png': job('linkbar', (studio, page) =>
    studio.picture(page, 'view=operate&t=2490&theme=light', { width: 1440, height: 760 }, '#stage'),
  ),
  'docs/linkbar.png': sheet('linkbar', [
    [760, 'the second picture is taken'],
    [1335, 'the blank is grasped in sector 4'],
    [2490, 'over the ledge of the vise'],
    [2545, 'released, fallen onto the ledge'],
    [3416, 'pushed against the back'],
    [5505, 'the linkbar is released in sector 1'],
  ]),
  'docs/clevis.png': sheet('clevis', [
    [1305, 'the blank is grasped in sector 3'],
    [3420, 'pushed to its seat'],
    [5430, "the pedestal's hand has it"],
    [6120, 'turned by 180 degrees, it is grasped anew'],
    [6960, 'half done, back in the vise'],
    [10130, 'the clevis is released in sector 2'],
  ]),
  // From the side on which the drum is open.
  'docs/tool-change.png': sheet(
    'tool-change',
    [
      [940, 'GRIPPER-1 is left in its holster'],
      [1680, 'GRIPPER-3 is locked on, and out'],
      [2985, 'DRILL-2 is gripped in the drum'],
      [3380, 'pulled out, past the strike plate'],
      [6340, 'ENDMILL-1 is inserted'],
      [6900, 'released'],
    ],
    [...Array(10).fill('ArrowRight'), 'ArrowUp', 'ArrowUp'],
  ),
};

/** @param {string} name @param {Drawing['make']} make @returns {Drawing} */
function job(name, make) {
  return { job: name, golden: name, make };
}

/** A run that fails since the camera is blind. @param {Drawing['make']} make @returns {Drawing} */
function blind(make) {
  return { job: 'linkbar', faults: 'camera-blind', golden: 'camera-blind', make };
}

/**
 * @param {string} name
 * @param {[number, string][]} moments
 * @param {string[]} [turns] keys that turn the camera
 * @returns {Drawing}
 */
function sheet(name, moments, turns = []) {
  return job(name, (studio, page) => studio.sheet(page, moments, turns));
}

/** @param {number} from @param {number} to @param {number} step @param {number} time @returns {[number, number][]} */
function steps(from, to, step, time) {
  return Array.from({ length: Math.floor((to - from) / step) + 1 }, (_, index) => [
    from + index * step,
    time,
  ]);
}

/** The browser, and a directory for logs and pages. */
class Studio {
  constructor() {
    this.browser = new Browser(process.env.CHROMIUM ?? 'chromium');
    this.scratch = mkdtempSync(join(tmpdir(), 'pictures-'));
    /** @type {Map<string, string>} Pages by job and faults. */
    this.pages = new Map();
  }

  /** The page of a run. @param {Drawing} drawing */
  page({ job: name, faults = '' }) {
    const key = `${name}${faults && '-'}${faults}`;
    const known = this.pages.get(key);
    if (known) return known;
    const [log, page] = [join(this.scratch, `${key}.mcap`), join(this.scratch, `${key}.html`)];
    run('rcs-run', [name, '--log', log, ...(faults ? ['--faults', faults] : [])], faults ? 1 : 0);
    run('rcs-log', ['page', log, '-o', page], 0);
    this.pages.set(key, page);
    return page;
  }

  /** A page that shows its picture. @param {string} file @param {string} hash @param {object} size */
  async open(file, hash, size) {
    const page = await this.browser.open(`file://${file}#${hash}`, size);
    await page.until(`document.getElementById('app')?.getAttribute('aria-busy') === 'false'`);
    await this.still(page);
    return page;
  }

  /** Wait until the picture of the cell changes no more. @param {any} page */
  async still(page) {
    const look = () =>
      page.value(`new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() =>
      done(document.getElementById('gl').toDataURL()))))`);
    for (let [before, now] = ['', await look()]; before !== now; [before, now] = [now, await look()]);
  }

  /** @param {string} file @param {string} hash @param {object} size @param {string} [part] selector; all without it */
  async picture(file, hash, size, part) {
    const page = await this.open(file, hash, size);
    const clip = part && { ...(await boxOf(page, part)), scale: 1 };
    const { data } = await page.call('Page.captureScreenshot', { format: 'png', clip });
    await page.close();
    return Buffer.from(data, 'base64');
  }

  /** @param {string} file @param {typeof FILM} scenes @param {{ width: number, height: number }} size */
  async film(file, scenes, size) {
    const frames = [];
    const page = await this.open(file, scenes[0].hash, size);
    for (const { hash, shots } of scenes) {
      for (const [tick, time] of shots) {
        await page.value(`location.hash = ${JSON.stringify(`${hash}&t=${tick}`)}`);
        await this.still(page);
        const { data } = await page.call('Page.captureScreenshot', { format: 'webp', quality: QUALITY });
        frames.push({ image: Buffer.from(data, 'base64'), time });
      }
    }
    await page.close();
    return animated(frames, size);
  }

  /**
   * Moments of a run beside each other, with captions.
   * @param {string} file
   * @param {[number, string][]} moments
   * @param {string[]} turns
   */
  async sheet(file, moments, turns) {
    const { width, height, columns } = MOMENT;
    const page = await this.open(file, 'view=operate&theme=light', { width: 1200, height: 800 });
    await page.value(`document.getElementById('gl').focus()`);
    for (const key of turns) await page.key(key);
    const cells = [];
    for (const [tick, text] of moments) {
      await page.value(`location.hash = 'view=operate&theme=light&camera=gripper&t=${tick}'`);
      await this.still(page);
      const image = await page.value(`document.getElementById('gl').toDataURL()`);
      const caption = `${(tick * 0.04).toFixed(1)} s: ${text}`;
      cells.push(`<figure><img src="${image}"><figcaption>${caption}</figcaption></figure>`);
    }
    await page.close();
    const written = join(this.scratch, 'sheet.html');
    const style = `body { margin: 0; display: grid; grid-template-columns: repeat(${columns}, ${width}px); font: 13px sans-serif }
      figure { margin: 0; height: ${height}px; display: flex; flex-direction: column }
      img { width: 100%; flex: 1; min-height: 0; object-fit: cover }
      figcaption { background: #181e24; color: #fafaf8; padding: 6px 10px }`;
    writeFileSync(written, `<!doctype html><meta charset="utf-8"><style>${style}</style>${cells.join('')}`);
    const rows = Math.ceil(cells.length / columns);
    const sheet = await this.browser.open(`file://${written}`, {
      width: width * columns,
      height: height * rows,
    });
    await sheet.until(
      `document.images.length === ${cells.length} && [...document.images].every((it) => it.complete)`,
    );
    const picture = await sheet.picture();
    await sheet.close();
    return picture;
  }

  async close() {
    await this.browser.close();
    rmSync(this.scratch, { recursive: true, force: true });
  }
}

/** @param {any} page @param {string} selector */
function boxOf(page, selector) {
  return page.value(`(() => {
    const { x, y, width, height } = document.querySelector(${JSON.stringify(selector)}).getBoundingClientRect();
    return { x, y, width, height };
  })()`);
}

/** @param {string} program @param {string[]} options @param {number} expected exit status */
function run(program, options, expected) {
  const { status, stderr, error } = spawnSync(join(PROGRAMS, program), options, { cwd: ROOT });
  if (status !== expected)
    throw new Error(`${program} ${options.join(' ')} ends with ${status}: ${error ?? stderr}`);
}

/**
 * An animated WebP of single pictures (RFC 9649, section 2.7).
 * @param {{ image: Buffer, time: number }[]} frames
 * @param {{ width: number, height: number }} size
 */
function animated(frames, { width, height }) {
  const u24 = (/** @type {number} */ value) => [value & 255, (value >> 8) & 255, value >> 16];
  const chunk = (/** @type {string} */ name, /** @type {Uint8Array} */ body) => {
    const head = Buffer.alloc(8);
    head.write(name, 'latin1');
    head.writeUInt32LE(body.length, 4);
    return Buffer.concat([head, body, Buffer.alloc(body.length % 2)]);
  };
  const animation = 2;
  const head = chunk('VP8X', Buffer.from([animation, 0, 0, 0, ...u24(width - 1), ...u24(height - 1)]));
  // The background, and that the film repeats for ever.
  const anim = chunk('ANIM', Buffer.from([0, 0, 0, 0, 0, 0]));
  const replaces = 2;
  const parts = frames.map(({ image, time }) => {
    const place = [...u24(0), ...u24(0), ...u24(width - 1), ...u24(height - 1), ...u24(time), replaces];
    return chunk('ANMF', Buffer.concat([Buffer.from(place), ...bitstream(image)]));
  });
  const body = Buffer.concat([Buffer.from('WEBP', 'latin1'), head, anim, ...parts]);
  const riff = Buffer.alloc(8);
  riff.write('RIFF', 'latin1');
  riff.writeUInt32LE(body.length, 4);
  return Buffer.concat([riff, body]);
}

/** The chunks of a single picture that an animation takes. @param {Buffer} image @returns {Buffer[]} */
function bitstream(image) {
  const found = [];
  for (let at = 12; at + 8 <= image.length;) {
    const end = at + 8 + image.readUInt32LE(at + 4);
    const padded = end + (end % 2);
    if (['ALPH', 'VP8 ', 'VP8L'].includes(image.toString('latin1', at, at + 4)))
      found.push(image.subarray(at, padded));
    at = padded;
  }
  return found;
}

/** Files below a directory, but for the tests, sorted. @param {string} directory @returns {string[]} */
function filesOf(directory) {
  const entries = readdirSync(join(ROOT, directory), { recursive: true, withFileTypes: true });
  const files = entries.filter((it) => it.isFile() && !it.name.endsWith('.test.js'));
  return files.map((it) => join(it.parentPath ?? it.path, it.name)).sort();
}

/** The digest of the inputs of a picture. @param {Drawing} drawing */
function digestOf({ job: name, faults, golden }) {
  const inputs = [
    ...filesOf('crates/page/web'),
    ...['viewers/pictures.js', 'data/cell.toml', `data/jobs/${name}.job`, `tests/goldens/${golden}.txt`],
    ...(faults ? [`data/faults/${faults}.toml`] : []),
  ];
  const hash = createHash('sha256');
  for (const input of inputs) hash.update(readFileSync(resolve(ROOT, input)));
  return hash.digest('hex').slice(0, 16);
}

/** The digests of the pictures as they were made, by name. @returns {Map<string, string>} */
function known() {
  const text = existsSync(DIGESTS) ? readFileSync(DIGESTS, 'utf8') : '';
  return new Map(
    text
      .split('\n')
      .filter(Boolean)
      .map((line) => /** @type {[string, string]} */ (line.split(' '))),
  );
}

async function main() {
  const names = process.argv.slice(2);
  const digests = known();
  const isStale = (/** @type {string} */ name) =>
    digests.get(name) !== digestOf(PICTURES[name]) || !existsSync(join(ROOT, name));
  const stale = Object.keys(PICTURES).filter(isStale);
  if (names[0] === '--check') {
    for (const name of stale)
      console.log(`${name} is older than its inputs: node viewers/pictures.js ${name}`);
    process.exitCode = stale.length > 0 ? 1 : 0;
    return;
  }
  const unknown = names.find((name) => !PICTURES[name]);
  if (unknown) throw new Error(`no picture ${unknown}; there are ${Object.keys(PICTURES).join(', ')}`);
  const studio = new Studio();
  try {
    for (const name of names.length > 0 ? names : stale) {
      const drawing = PICTURES[name];
      const bytes = await drawing.make(studio, studio.page(drawing));
      writeFileSync(join(ROOT, name), bytes);
      digests.set(name, digestOf(drawing));
      writeFileSync(
        DIGESTS,
        [...digests]
          .sort()
          .map(([key, digest]) => `${key} ${digest}\n`)
          .join(''),
      );
      console.log(`${name} ${bytes.length} bytes`);
    }
  } finally {
    await studio.close();
  }
}

await main();
