// The cell: bodies at their places, names, contacts, the picture of the camera, and instruments.

import { Frames, WORLD } from '../cell/frames.js';
import { IDENTITY, transform } from '../cell/matrix.js';
import { Renderer } from '../cell/renderer.js';
import { processOf } from '../log/processes.js';
import { lastUpTo, Reader } from '../log/series.js';
import { stateOf } from '../log/state.js';
import { bareLength, length } from '../log/units.js';
import { byId, h, isShown, patch } from './dom.js';
import { instruments } from './instruments.js';
import { Labels } from './labels.js';
import { notices } from './notices.js';
import { camerasOf } from './ui.js';

/** @typedef {import('../cell/matrix.js').Point} Point */

const TOOL_POINT = 'tool_point';
/** Ticks of the trail, and ticks between its points. */
const TRAIL = { ticks: 500, step: 5 };
/** Places of the tool point that are kept. */
const KEPT = 8192;
/** Ticks for which a picture of the camera stays in the cell. */
const PICTURE_TICKS = 250;
/** Radius of a mark at a contact, metres: from far, from near, and of a permitted one. */
const BALL = { far: 0.05, near: 0.022, permitted: 0.012 };

/**
 * Where the buttons put the camera: radians, metres. Without a target it follows the tool point, a contact, or
 * the place where a part was expected.
 * @typedef {{ azimuth: number, elevation: number, distance: number, target: Point | null }} Place
 * @typedef {{ name: string } & Place} Preset
 * @type {Record<string, Preset>}
 */
export const CAMERAS = {
  cell: { name: 'Cell', azimuth: -1.6, elevation: 0.46, distance: 6.5, target: [0.42, -0.62, -0.34] },
  gripper: { name: 'Gripper', azimuth: -1.2, elevation: 0.3, distance: 1.9, target: null },
  top: { name: 'Top', azimuth: -Math.PI / 2, elevation: 1.5, distance: 8.2, target: [0.35, -0.6, -0.6] },
  place: { name: 'Place', azimuth: -1.3, elevation: 0.5, distance: 2.7, target: null },
  contact: { name: 'Contact', azimuth: -1.05, elevation: 0.34, distance: 1.75, target: null },
};
const DISTANCE = { least: 0.4, most: 14 };

export class CellView {
  /** @param {import('../log/run.js').Run} run */
  constructor(run) {
    this.run = run;
    this.canvas = /** @type {HTMLCanvasElement} */ (byId('gl'));
    this.moving = new Reader(run.log, '/tf');
    this.frames = new Frames(this.moving.messages(), run.log.series('/tf_static').messages);
    /** Places of the tool point by tick. @type {Map<number, Point>} */
    this.places = new Map();
    this.turn = { azimuth: 0, elevation: 0, distance: 1 };
    /** True if the picture is not that of the shown tick. */
    this.isDue = false;
    /** @type {Renderer | null} */
    this.renderer = null;
    this.trouble = '';
    this.prepare();
    // A tablet can withdraw the graphics context of a page in the background.
    this.canvas.addEventListener('webglcontextlost', (event) => event.preventDefault());
    this.canvas.addEventListener('webglcontextrestored', () => this.prepare());
    new ResizeObserver(() => (this.isDue = true)).observe(this.canvas);
    this.names = (run.log.series('/names').latest(run.last)?.entities ?? []).flatMap(
      (/** @type {any} */ entity) => {
        const [text] = entity.texts;
        return text
          ? [
              {
                text: text.text,
                frame: entity.frame_id,
                place: [text.pose.position.x, text.pose.position.y, text.pose.position.z],
              },
            ]
          : [];
      },
    );
    this.pictures = run.log.series('/camera');
    /** @type {Map<number, string>} */
    this.urls = new Map();
  }

  /** Upload the meshes to the graphics processor. */
  prepare() {
    const { log, last } = this.run;
    try {
      this.renderer = new Renderer(this.canvas, log.series('/meshes').latest(last)?.entities ?? []);
      this.isDue = true;
    } catch (error) {
      this.trouble = error instanceof Error ? error.message : String(error);
    }
  }

  /**
   * Turn the camera by a drag, or move it nearer.
   * @param {number} right
   * @param {number} down
   * @param {number} nearer
   */
  move(right, down, nearer) {
    this.turn.azimuth -= right;
    this.turn.elevation += down;
    this.turn.distance *= nearer;
  }

  /** Remove data of the oldest part of the run, which was removed. */
  forget() {
    const { log } = this.run;
    this.moving = new Reader(log, '/tf');
    this.frames = new Frames(this.moving.messages(), log.series('/tf_static').messages);
    this.places.clear();
  }

  /** Put the camera where its button puts it. */
  reset() {
    this.turn = { azimuth: 0, elevation: 0, distance: 1 };
  }

  /** @param {import('./ui.js').Context} context @param {Record<string, string>} colour */
  draw(context, colour) {
    if (!isShown(byId('cell'))) return;
    const { ui } = context;
    const room =
      innerWidth > 700 && ui.view !== 'operate' && !ui.big && !(innerWidth < 1200 && ui.view === 'explain');
    byId('instruments').hidden = !room;
    if (room) patch(byId('instruments'), ...instruments(context));
    patch(byId('cell-overlay'), this.overlay(context));
    // The picture is drawn last, because the instruments change its size.
    this.paint(context, colour);
  }

  /**
   * Draw the picture and its labels. If the graphics processor still draws the last picture, it becomes due:
   * more pictures than can be drawn would delay everything else that the page shows.
   * @param {import('./ui.js').Context} context
   * @param {Record<string, string>} colour
   */
  paint(context, colour) {
    for (const { tick, data } of this.moving.messages()) this.frames.add(tick, data);
    if (!this.renderer) return;
    this.isDue = this.renderer.isBusy;
    if (!this.isDue) this.paintNow(context, colour, this.renderer);
  }

  /**
   * @param {import('./ui.js').Context} context
   * @param {Record<string, string>} colour
   * @param {Renderer} renderer
   */
  paintNow(context, colour, renderer) {
    const { ui, run } = context;
    const contacts = run.contactsAt(ui.tick);
    const collision = contacts.filter((it) => !it.permitted).sort((a, b) => b.depth - a.depth)[0];
    renderer.draw(this.picture(context, contacts, colour));
    patch(byId('labels'), ...this.labels(context, collision));
  }

  /**
   * @param {import('./ui.js').Context} context
   * @param {import('../log/run.js').Contact[]} contacts
   * @param {Record<string, string>} colour
   * @returns {import('../cell/renderer.js').Picture}
   */
  picture({ ui }, contacts, colour) {
    const renderer = /** @type {Renderer} */ (this.renderer);
    const near = !CAMERAS[ui.camera].target;
    const tints = new Map();
    for (const name of ui.pointed ? processOf(ui.pointed).meshes : [])
      tints.set(name, { colour: rgb(colour.acc), amount: 0.55 });
    for (const { mover, permitted } of contacts) {
      if (!permitted) tints.set(mover, { colour: rgb(colour.flt), amount: 0.5 });
    }
    const trail = this.trail(ui.tick);
    return {
      matrices: renderer.bodies.map(({ frame }) =>
        frame === WORLD ? IDENTITY : this.frames.matrix(frame, ui.tick),
      ),
      tints,
      trail,
      trailColour: rgb(colour.acc),
      balls: contacts.map(({ point, permitted }) => ({
        place: point,
        radius: permitted ? BALL.permitted : near ? BALL.near : BALL.far,
        colour: rgb(permitted ? colour.run : colour.flt),
        glow: !permitted,
      })),
      light: ui.theme === 'light',
      camera: this.camera(ui, contacts.find((it) => !it.permitted)?.point ?? null),
    };
  }

  /** The places of the tool point up to a tick. @param {number} tick */
  trail(tick) {
    if (this.places.size > KEPT) this.places.clear();
    const points = [];
    const first = Math.max(0, Math.ceil((tick - TRAIL.ticks) / TRAIL.step) * TRAIL.step);
    for (let at = first; at < tick; at += TRAIL.step) {
      const place = this.places.get(at) ?? this.frames.place(TOOL_POINT, at);
      if (!place) continue;
      this.places.set(at, place);
      points.push(place);
    }
    const now = this.frames.place(TOOL_POINT, tick);
    return now ? [...points, now] : points;
  }

  /**
   * @param {import('./ui.js').Ui} ui
   * @param {Point | null} contact
   * @returns {import('../cell/renderer.js').Camera}
   */
  camera(ui, contact) {
    const preset = CAMERAS[ui.camera];
    const { clientWidth, clientHeight } = this.canvas;
    const aspect = clientWidth / Math.max(1, clientHeight);
    const followed = (ui.camera === 'contact' && (contact ?? this.run.collision)) ||
      (ui.camera === 'place' && this.run.expected?.place) ||
      this.frames.place(TOOL_POINT, ui.tick) || [0, 0, 0];
    const target = /** @type {Point} */ (preset.target ?? [followed[0], followed[1], followed[2] + 0.12]);
    // In a narrow picture, the view of the whole cell needs more distance and a higher camera.
    const wide = preset.target ? Math.max(1, 1.38 / aspect) : 1;
    const steeper = preset.target && preset.elevation < 1.2 ? Math.max(0, 1 - aspect) * 0.62 : 0;
    return {
      target,
      azimuth: preset.azimuth + this.turn.azimuth,
      elevation: Math.max(0.02, Math.min(1.55, preset.elevation + steeper + this.turn.elevation)),
      distance: Math.max(
        DISTANCE.least,
        Math.min(DISTANCE.most, preset.distance * wide * this.turn.distance),
      ),
    };
  }

  /**
   * @param {import('./ui.js').Context} context
   * @param {import('../log/run.js').Contact | undefined} collision
   */
  labels({ run, ui }, collision) {
    const renderer = /** @type {Renderer} */ (this.renderer);
    const labels = new Labels(renderer.size);
    if (collision) {
      const where = collision.point.map((value) => bareLength(ui.units, value / 0.0254)).join(' ');
      labels.add(
        'label hit',
        renderer.project(collision.point),
        [
          `${collision.mover} in ${collision.obstacle}`,
          `${length(ui.units, collision.depth, 3)} deep at ${where} ${ui.units}`,
        ],
        [70, -74],
        true,
      );
    }
    const place = this.frames.place(TOOL_POINT, ui.tick);
    const point = run.toolPoint(ui.tick);
    if (place && point && !collision) {
      labels.add(
        'label tp',
        renderer.project(place),
        [`${point.map((value) => bareLength(ui.units, value, 1)).join(' ')} ${ui.units}`],
        [0, -16],
        true,
      );
    }
    const missed = run.missed(ui.tick);
    if (missed) {
      const at = renderer.project(missed.place);
      if (at) labels.ring(at);
      labels.add('label miss', at, [`${missed.part} is expected here`, missed.location], [0, -46], true);
    }
    const isNear = !CAMERAS[ui.camera].target;
    for (const { frame, name, where } of run.parts(ui.tick)) {
      const at = this.frames.place(frame, ui.tick);
      // A part that has not been delivered is at the origin of the world.
      if (!at || Math.hypot(...at) < 1e-3 || name === missed?.part) continue;
      const lines = isNear && where ? [name, where] : [name];
      labels.add('label part', renderer.project(at), lines, [0, isNear ? 44 : 18], false);
    }
    if (isNear) return labels.shown;
    const command = stateOf(run, 'emove', ui.tick).command;
    for (const { text, frame, place: at } of this.names) {
      const matrix = frame === WORLD ? IDENTITY : this.frames.matrix(frame, ui.tick);
      if (!matrix || text === 'T3') continue;
      const isGoal =
        text.split(' ').some((/** @type {string} */ word) => command.includes(word)) &&
        !command.startsWith('E-PAUSE');
      labels.add(
        `label ${isGoal ? 'hot' : ''}`,
        renderer.project(transform(matrix, at)),
        [text],
        [0, 0],
        false,
      );
    }
    return labels.shown;
  }

  /**
   * Copy the picture for paper: a browser prints the frame before the present one.
   * @param {import('./ui.js').Context} context
   * @param {Record<string, string>} colour
   */
  copy(context, colour) {
    if (!this.renderer) return;
    this.paintNow(context, colour, this.renderer);
    const paper = /** @type {HTMLImageElement} */ (byId('paper'));
    paper.src = this.canvas.toDataURL();
    paper.hidden = false;
  }

  /**
   * Buttons of the camera, and the last picture that vision took.
   * @param {import('./ui.js').Context} context
   */
  overlay({ run, ui, live }) {
    return [
      this.trouble ? h('p', { class: 'trouble' }, this.trouble) : null,
      live ? notices(run, ui, live) : null,
      this.cameraPicture(run, ui),
      h(
        'div',
        { class: 'camera-choice' },
        h(
          'div',
          { class: 'choice', role: 'group', 'aria-label': 'camera' },
          camerasOf(run).map((id) =>
            h(
              'button',
              { 'data-do': `camera:${id}`, 'aria-pressed': String(ui.camera === id && !ui.turned) },
              CAMERAS[id].name,
            ),
          ),
        ),
      ),
    ];
  }

  /** @param {import('../log/run.js').Run} run @param {import('./ui.js').Ui} ui */
  cameraPicture(run, ui) {
    // The picture is written one tick after the answer.
    const index = this.pictures.index(ui.tick + 1);
    const vision = run.vision[lastUpTo(run.vision, ui.tick, (it) => it.tick)]?.status ?? 'idle';
    const failed = !/^(idle|busy|done)$/.test(vision);
    if (index < 0 || byId('stage').clientHeight < 240) return null;
    const age = ui.tick - this.pictures.tick(index);
    if (age > PICTURE_TICKS && !failed) return null;
    const title = failed ? vision.replace(/-/g, ' ') : 'camera';
    const tick = `${failed ? 'camera, ' : ''}tick ${this.pictures.tick(index)}`;
    return h(
      'figure',
      { class: `picture ${failed ? 'bad' : ''}` },
      h('img', { alt: `picture of the camera: ${title}`, src: this.url(index) }),
      h('figcaption', {}, h('b', {}, title), h('span', {}, tick)),
    );
  }

  /** The address of a picture of the camera. @param {number} index */
  url(index) {
    const known = this.urls.get(index);
    if (known) return known;
    const { data, format } = this.pictures.get(index);
    const url = URL.createObjectURL(new Blob([data], { type: `image/${format === 'png' ? 'png' : 'jpeg'}` }));
    this.urls.set(index, url);
    return url;
  }
}

/** `#rrggbb` as numbers from 0 to 1. @param {string} colour @returns {[number, number, number]} */
function rgb(colour) {
  const value = parseInt(colour.slice(1), 16);
  return [(value >> 16) / 255, ((value >> 8) & 255) / 255, (value & 255) / 255];
}
