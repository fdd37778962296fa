// Drives Firefox by WebDriver BiDi. It needs Node with WebSocket (from 20.10 with --experimental-websocket).

import { spawn } from 'node:child_process';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

/** Time limit of a condition on a busy machine, milliseconds. */
const PATIENCE = 60_000;

export class Firefox {
  /** @param {string} program */
  static async start(program) {
    const firefox = new Firefox();
    firefox.home = mkdtempSync(join(tmpdir(), 'firefox-'));
    // Firefox blocks WebGL on machines without a graphics processor by a list of drivers.
    writeFileSync(join(firefox.home, 'user.js'), 'user_pref("webgl.force-enabled", true);\n');
    const options = ['--no-remote', '--profile', firefox.home, '--remote-debugging-port', '0', 'about:blank'];
    const headless = process.env.DISPLAY ? [] : ['--headless'];
    firefox.process = spawn(program, [...headless, ...options], { stdio: ['ignore', 'ignore', 'pipe'] });
    const address = await new Promise((resolve, reject) => {
      let said = '';
      firefox.process.once('error', reject);
      firefox.process.once('exit', (code) => reject(new Error(`Firefox ends with ${code}: ${said}`)));
      firefox.process.stderr.on('data', (part) => {
        said += part;
        const [, found] = /WebDriver BiDi listening on (ws:\S+)/.exec(said) ?? [];
        if (found) resolve(found);
      });
    });
    firefox.socket = new WebSocket(`${address}/session`);
    await new Promise((resolve, reject) => {
      firefox.socket.onopen = resolve;
      firefox.socket.onerror = () => reject(new Error('Firefox accepts no connection'));
    });
    firefox.waiting = new Map();
    firefox.number = 0;
    /** Errors of the page. @type {string[]} */
    firefox.errors = [];
    firefox.socket.onmessage = ({ data }) => firefox.take(JSON.parse(data));
    await firefox.call('session.new', { capabilities: {} });
    await firefox.call('session.subscribe', { events: ['log.entryAdded'] });
    ({ context: firefox.context } = await firefox.call('browsingContext.create', { type: 'tab' }));
    return firefox;
  }

  take({ id, type, result, message, method, params }) {
    if (method === 'log.entryAdded' && params.level === 'error') this.errors.push(params.text);
    const waiting = this.waiting.get(id);
    this.waiting.delete(id);
    if (waiting) type === 'error' ? waiting.reject(new Error(message)) : waiting.resolve(result);
  }

  call(method, params) {
    const id = ++this.number;
    this.socket.send(JSON.stringify({ id, method, params }));
    return new Promise((resolve, reject) => this.waiting.set(id, { resolve, reject }));
  }

  /** Open a page of a size. */
  async open(url, viewport) {
    const { context } = this;
    await this.call('browsingContext.setViewport', { context, viewport });
    await this.call('browsingContext.navigate', { context, url, wait: 'complete' });
  }

  /** The value of an expression in the page, as text. */
  async text(expression) {
    const target = { context: this.context };
    const call = { expression: `String(${expression})`, target, awaitPromise: true };
    const { result, exceptionDetails } = await this.call('script.evaluate', call);
    if (exceptionDetails) throw new Error(exceptionDetails.text);
    return result.value;
  }

  /** Wait until an expression is true; fails with the text of the page. */
  async until(expression) {
    for (const end = Date.now() + PATIENCE; (await this.text(`Boolean(${expression})`)) !== 'true';) {
      if (Date.now() > end)
        throw new Error(
          `${expression} is not true; ${this.errors}; ${await this.text('document.body.innerText')}`,
        );
      await new Promise((resolve) => setTimeout(resolve, 50));
    }
  }

  async close() {
    const ended = new Promise((resolve) => this.process.once('exit', resolve));
    this.call('browser.close', {}).catch(() => {});
    await ended;
    rmSync(this.home, { recursive: true, force: true, maxRetries: 5 });
  }
}
