// Pointers on the timeline, the score and the cell: drag, pinch and wheel.

import { seconds, duration } from '../log/units.js';
import { seek, zoom } from './actions.js';
import { byId, h, patch, windowSize } from './dom.js';
import { overviewHeight, RULER, Scale, strips } from './timeline.js';
import { scoreTick } from './score.js';
import { wholeRun } from './ui.js';

/** Radians by which the cell turns for a pixel of a drag. */
const TURN = 0.006;

/**
 * Let pointers move time and camera.
 * @param {() => import('./ui.js').Context} contextOf
 * @param {() => import('./cell.js').CellView | null} cellOf
 * @param {() => void} changed
 */
export function followPointers(contextOf, cellOf, changed) {
  dragTimeline(byId('time'), contextOf, changed);
  dragCell(byId('gl'), contextOf, cellOf, changed);
  byId('table').addEventListener('click', (event) => {
    const cell = /** @type {HTMLElement} */ (event.target).closest('td.score-cell');
    if (!cell) return;
    const box = cell.getBoundingClientRect();
    seek(contextOf(), scoreTick(event.clientX - box.left, box.width, contextOf().ui.tick));
    changed();
  });
}

/**
 * @param {HTMLElement} pane
 * @param {() => import('./ui.js').Context} contextOf
 * @param {() => void} changed
 */
function dragTimeline(pane, contextOf, changed) {
  /** @type {Map<number, number>} */
  const pressed = new Map();
  const place = (/** @type {MouseEvent} */ event) => {
    const box = byId('timeline').getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top, width: box.width };
  };
  const move = (/** @type {MouseEvent} */ event) => {
    const context = contextOf();
    const { x, y, width } = place(event);
    const [first, last] = context.ui.window;
    if (y < overviewHeight(context, windowSize())) {
      const whole = wholeRun(context.run);
      const begin = Math.max(
        0,
        Math.min(whole[1] - (last - first), new Scale(whole, width).tick(x) - (last - first) / 2),
      );
      context.ui.window = [begin, begin + last - first];
    } else {
      seek(context, new Scale(context.ui.window, width).tick(x));
    }
    changed();
  };
  pane.addEventListener('pointerdown', (event) => {
    if (/** @type {Element} */ (event.target).id !== 'timeline') return;
    pressed.set(event.pointerId, place(event).x);
    pane.setPointerCapture(event.pointerId);
    if (pressed.size === 1) move(event);
  });
  pane.addEventListener('pointermove', (event) => {
    if (!pressed.has(event.pointerId)) {
      showTip(event, contextOf());
      return;
    }
    const { x, width } = place(event);
    const other = [...pressed].find(([id]) => id !== event.pointerId)?.[1];
    const before = pressed.get(event.pointerId) ?? x;
    pressed.set(event.pointerId, x);
    if (other === undefined) move(event);
    else if (Math.abs(x - other) > 8 && Math.abs(before - other) > 8) {
      const { ui } = contextOf();
      zoom(
        contextOf(),
        Math.abs(before - other) / Math.abs(x - other),
        new Scale(ui.window, width).tick((x + other) / 2),
      );
      changed();
    }
  });
  for (const name of ['pointerup', 'pointercancel']) {
    pane.addEventListener(name, (event) => pressed.delete(/** @type {PointerEvent} */ (event).pointerId));
  }
  pane.addEventListener('pointerleave', () => (byId('tip').hidden = true));
  pane.addEventListener(
    'wheel',
    (event) => {
      if (/** @type {Element} */ (event.target).id !== 'timeline') return;
      event.preventDefault();
      const { x, width } = place(event);
      zoom(contextOf(), event.deltaY > 0 ? 1.2 : 1 / 1.2, new Scale(contextOf().ui.window, width).tick(x));
      changed();
    },
    { passive: false },
  );
}

/**
 * Show a tip about the item under the pointer in the timeline.
 * @param {PointerEvent} event
 * @param {import('./ui.js').Context} context
 */
function showTip(event, context) {
  const tip = byId('tip');
  const canvas = /** @type {HTMLElement} */ (event.target);
  if (canvas.id !== 'timeline') {
    tip.hidden = true;
    return;
  }
  const box = canvas.getBoundingClientRect();
  const scale = new Scale(context.ui.window, box.width);
  const tick = scale.tick(event.clientX - box.left);
  let top = overviewHeight(context, windowSize()) + RULER;
  const strip = strips(context, windowSize()).find((it) => {
    top += it.height + 1;
    return event.clientY - box.top < top && event.clientY - box.top >= top - it.height - 1;
  });
  const bar = strip?.lane?.bars.find((it) => tick >= it.start && tick < it.end);
  const reach = scale.tick(7) - scale.tick(0);
  const found =
    strip?.id === 'events'
      ? context.run.events
          .filter((it) => Math.abs(it.tick - tick) < reach)
          .sort((a, b) => b.weight - a.weight)[0]
      : null;
  tip.hidden = !bar && !found;
  if (bar) {
    const facts = [strip?.name, `tick ${bar.start} to ${bar.done}`, duration(bar.done - bar.start)];
    if (bar.failed) facts.push('failed');
    patch(tip, h('b', {}, bar.text), h('div', {}, facts.join(' · ')));
  } else if (found)
    patch(tip, h('b', {}, `tick ${found.tick} · ${seconds(found.tick)}`), h('div', {}, found.text));
  tip.style.left = `${Math.min(event.clientX + 12, innerWidth - 320)}px`;
  tip.style.top = `${event.clientY - 64}px`;
}

/**
 * @param {HTMLElement} canvas
 * @param {() => import('./ui.js').Context} contextOf
 * @param {() => import('./cell.js').CellView | null} cellOf
 * @param {() => void} changed
 */
function dragCell(canvas, contextOf, cellOf, changed) {
  /** @type {Map<number, [number, number]>} */
  const pressed = new Map();
  const turn = (/** @type {number} */ right, /** @type {number} */ down, /** @type {number} */ nearer) => {
    cellOf()?.move(right, down, nearer);
    contextOf().ui.turned = true;
    changed();
  };
  const spread = () => {
    const [a, b] = [...pressed.values()];
    return Math.hypot(a[0] - b[0], a[1] - b[1]);
  };
  canvas.addEventListener('pointerdown', (event) => {
    pressed.set(event.pointerId, [event.clientX, event.clientY]);
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener('pointermove', (event) => {
    const before = pressed.get(event.pointerId);
    if (!before) return;
    const wide = pressed.size === 2 ? spread() : 0;
    pressed.set(event.pointerId, [event.clientX, event.clientY]);
    if (pressed.size === 2) turn(0, 0, wide / Math.max(1, spread()));
    else turn((event.clientX - before[0]) * TURN, (event.clientY - before[1]) * TURN, 1);
  });
  for (const name of ['pointerup', 'pointercancel']) {
    canvas.addEventListener(name, (event) => pressed.delete(/** @type {PointerEvent} */ (event).pointerId));
  }
  canvas.addEventListener(
    'wheel',
    (event) => {
      event.preventDefault();
      turn(0, 0, event.deltaY > 0 ? 1.08 : 0.93);
    },
    { passive: false },
  );
  canvas.addEventListener('keydown', (event) => {
    const turns = /** @type {Record<string, [number, number]>} */ ({
      ArrowLeft: [-0.1, 0],
      ArrowRight: [0.1, 0],
      ArrowUp: [0, 0.1],
      ArrowDown: [0, -0.1],
    });
    if (!turns[event.key]) return;
    event.preventDefault();
    turn(...turns[event.key], 1);
  });
}
