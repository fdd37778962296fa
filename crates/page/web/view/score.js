// The table as a score: time runs to the right, and in each tick a bar marks the row that fired.

import { rowsBetween } from '../log/rows.js';
import { context2d } from './dom.js';

/** Space at the left of the score, pixels. */
const MARGIN = 13;
/** Smallest width of a score, pixels. */
const LEAST = 54;

/** Ticks that a score of a width shows. @param {number} width */
export function scoreTicks(width) {
  return width < 150 ? 100 : 200;
}

/**
 * The tick at a place of the score.
 * @param {number} x
 * @param {number} width
 * @param {number} tick the last one
 */
export function scoreTick(x, width, tick) {
  const span = scoreTicks(width);
  return Math.round(tick - span + ((x - MARGIN) / (width - MARGIN - 2)) * span);
}

/**
 * Make the score narrower if the table needs more room than estimated.
 * @param {HTMLElement} pane
 */
export function fitScore(pane) {
  const scroll = /** @type {HTMLElement | null} */ (pane.querySelector('.table-scroll'));
  const excess = scroll ? scroll.scrollWidth - scroll.clientWidth : 0;
  if (!scroll || excess <= 0) return;
  const width = parseFloat(scroll.style.getPropertyValue('--rollw'));
  scroll.style.setProperty('--rollw', `${Math.max(LEAST, width - excess)}px`);
}

/**
 * Paint the score of the table in a pane.
 * @param {import('./ui.js').Context} context
 * @param {HTMLElement} pane
 * @param {string} table
 * @param {boolean} failed
 * @param {Record<string, string>} colour
 */
export function paintScore({ run, ui }, pane, table, failed, colour) {
  const canvas = /** @type {HTMLCanvasElement | null} */ (pane.querySelector('canvas.score'));
  const shown = /** @type {HTMLTableElement | null} */ (pane.querySelector('table.rows'));
  const width = /** @type {HTMLElement | null} */ (shown?.querySelector('th.score-cell'))?.offsetWidth ?? 0;
  if (!canvas || !shown || width === 0) return;
  const height = shown.offsetHeight;
  canvas.style.width = `${width}px`;
  canvas.style.height = `${height}px`;
  const context = context2d(canvas, width, height);
  if (!context) return;
  const places = placesOf(shown);
  const span = scoreTicks(width);
  const x = (/** @type {number} */ tick) => MARGIN + ((tick - ui.tick + span) / span) * (width - MARGIN - 2);
  const top = shown.tHead?.offsetHeight ?? 0;
  context.fillStyle = colour.line;
  for (let second = 0; second <= span / 25; second += width < 150 ? 1 : 2) {
    context.fillRect(Math.round(x(ui.tick - second * 25)), top, 1, height - top);
  }
  for (const { row, start, end, resting } of rowsBetween(
    run.log.series(`/${ui.process}/row`),
    table,
    ui.tick - span,
    ui.tick,
  )) {
    const place = places.get(row);
    if (!place) continue;
    const now = end > ui.tick;
    const left = Math.min(x(start), width - 4);
    const right = Math.max(left + (now ? 3 : 2), x(end));
    const middle = place.top + place.height / 2;
    if (resting) {
      context.fillStyle = colour.t3;
      for (let dot = left; dot < right; dot += 6) context.fillRect(dot, middle - 0.5, 3, 1);
      continue;
    }
    const bar = Math.min(11, Math.max(3, place.height - 9));
    context.fillStyle = now ? (failed ? colour.flt : colour.acc) : colour.t3;
    context.globalAlpha = now ? 1 : 0.55 + (0.4 * (end - ui.tick + span)) / span;
    context.beginPath();
    context.roundRect(
      left,
      middle - bar / 2,
      right - left - (now ? 0 : 0.6),
      bar,
      Math.min(2, (right - left) / 2),
    );
    context.fill();
    context.globalAlpha = 1;
  }
}

/**
 * The places of the rows in the pane. Folded rows share the place of their line.
 * @param {HTMLTableElement} table
 */
function placesOf(table) {
  /** @type {Map<number, { top: number, height: number }>} */
  const places = new Map();
  for (const line of table.querySelectorAll('tr')) {
    if (line.dataset.row)
      places.set(Number(line.dataset.row), { top: line.offsetTop, height: line.offsetHeight });
    const [first, last] = (line.dataset.rows ?? '').split('-').map(Number);
    for (let row = first; row <= last; row++) {
      const height = line.offsetHeight / (last - first + 1);
      places.set(row, { top: line.offsetTop + (row - first) * height, height });
    }
  }
  return places;
}
