// The page: finds a log, opens it, and draws the changes.

import { openLog } from './log/log.js';
import { LiveLog } from './log/live.js';
import { readMcap } from './log/mcap.js';
import { Run } from './log/run.js';
import { act, actionOf, follow, followRun, KEYS } from './view/actions.js';
import { bar, tabs } from './view/bar.js';
import { CellView } from './view/cell.js';
import { controls } from './view/controls.js';
import { byId, colours, h, isShown, patch, windowSize } from './view/dom.js';
import { hierarchy, paintStrip } from './view/hierarchy.js';
import { timePane } from './view/timeline.js';
import { paintTimeline } from './view/timeline-paint.js';
import { bufferTopics, fieldsPane, messagesPane } from './view/lists.js';
import { followControls, operate } from './view/operate.js';
import { ask, fail, find } from './view/open.js';
import { followPointers } from './view/pointer.js';
import { fitScore, paintScore } from './view/score.js';
import { Session } from './view/session.js';
import { side } from './view/side.js';
import { consultation, tablePane } from './view/table.js';
import { firstUi } from './view/ui.js';
import { why } from './view/why.js';

/** Ticks of a second. */
const TICKS = 25;
/** Interval of reading the messages of a run while the page is hidden, milliseconds. */
const HIDDEN = 1000;
/** Topics that the picture of the cell needs. */
const PICTURE = ['/meshes', '/tf', '/tf_static', '/names'];

/** Parts of the page that not every view shows. */
const PANES = ['hierarchy', 'side', 'controls', 'why', 'time', 'table'];

class Page {
  /** @param {Run} run @param {Session | null} live */
  constructor(run, live) {
    this.run = run;
    this.live = live;
    this.ui = firstUi(run, live !== null);
    /** @type {CellView | null} */
    this.cell = null;
    this.colour = colours();
    this.dirty = true;
    this.last = 0;
    this.owed = 0;
    this.read(location.hash);
  }

  /**
   * Take choices from the address: `#view=explain&t=623&process=emove&theme=light&units=mm`.
   * @param {string} hash
   */
  read(hash) {
    const { ui, run } = this;
    const wanted = new URLSearchParams(hash.slice(1));
    const choose = (/** @type {string} */ name, /** @type {(value: string) => void} */ take) => {
      const value = wanted.get(name);
      if (value !== null) take(value);
    };
    choose('view', (value) => act(this, `view:${value}`, false));
    choose('tab', (value) => (ui.tab = value));
    choose('t', (value) => act(this, `seek:${value}`, false));
    choose('process', (value) => act(this, `process:${value}`, false));
    choose('panel', (value) => act(this, `panel:${value}`, false));
    choose('camera', (value) => act(this, `camera:${value}`, false));
    choose('theme', (value) => (ui.theme = value === 'light' ? 'light' : 'dark'));
    choose('units', (value) => (ui.units = value === 'mm' ? 'mm' : 'in'));
    choose('big', () => (ui.big = true));
    choose('whole', () => act(this, 'whole', false));
    document.title = `${run.log.name} · RCS-II/T3`;
  }

  start() {
    const changed = () => (this.dirty = true);
    document.addEventListener('click', (event) => this.click(/** @type {Element} */ (event.target)));
    document.addEventListener('keydown', (event) => this.key(event));
    document.addEventListener('input', (event) => {
      if (/** @type {Element} */ (event.target).id !== 'find') return;
      this.ui.filter = /** @type {HTMLInputElement} */ (event.target).value;
      changed();
    });
    document.addEventListener('pointerover', (event) => {
      const card = /** @type {HTMLElement | null} */ (
        /** @type {Element} */ (event.target).closest('[data-process]')
      );
      const pointed = card?.dataset.process ?? null;
      if (pointed !== this.ui.pointed) [this.ui.pointed, this.dirty] = [pointed, true];
    });
    followPointers(
      () => this,
      () => this.cell,
      changed,
    );
    if (this.live) followControls(() => this, changed);
    // A hidden page gets no animation frames, but it still receives messages.
    if (this.live) setInterval(() => document.hidden && this.advance(), HIDDEN);
    addEventListener('resize', changed);
    addEventListener('hashchange', () => {
      this.live?.takeToken();
      this.read(location.hash);
      changed();
    });
    this.printLight();
    this.draw();
    requestAnimationFrame((time) => this.frame(time));
  }

  /** Paper is light. */
  printLight() {
    let { theme } = this.ui;
    addEventListener('beforeprint', () => {
      theme = this.ui.theme;
      this.ui.theme = 'light';
      this.draw();
      this.cell?.copy(this, this.colour);
    });
    addEventListener('afterprint', () => {
      this.ui.theme = theme;
      this.draw();
    });
  }

  /** Load the large topics after the first picture. */
  async complete() {
    await this.run.log.load(['/tf', '/joint_states']);
    this.cell = new CellView(this.run);
    this.dirty = true;
  }

  /** Process the messages that have arrived from a run in progress. */
  advance() {
    const { run, ui, live } = this;
    if (!live) return;
    const { log } = live;
    if (log.last > run.last) {
      run.update();
      if (log.trim()) {
        run.trim(log.first);
        this.cell?.forget();
      }
      if (ui.following) followRun(this);
      this.dirty = true;
    }
    if (!this.cell && PICTURE.every((topic) => log.series(topic).length > 0)) this.cell = new CellView(run);
    // The page shows the time since the last message, which changes.
    if (live.loss) this.dirty = true;
  }

  /** @param {Element} target */
  click(target) {
    const button = /** @type {HTMLElement | null} */ (target.closest('[data-do]'));
    if (!target.closest('#popup') && button?.dataset.do !== 'help') byId('popup').hidden = true;
    if (button?.dataset.do) this.act(button.dataset.do);
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    if (event.key === 'Escape') {
      byId('popup').hidden = true;
      /** @type {HTMLElement} */ (document.activeElement)?.blur();
      return;
    }
    const target = /** @type {HTMLElement} */ (event.target);
    const action = actionOf(event.key);
    // Space and Enter press the button that has the focus.
    const presses = event.key === ' ' && target.tagName === 'BUTTON';
    if (!action || event.ctrlKey || event.metaKey || event.altKey || target.tagName === 'INPUT' || presses)
      return;
    event.preventDefault();
    // Space stops the robot, and never starts it.
    if (event.key === ' ' && this.live) operate(this, 'stop');
    else this.act(action);
  }

  /** @param {string} action */
  act(action) {
    const { ui } = this;
    const phone = windowSize() === 'phone';
    if (!act(this, action, phone)) {
      if (action === 'help') this.help();
      if (action === 'find') [ui.panel, ui.view] = ['fields', ui.view === 'operate' ? 'trace' : ui.view];
    }
    if (action.startsWith('camera') || action === 'nextCamera') this.cell?.reset();
    if (ui.panel === 'fields') this.loadFields();
    this.draw();
    if (action === 'find') document.getElementById('find')?.focus();
  }

  /** The fields need all topics. */
  async loadFields() {
    const topics = bufferTopics(this.run.log);
    if (topics.every((topic) => this.run.log.has(topic))) return;
    await this.run.log.load(topics);
    this.dirty = true;
  }

  help() {
    const popup = byId('popup');
    patch(
      popup,
      h(
        'table',
        {},
        h(
          'tbody',
          {},
          KEYS.filter((key) => key[2]).map(([, , keys, text]) =>
            h('tr', {}, h('td', { class: 'mono' }, keys), h('td', {}, text)),
          ),
        ),
      ),
    );
    popup.hidden = !popup.hidden;
  }

  /** @param {number} time milliseconds */
  frame(time) {
    const { ui, run } = this;
    const passed = Math.min(0.1, (time - this.last) / 1000);
    this.last = time;
    this.advance();
    if (ui.playing) {
      this.owed += passed * TICKS * ui.rate;
      const ticks = Math.floor(this.owed);
      if (ticks > 0) {
        this.owed -= ticks;
        ui.tick = Math.min(run.last, ui.tick + ticks);
        ui.playing = ui.tick < run.last;
        ui.following = this.live !== null && !ui.playing;
        follow(ui);
        this.dirty = true;
      }
    }
    if (this.dirty) this.draw();
    else if (this.cell?.isDue) this.cell.paint(this, this.colour);
    requestAnimationFrame((next) => this.frame(next));
  }

  draw() {
    const { ui } = this;
    const size = windowSize();
    const root = document.documentElement;
    if (root.dataset.theme !== ui.theme) {
      root.dataset.theme = ui.theme;
      this.colour = colours();
    }
    root.classList.toggle('big', ui.big && size === 'desk');
    const app = byId('app');
    [app.dataset.view, app.dataset.tab] = [ui.view, ui.tab];
    app.className = this.classes();
    app.setAttribute('aria-busy', 'false');
    // All reads of the page precede all writes, because a read after a write forces a layout.
    const isOpen = new Map(PANES.map((id) => [id, isShown(byId(id))]));
    const pane = byId('table');
    const em = parseFloat(getComputedStyle(root).fontSize) / 14;
    const room = { width: pane.clientWidth, height: pane.clientHeight, em };
    patch(byId('bar'), ...bar(this));
    patch(byId('tabs'), ...tabs(this));
    const panes = /** @type {[string, () => import('./view/dom.js').Children[]][]} */ ([
      ['hierarchy', () => [hierarchy(this)]],
      ['side', () => side(this)],
      ['controls', () => controls(this, size)],
      ['why', () => why(this)],
      ['time', () => timePane(this, size)],
    ]);
    for (const [id, content] of panes) {
      if (isOpen.get(id)) patch(byId(id), ...content());
    }
    if (isOpen.get('table')) this.drawTable(size, room);
    if (isOpen.get('hierarchy')) {
      for (const canvas of byId('hierarchy').querySelectorAll('canvas'))
        paintStrip(this, canvas, canvas.dataset.strip ?? '', this.colour);
    }
    if (isOpen.get('time'))
      paintTimeline(this, /** @type {HTMLCanvasElement} */ (byId('timeline')), size, this.colour);
    this.cell?.draw(this, this.colour);
    this.dirty = false;
  }

  /** Classes of the page, by which the style sheet selects what is shown. */
  classes() {
    const { live, ui } = this;
    if (!live) return 'app is-log';
    const stale = live.loss ? ' is-stale' : '';
    return `app is-live${stale}${ui.following ? '' : ' is-past'}`;
  }

  /**
   * @param {import('./view/dom.js').Size} size
   * @param {{ width: number, height: number, em: number }} room
   */
  drawTable(size, room) {
    const { ui } = this;
    const pane = byId('table');
    const panels = h(
      'div',
      { class: 'choice panels', role: 'group', 'aria-label': 'contents' },
      [
        ['table', 'Table'],
        ['fields', 'Fields'],
        ['messages', 'Messages'],
      ].map(([panel, name]) =>
        h('button', { 'data-do': `panel:${panel}`, 'aria-pressed': String(ui.panel === panel) }, name),
      ),
    );
    const choice = ui.view === 'trace' || size === 'phone' ? panels : null;
    pane.classList.remove('bad');
    if (ui.panel === 'fields') return patch(pane, ...fieldsPane(this, panels));
    if (ui.panel === 'messages') {
      patch(pane, ...messagesPane(this, panels));
      return showLast(pane);
    }
    patch(pane, ...tablePane(this, choice, room));
    const shown = consultation(this);
    if (!shown) return;
    pane.classList.toggle('bad', shown.failed);
    fitScore(pane);
    paintScore(this, pane, shown.table.name, shown.failed, this.colour);
    showFired(pane);
  }
}

/** Scroll so that the row that fired is in the pane. @param {HTMLElement} pane */
function showFired(pane) {
  const scroll = /** @type {HTMLElement | null} */ (pane.querySelector('.table-scroll'));
  const fired = /** @type {HTMLElement | null} */ (pane.querySelector('tr.fired'));
  if (!scroll || !fired) return;
  const [top, bottom] = [fired.offsetTop - 34, fired.offsetTop + fired.offsetHeight + 6];
  if (top < scroll.scrollTop || bottom > scroll.scrollTop + scroll.clientHeight) {
    scroll.scrollTop = Math.max(0, fired.offsetTop - scroll.clientHeight * 0.45);
  }
}

/** Scroll so that the last message up to the present tick is in the pane. @param {HTMLElement} pane */
function showLast(pane) {
  const list = /** @type {HTMLElement | null} */ (pane.querySelector('.list'));
  const past = /** @type {NodeListOf<HTMLElement>} */ (pane.querySelectorAll('.log-line:not(.fut)'));
  const last = past[past.length - 1];
  if (!list || !last) return;
  const top = last.offsetTop - list.offsetTop;
  if (top < list.scrollTop || top + last.offsetHeight > list.scrollTop + list.clientHeight)
    list.scrollTop = top - list.clientHeight * 0.7;
}

/** @param {string} name @param {Uint8Array} bytes */
async function show(name, bytes) {
  const page = new Page(new Run(await openLog(name, bytes)), null);
  byId('start').hidden = true;
  page.start();
  await page.complete();
}

/**
 * Show a run in progress, as soon as its first tick has arrived.
 * @param {string} name
 * @param {Uint8Array} bytes start of the run
 */
async function watch(name, bytes) {
  const log = new LiveLog(name, await readMcap(bytes));
  /** @type {Page | null} */
  let page = null;
  const live = new Session(log, () => {
    if (!page) return;
    // A lost connection is shown at once, not in the next frame.
    if (live.loss) page.draw();
    else page.dirty = true;
  });
  const start = byId('start');
  start.hidden = false;
  const begin = () => {
    if (log.last === 0) {
      patch(
        start,
        h('div', { class: 'notice' }, h('h1', {}, name), h('p', {}, 'The page waits for the run.')),
      );
      requestAnimationFrame(begin);
      return;
    }
    start.hidden = true;
    page = new Page(new Run(log), live);
    page.start();
  };
  begin();
}

// A page that has failed draws no more frames, so it must show the error.
addEventListener('error', ({ error }) => error && fail(error));
addEventListener('unhandledrejection', ({ reason }) => fail(reason));

find()
  .then((found) => {
    if (!found) return ask(show);
    return (found.isLive ? watch : show)(found.name, found.bytes);
  })
  .catch(fail);
