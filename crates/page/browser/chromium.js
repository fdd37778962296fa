// Drives Chromium over a pipe, by its DevTools protocol. It needs only Node.

import { spawn } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

/** Time limit of a condition on a busy machine, milliseconds. */
const PATIENCE = 60_000;
const FLAGS = [
  '--headless=new',
  '--no-first-run',
  '--no-default-browser-check',
  '--disable-background-networking',
  '--disable-background-timer-throttling',
  '--disable-renderer-backgrounding',
  '--disable-backgrounding-occluded-windows',
  '--use-angle=swiftshader',
  '--enable-unsafe-swiftshader',
  '--remote-debugging-pipe',
];

export class Browser {
  /** @param {string} program @param {string[]} flags in addition to the usual ones */
  constructor(program, flags = []) {
    this.home = mkdtempSync(join(tmpdir(), 'page-'));
    const root = process.getuid?.() === 0 ? ['--no-sandbox'] : [];
    this.process = spawn(program, [...FLAGS, ...flags, ...root, `--user-data-dir=${this.home}`, 'about:blank'], {
      stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe'],
    });
    this.number = 0;
    /** @type {Map<number, { resolve: (value: any) => void, reject: (error: Error) => void }>} */
    this.waiting = new Map();
    /** @type {Map<string, (event: any) => void>} */
    this.pages = new Map();
    let text = '';
    this.process.stdio[4].on('data', (part) => {
      text += part;
      const messages = text.split('\0');
      text = messages.pop() ?? '';
      messages.forEach((message) => this.take(JSON.parse(message)));
    });
  }

  take({ id, result, error, method, params, sessionId }) {
    const waiting = this.waiting.get(id);
    this.waiting.delete(id);
    if (waiting) error ? waiting.reject(new Error(error.message)) : waiting.resolve(result);
    else if (sessionId) this.pages.get(sessionId)?.({ method, params });
  }

  /** Call a method of the protocol. */
  call(method, params = {}, sessionId = undefined) {
    const id = ++this.number;
    this.process.stdio[3].write(`${JSON.stringify({ id, method, params, sessionId })}\0`);
    return new Promise((resolve, reject) => this.waiting.set(id, { resolve, reject }));
  }

  /** Open a page of a size. */
  async open(address, { width = 1440, height = 900, theme = 'dark', touch = false } = {}) {
    const { browserContextId } = await this.call('Target.createBrowserContext');
    const { targetId } = await this.call('Target.createTarget', { url: 'about:blank', browserContextId });
    const { sessionId } = await this.call('Target.attachToTarget', { targetId, flatten: true });
    const page = new Page(this, targetId, sessionId);
    this.pages.set(sessionId, (event) => page.event(event));
    await page.call('Page.enable');
    await page.call('Runtime.enable');
    await page.call('Log.enable');
    await page.call('Emulation.setDeviceMetricsOverride', {
      width,
      height,
      deviceScaleFactor: 1,
      mobile: touch,
    });
    await page.call('Emulation.setEmulatedMedia', {
      features: [{ name: 'prefers-color-scheme', value: theme }],
    });
    await page.call('Page.navigate', { url: address });
    return page;
  }

  async close() {
    const ended = new Promise((resolve) => this.process.once('exit', resolve));
    this.call('Browser.close').catch(() => {});
    await ended;
    rmSync(this.home, { recursive: true, force: true, maxRetries: 5 });
  }
}

export class Page {
  constructor(browser, target, session) {
    this.browser = browser;
    this.target = target;
    this.session = session;
    /** Errors of the page, and requests that its policy has refused. */
    this.errors = [];
  }

  call(method, params) {
    return this.browser.call(method, params, this.session);
  }

  event({ method, params }) {
    if (method === 'Runtime.exceptionThrown')
      this.errors.push(params.exceptionDetails.exception?.description ?? params.exceptionDetails.text);
    if (method === 'Log.entryAdded' && params.entry.level === 'error')
      this.errors.push(`${params.entry.text} ${params.entry.url ?? ''}`);
  }

  /** The value of an expression in the page. */
  async value(expression) {
    const { result, exceptionDetails } = await this.call('Runtime.evaluate', {
      expression,
      awaitPromise: true,
      returnByValue: true,
    });
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
    return result.value;
  }

  /** Wait until an expression is true; fails with the text of the page. */
  async until(expression, patience = PATIENCE) {
    const end = Date.now() + patience;
    for (;;) {
      const value = await this.value(expression);
      if (value) return value;
      if (Date.now() > end) {
        const text = await this.value('document.body.innerText.slice(0, 1500)');
        throw new Error(`${expression} is not true after ${patience} ms; ${this.errors}; the page:\n${text}`);
      }
      await new Promise((resolve) => setTimeout(resolve, 20));
    }
  }

  /** The text of an element; empty without it. */
  text(selector) {
    return this.value(`document.querySelector(${JSON.stringify(selector)})?.innerText ?? ''`);
  }

  /** Press the middle of an element for a time, as a finger or a mouse does. */
  async press(selector, milliseconds = 0) {
    await this.until(`document.querySelector(${JSON.stringify(selector)})?.getClientRects().length > 0`);
    const [x, y] = await this.value(`(() => {
      const box = document.querySelector(${JSON.stringify(selector)}).getBoundingClientRect();
      return [box.left + box.width / 2, box.top + box.height / 2];
    })()`);
    const event = { x, y, button: 'left', clickCount: 1 };
    // A busy page answers late. Without waiting for that, a tap stays short.
    const pressed = this.call('Input.dispatchMouseEvent', { ...event, type: 'mousePressed' });
    if (milliseconds > 0) await new Promise((resolve) => setTimeout(resolve, milliseconds));
    await Promise.all([pressed, this.call('Input.dispatchMouseEvent', { ...event, type: 'mouseReleased' })]);
  }

  async type(text) {
    await this.call('Input.insertText', { text });
  }

  async key(key, code = key, keyCode = 0) {
    const event = { key, code, windowsVirtualKeyCode: keyCode };
    await this.call('Input.dispatchKeyEvent', {
      ...event,
      type: key === 'Enter' ? 'keyDown' : 'rawKeyDown',
      text: key === 'Enter' ? '\r' : undefined,
    });
    await this.call('Input.dispatchKeyEvent', { ...event, type: 'keyUp' });
  }

  /** A picture of the page as PNG. */
  async picture() {
    const { data } = await this.call('Page.captureScreenshot', { format: 'png' });
    return Buffer.from(data, 'base64');
  }

  async close() {
    await this.browser.call('Target.closeTarget', { targetId: this.target });
  }
}
