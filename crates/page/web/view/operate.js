// Touches and keys on the controls. A stop acts when it is touched, a go after it was held.

import { completed, completions, effects, KNOB_STEP } from './controls.js';
import { byId } from './dom.js';

/** Time for which a button that moves the robot is held, milliseconds. */
const HOLD = 700;
/** Time between two positions of a dragged knob, milliseconds. */
const KNOB_PAUSE = 120;
/** Distance at which the knob is grasped, percent. */
const GRASP = 10;
/** Buttons that act at once; the others move the robot. */
const AT_ONCE = ['stop', 'pause', 'wait', 'leave'];

/**
 * @typedef {() => import('./ui.js').Context} ContextOf
 * @typedef {keyof import('./controls.js').Effects} Operation
 */

/** Connect the controls with their actions. @param {ContextOf} contextOf @param {() => void} changed */
export function followControls(contextOf, changed) {
  const pane = byId('controls');
  followButtons(pane, contextOf, changed);
  followKnob(pane, contextOf);
  followForms(pane, contextOf, changed);
}

/** Carry out an operation, if it is enabled. @param {import('./ui.js').Context} context @param {Operation} id */
export function operate(context, id) {
  const { line } = effects(context)[id];
  if (line !== null && context.live?.mayOperate) void context.live.ask(line);
}

/** @param {HTMLElement} pane @param {ContextOf} contextOf @param {() => void} changed */
function followButtons(pane, contextOf, changed) {
  let timer = 0;
  const buttonOf = (/** @type {Event} */ event) => {
    const target = /** @type {Element} */ (event.target).closest('[data-operate]');
    return target?.getAttribute('aria-disabled') ? null : /** @type {HTMLElement | null} */ (target);
  };
  const press = (/** @type {HTMLElement} */ button) => {
    const id = /** @type {Operation} */ (button.dataset.operate);
    if (AT_ONCE.includes(id)) return operate(contextOf(), id);
    release();
    contextOf().ui.held = id;
    changed();
    const act = () => {
      release();
      operate(contextOf(), id);
    };
    timer = window.setTimeout(act, HOLD);
  };
  const release = () => {
    clearTimeout(timer);
    if (contextOf().ui.held === null) return;
    contextOf().ui.held = null;
    changed();
  };
  pane.addEventListener('pointerdown', (event) => {
    const button = event.button === 0 ? buttonOf(event) : null;
    if (button) press(button);
  });
  pane.addEventListener('keydown', (event) => {
    if (event.key !== 'Enter' && event.key !== ' ') return;
    const button = buttonOf(event);
    if (!button) return;
    event.preventDefault();
    if (!event.repeat) press(button);
  });
  for (const name of ['pointerup', 'pointercancel', 'keyup', 'blur']) addEventListener(name, release);
}

/** @param {HTMLElement} pane @param {ContextOf} contextOf */
function followKnob(pane, contextOf) {
  let grasped = false;
  let sent = 0;
  /** @type {number | null} */
  let wanted = null;
  const turn = (/** @type {number} */ percent) => {
    const context = contextOf();
    const { line } = effects(context).knob;
    if (line !== null && context.live?.mayOperate) void context.live.ask(`${line} ${percent * 10}`);
  };
  const place = (/** @type {PointerEvent} */ event) => {
    const box = byId('knob').getBoundingClientRect();
    const share = Math.max(0, Math.min(1, (event.clientX - box.left) / box.width));
    return Math.round((share * 100) / KNOB_STEP) * KNOB_STEP;
  };
  const flush = () => {
    if (wanted === null) return;
    sent = performance.now();
    turn(wanted);
    wanted = null;
  };
  const want = (/** @type {number} */ percent) => {
    wanted = percent;
    if (performance.now() - sent > KNOB_PAUSE) flush();
  };
  pane.addEventListener('pointerdown', (event) => {
    const knob = /** @type {Element} */ (event.target).closest('#knob');
    if (!knob || knob.getAttribute('aria-disabled')) return;
    const { run } = contextOf();
    const now = run.knob(run.last);
    const percent = place(event);
    grasped = Math.abs(percent - now) <= GRASP;
    if (percent < now) want(percent);
  });
  addEventListener('pointermove', (event) => {
    if (!grasped) return;
    const { run } = contextOf();
    const percent = place(event);
    if (percent !== (wanted ?? Math.round(run.knob(run.last)))) want(percent);
  });
  for (const name of ['pointerup', 'pointercancel']) {
    addEventListener(name, () => {
      grasped = false;
      flush();
    });
  }
  pane.addEventListener('keydown', (event) => {
    if (/** @type {Element} */ (event.target).id !== 'knob') return;
    const steps = /** @type {Record<string, number>} */ ({
      ArrowLeft: -1,
      ArrowDown: -1,
      ArrowRight: 1,
      ArrowUp: 1,
    });
    if (!(event.key in steps)) return;
    event.preventDefault();
    const { run } = contextOf();
    const percent = Math.round(run.knob(run.last)) + steps[event.key] * KNOB_STEP;
    turn(Math.max(0, Math.min(100, percent)));
  });
}

/** @param {HTMLElement} pane @param {ContextOf} contextOf @param {() => void} changed */
function followForms(pane, contextOf, changed) {
  const field = (/** @type {string} */ id) => /** @type {HTMLInputElement} */ (byId(id));
  pane.addEventListener('submit', (event) => {
    event.preventDefault();
    const { live, ui } = contextOf();
    if (!live) return;
    const form = /** @type {Element} */ (event.target);
    if (form.id === 'token-form') return live.authorize(field('token').value);
    const line = field('line').value.trim();
    if (line !== '' && live.mayOperate) live.type(line);
    [field('line').value, ui.typed] = ['', ''];
    changed();
  });
  pane.addEventListener('input', (event) => {
    const input = /** @type {HTMLInputElement} */ (event.target);
    if (input.id === 'line') contextOf().ui.typed = input.value;
    changed();
  });
  pane.addEventListener('keydown', (event) => {
    const input = /** @type {HTMLInputElement} */ (event.target);
    if (input.id !== 'line') return;
    const { live, ui, run } = contextOf();
    if (event.key === 'Tab' && input.value !== '') {
      const full = completed(input.value, completions(input.value, run.words));
      // Without a completion the Tab key leaves the field, as usual.
      if (full === input.value) return;
      [input.value, ui.typed] = [full, full];
    } else if (event.key === 'ArrowUp' || event.key === 'ArrowDown') {
      const typed = live?.typed ?? [];
      const at = typed.indexOf(input.value);
      const next =
        event.key === 'ArrowUp' ? (at < 0 ? typed.length : at) - 1 : at < 0 ? typed.length : at + 1;
      if (next < 0) return;
      input.value = typed[next] ?? '';
      ui.typed = '';
    } else return;
    event.preventDefault();
    changed();
  });
}
