// Paints the timeline: overview, ruler, bars, events, curves, and the flag of the present tick.

import { seconds } from '../log/units.js';
import { context2d } from './dom.js';
import { overviewHeight, RULER, Scale, strips } from './timeline.js';
import { wholeRun } from './ui.js';

/** Greatest values of the curves: in/s, and lb. */
const MOST = { speed: 14, force: 50 };

/** @type {Record<string, string>} Names of the colours of the kinds of commands. */
const KIND = { move: 'k-move', hand: 'k-hand', look: 'k-look', change: 'k-chg', pause: 'k-pau' };

/**
 * @typedef {{ line: string, fill: string, ink: string }} Look colours
 * @typedef {{ x: number, text: string, look: Look, left: number, width: number }} Flag
 */

/** The part of the picture that does not depend on the present tick, painted once. */
const still = { canvas: document.createElement('canvas'), key: '' };

/**
 * @param {import('./ui.js').Context} context
 * @param {HTMLCanvasElement} canvas
 * @param {import('./dom.js').Size} size
 * @param {Record<string, string>} colour
 */
export function paintTimeline(context, canvas, size, colour) {
  const { run, ui } = context;
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  const painter = context2d(canvas, width, height);
  if (!painter || width === 0) return;
  const overview = overviewHeight(context, size);
  const key = [
    width,
    height,
    canvas.width,
    ui.window,
    ui.view,
    ui.theme,
    size,
    run.last,
    run.lines.length,
  ].join();
  if (key !== still.key) {
    still.key = key;
    const below = context2d(still.canvas, width, height);
    if (below) paintStill(new Painter(context, below, new Scale(ui.window, width), height, colour), size);
  }
  painter.drawImage(still.canvas, 0, 0, width, height);
  const paint = new Painter(context, painter, new Scale(ui.window, width), height, colour);
  if (overview) paint.present(overview);
  const flags = paint.flags();
  paint.ruler(overview, flags);
  paint.paintFlags(flags, overview);
}

/** @param {Painter} paint @param {import('./dom.js').Size} size */
function paintStill(paint, size) {
  const { context, to, colour, scale } = paint;
  const overview = overviewHeight(context, size);
  if (overview) paint.overview(overview);
  paint.seconds(overview);
  let top = overview + RULER;
  for (const strip of strips(context, size)) {
    to.fillStyle = colour.line;
    to.fillRect(0, top + strip.height, scale.width, 1);
    if (strip.lane) paint.lane(strip.lane, top, strip.height);
    else if (strip.id === 'events') paint.events(top + strip.height / 2);
    else paint.curve(strip.id, top, strip.height);
    top += strip.height + 1;
  }
}

class Painter {
  /**
   * @param {import('./ui.js').Context} context @param {CanvasRenderingContext2D} to @param {Scale} scale
   * @param {number} height @param {Record<string, string>} colour
   */
  constructor(context, to, scale, height, colour) {
    this.context = context;
    this.run = context.run;
    this.ui = context.ui;
    this.to = to;
    to.textBaseline = 'middle';
    this.scale = scale;
    this.height = height;
    this.colour = colour;
    this.font = (/** @type {number} */ weight, size = 11) => `${weight} ${size}px ${colour.sans}`;
  }

  /** The whole run with the window. @param {number} height */
  overview(height) {
    const { run, ui, to, colour, scale } = this;
    const all = new Scale(wholeRun(run), scale.width);
    const [top, inner] = [3, height - 8];
    to.fillStyle = colour.raise;
    to.fillRect(0, top, scale.width, inner);
    for (const bar of run.lanes[0].bars) {
      const left = all.x(bar.start);
      this.block(bar.kind, left, top + 2, Math.max(1, all.x(bar.end) - 1 - left), inner - 4);
    }
    for (const event of run.events.filter((it) => it.weight >= 3)) {
      to.fillStyle = event.weight >= 5 ? colour.flt : colour.pau;
      to.fillRect(all.x(event.tick) - 0.75, top, 1.5, inner);
    }
    const [left, right] = ui.window.map((tick) => Math.max(0, Math.min(scale.width, all.x(tick))));
    to.fillStyle = colour.bg;
    to.globalAlpha = 0.62;
    to.fillRect(0, top, left, inner);
    to.fillRect(right, top, scale.width - right, inner);
    to.globalAlpha = 1;
    to.strokeStyle = colour.t2;
    to.lineWidth = 1;
    to.strokeRect(Math.round(left) + 0.5, top + 0.5, Math.max(3, Math.round(right - left) - 1), inner - 1);
  }

  /** The present tick in the overview. @param {number} height */
  present(height) {
    const { run, ui, to, colour, scale } = this;
    const x = new Scale(wholeRun(run), scale.width).x(ui.tick);
    to.fillStyle = colour.acc;
    to.fillRect(x - 1, 1, 2, height - 4);
  }

  /** Lines at the marks of the ruler. @param {number} top */
  seconds(top) {
    this.to.fillStyle = this.colour.line;
    for (const [x] of this.scale.marks()) this.to.fillRect(x, top + RULER - 2, 1, this.height);
  }

  /** @param {number} top @param {Flag[]} flags that cover times */
  ruler(top, flags) {
    const { to, scale, colour } = this;
    to.font = this.font(400);
    to.fillStyle = colour.t3;
    for (const [x, text] of this.scale.marks()) {
      const [left, right] = [x + 4, x + 4 + to.measureText(text).width];
      const covered = flags.some((flag) => left < flag.left + flag.width + 3 && right > flag.left - 3);
      if (right < scale.width && !covered) to.fillText(text, left, top + RULER / 2);
    }
  }

  /** @param {import('../log/lanes.js').Lane} lane @param {number} top @param {number} height */
  lane(lane, top, height) {
    const { to, scale, colour } = this;
    for (const bar of lane.bars) {
      if (bar.end < scale.first || bar.start > scale.last) continue;
      const left = Math.max(-2, scale.x(bar.start));
      const done = Math.min(scale.width + 2, scale.x(bar.done));
      const right = Math.min(scale.width + 2, scale.x(bar.end));
      const gap = right - left > 5 ? 1 : 0.35;
      this.block(bar.kind, left, top + 2, Math.max(0.8, done - left - gap), height - 3);
      // A thin line shows the wait from the end of a command to the next one.
      if (right - done > 1.5 && bar.kind !== 'pause') {
        to.fillStyle = colour[KIND[bar.kind]];
        to.fillRect(done, top + height / 2 - 1, right - done - gap, 2);
      }
      if (done - left > 26)
        this.label(bar, Math.max(left, 0) + 5, Math.min(done, scale.width) - 4, top, height);
      if (bar.failed) {
        to.fillStyle = colour.flt;
        to.fillRect(done - 3, top + 2, 3, height - 3);
      }
    }
  }

  /**
   * The verb of a command if it fits, and as much of the rest as fits.
   * @param {import('../log/lanes.js').Bar} bar
   * @param {number} left
   * @param {number} right
   * @param {number} top
   * @param {number} height
   */
  label(bar, left, right, top, height) {
    const { to, colour } = this;
    const space = bar.text.indexOf(' ');
    const verb = space < 0 ? bar.text : bar.text.slice(0, space);
    to.font = this.font(500);
    const width = to.measureText(verb).width;
    if (width > right - left + 3) return;
    to.fillStyle = colour[`${KIND[bar.kind]}-t`];
    const middle = top + height / 2 + 0.5;
    to.fillText(verb, left, middle);
    to.font = this.font(400);
    const rest = fitted(to, space < 0 ? '' : bar.text.slice(space), right - left - width);
    to.globalAlpha = 0.75;
    to.fillText(rest, left + width, middle);
    to.globalAlpha = 1;
  }

  /**
   * A bar whose kind shows in colour and in a mark.
   * @param {string} kind
   * @param {number} left
   * @param {number} top
   * @param {number} width
   * @param {number} height
   */
  block(kind, left, top, width, height) {
    const { to, colour } = this;
    const name = KIND[kind];
    to.fillStyle = colour[name];
    to.beginPath();
    to.roundRect(left, top, width, height, Math.min(2.5, width / 2));
    to.fill();
    if (width < 3) return;
    to.strokeStyle = kind === 'pause' ? colour.line2 : colour[`${name}-t`];
    to.fillStyle = to.strokeStyle;
    to.lineWidth = 1;
    to.globalAlpha = kind === 'pause' ? 1 : 0.38;
    if (kind === 'hand') to.fillRect(left, top, width, 2);
    if (kind === 'change') to.fillRect(left, top + height - 2, width, 2);
    if (kind === 'look') {
      to.setLineDash([2, 2]);
      to.strokeRect(left + 0.5, top + 0.5, Math.max(0, width - 1), height - 1);
      to.setLineDash([]);
    }
    if (kind === 'pause') this.hatch(left, top, width, height);
    to.globalAlpha = 1;
  }

  /** @param {number} left @param {number} top @param {number} width @param {number} height */
  hatch(left, top, width, height) {
    const { to } = this;
    to.save();
    to.beginPath();
    to.rect(left, top, width, height);
    to.clip();
    to.beginPath();
    for (let x = Math.floor(left / 6) * 6 - height; x < left + width; x += 6) {
      to.moveTo(x, top + height);
      to.lineTo(x + height, top);
    }
    to.stroke();
    to.restore();
  }

  /** The events. Where several are close together, only the gravest is painted. @param {number} y */
  events(y) {
    const { run, scale } = this;
    /** @type {number[]} */
    const used = [];
    for (const event of [...run.events].sort((a, b) => b.weight - a.weight)) {
      const x = scale.x(event.tick);
      if (x < 0 || x > scale.width || used.some((it) => Math.abs(it - x) < 8)) continue;
      used.push(x);
      this.glyph(event.kind, x, y);
    }
  }

  /** @param {import('../log/run.js').EventKind} kind @param {number} x @param {number} y */
  glyph(kind, x, y) {
    const { to, colour } = this;
    const draw = (/** @type {string} */ path, /** @type {string} */ name, /** @type {boolean} */ filled) => {
      to.fillStyle = colour[name];
      to.strokeStyle = colour[name];
      to.lineWidth = 1.6;
      if (filled) to.fill(new Path2D(path));
      else to.stroke(new Path2D(path));
    };
    to.save();
    to.translate(x, y);
    if (kind === 'error') draw('M0-5.5 5.5 0 0 5.5-5.5 0z', 'flt', true);
    else if (kind === 'contact') draw('M-3.6 0a3.6 3.6 0 1 0 7.2 0a3.6 3.6 0 1 0-7.2 0', 'flt', true);
    else if (kind === 'warning') draw('M0-4.5 5 4-5 4z', 'pau', false);
    else if (kind === 'fault') draw('M-3 6V-5L5-2.5-3 0', 'pau', false);
    else if (kind === 'camera')
      draw('M-4-3H4V3.5H-4zM-1.5 0a1.5 1.5 0 1 0 3 0a1.5 1.5 0 1 0-3 0', 'k-look-t', false);
    else draw('M-2-2a2 2 0 1 0 4 0a2 2 0 1 0-4 0M-4 5Q0-1 4 5', 'acc', false);
    to.restore();
  }

  /**
   * Speed of the tool point, or forces of the fingers.
   * @param {string} id
   * @param {number} top
   * @param {number} height
   */
  curve(id, top, height) {
    const { run, colour } = this;
    if (id === 'speed') {
      this.line(run.speeds, MOST.speed, top, height, colour.t2, 1);
      return;
    }
    for (const [side, stroke] of /** @type {const} */ ([
      ['left', 'k-hand-t'],
      ['right', 't3'],
    ])) {
      this.line(
        run.forces.map((force) => ({ tick: force.tick, value: force[side] })),
        MOST.force,
        top,
        height,
        colour[stroke],
        Infinity,
      );
    }
  }

  /**
   * @param {{ tick: number, value: number }[]} points
   * @param {number} most
   * @param {number} top
   * @param {number} height
   * @param {string} stroke @param {number} hold ticks for which a value holds; after them it is 0
   */
  line(points, most, top, height, stroke, hold) {
    const { to, scale, run } = this;
    const y = (/** @type {number} */ value) => top + height - 2 - Math.min(1, value / most) * (height - 6);
    const clip = (/** @type {number} */ tick) => Math.max(-2, Math.min(scale.width + 2, scale.x(tick)));
    to.strokeStyle = stroke;
    to.lineWidth = 1.2;
    to.beginPath();
    to.moveTo(clip(0), y(0));
    // Only the greatest value in a pixel is drawn, because a run of 20 minutes has 25 values in each.
    let [drawn, peak] = [-Infinity, 0];
    points.forEach(({ tick, value }, index) => {
      const next = points[index + 1]?.tick ?? run.last;
      if (next < scale.first || tick > scale.last) return;
      peak = Math.max(peak, value);
      const x = clip(tick);
      if (x - drawn < 0.6 && next - tick <= hold && hold !== Infinity) return;
      to.lineTo(x, y(hold === Infinity ? value : peak));
      [drawn, peak] = [x, 0];
      if (next - tick > hold) {
        to.lineTo(clip(tick + hold), y(0));
        to.lineTo(clip(next - 1), y(0));
      } else if (hold === Infinity) to.lineTo(clip(next), y(value));
    });
    to.stroke();
  }

  /**
   * The flags of the first cause and of the present tick, where there is room for them.
   * @returns {Flag[]}
   */
  flags() {
    const { run, ui, scale, colour } = this;
    const now = scale.x(ui.tick);
    const red = { line: colour.flt, fill: colour['flt-bg'], ink: colour['on-flt'] };
    const blue = { line: colour.acc, fill: colour.acc, ink: colour['on-acc'] };
    if (run.cause?.tick === ui.tick) return [this.flag(now, `first cause · ${seconds(ui.tick)}`, red, 0)];
    const cause = run.cause ? scale.x(run.cause.tick) : -Infinity;
    if (!run.cause || cause < -9 || cause > scale.width + 9)
      return [this.flag(now, seconds(ui.tick), blue, 0)];
    const side = Math.abs(now - cause) < 74 ? Math.sign(ui.tick - run.cause.tick) : 0;
    return [this.flag(cause, 'first cause', red, -side), this.flag(now, seconds(ui.tick), blue, side)];
  }

  /**
   * @param {number} x
   * @param {string} text
   * @param {Look} look
   * @param {number} side of the line: -1 left of it, 1 right of it
   * @returns {Flag}
   */
  flag(x, text, look, side) {
    const { to, scale } = this;
    to.font = this.font(600, 10.5);
    const width = to.measureText(text).width + 12;
    const left = side < 0 ? x - width : side > 0 ? x : x - width / 2;
    return { x, text, look, width, left: Math.max(2, Math.min(scale.width - width - 2, left)) };
  }

  /** @param {Flag[]} flags @param {number} top */
  paintFlags(flags, top) {
    const { to } = this;
    to.font = this.font(600, 10.5);
    for (const { x, text, look, width, left } of flags) {
      to.fillStyle = look.line;
      to.fillRect(x - 0.75, top + RULER - 4, 1.5, this.height);
      to.fillStyle = look.fill;
      to.beginPath();
      to.roundRect(left, top + 2, width, RULER - 5, 3);
      to.fill();
      to.fillStyle = look.ink;
      to.fillText(text, left + 6, top + RULER / 2);
    }
  }
}

/**
 * The beginning of a text that fits, with an ellipsis; empty if hardly anything fits.
 * @param {CanvasRenderingContext2D} to
 * @param {string} text
 * @param {number} width
 */
function fitted(to, text, width) {
  if (to.measureText(text).width <= width) return text;
  let part = text;
  while (part.length > 4 && to.measureText(`${part}…`).width > width) part = part.slice(0, -1);
  return part.length > 4 ? `${part.trimEnd()}…` : '';
}
