// Finds the log or the run that the page shows, or asks for a log.

import { byId, h, patch } from './dom.js';

/** Show an error in the middle of the page. @param {unknown} error */
export function fail(error) {
  const start = byId('start');
  start.hidden = false;
  const text = error instanceof Error ? error.message : String(error);
  patch(
    start,
    h(
      'div',
      { class: 'notice', role: 'alert' },
      h('h1', {}, 'The page has failed'),
      h('p', {}, text),
      h('p', {}, 'Reload it. If it shows a run, the robot may still be moving.'),
    ),
  );
}

/** Ask for a log. @param {(name: string, bytes: Uint8Array) => Promise<void>} show */
export function ask(show) {
  const start = byId('start');
  start.hidden = false;
  patch(
    start,
    h(
      'div',
      { class: 'notice' },
      h('h1', {}, 'No log is open'),
      h('p', {}, 'Drop a log here, or choose one. It stays on this machine.'),
      h('input', {
        type: 'file',
        accept: '.mcap',
        id: 'choose',
        'aria-label': 'a log, a file that ends with .mcap',
      }),
      h('p', { class: 'dim' }, 'rcs-log page LOG -o run.html writes a page with the log inside.'),
    ),
  );
  const take = async (/** @type {File | undefined} */ file) => {
    if (file) await show(file.name, new Uint8Array(await file.arrayBuffer())).catch(fail);
  };
  byId('choose').addEventListener('change', (event) =>
    take(/** @type {HTMLInputElement} */ (event.target).files?.[0]),
  );
  addEventListener('dragover', (event) => event.preventDefault());
  addEventListener('drop', (event) => {
    event.preventDefault();
    void take(event.dataTransfer?.files[0]);
  });
}

/**
 * The data that the page shows.
 * @typedef {{ name: string, bytes: Uint8Array, isLive: boolean }} Found `isLive`: the bytes are the start of a run
 */

/** The bytes inside the page; null if there are none. @param {string} id @returns {Uint8Array | null} */
function inside(id) {
  const element = document.getElementById(id);
  if (!element) return null;
  const text = atob(element.textContent ?? '');
  element.remove();
  const bytes = new Uint8Array(text.length);
  for (let at = 0; at < text.length; at++) bytes[at] = text.charCodeAt(at);
  return bytes;
}

/**
 * The log or the run inside the page, or the log of the address (`?log=run.mcap`); null if there is none.
 * @returns {Promise<Found | null>}
 */
export async function find() {
  const name = document.title;
  const [log, run] = [inside('log-data'), inside('run-data')];
  if (log) return { name, bytes: log, isLive: false };
  if (run) return { name, bytes: run, isLive: true };
  const address = new URLSearchParams(location.search).get('log');
  if (!address) return null;
  const url = new URL(address, location.href);
  if (url.origin !== location.origin)
    throw new Error(`The log is at ${url.origin}: only a log of ${location.origin} is opened.`);
  const answer = await fetch(url);
  if (!answer.ok) throw new Error(`${address}: the server answers ${answer.status} ${answer.statusText}.`);
  const bytes = new Uint8Array(await answer.arrayBuffer());
  return { name: address.split('/').at(-1) ?? address, bytes, isLive: false };
}
