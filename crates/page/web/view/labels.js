// Labels with names and values in the picture of the cell.

import { h } from './dom.js';

/** Labels that do not cover each other. */
export class Labels {
  /** @param {number[]} size of the picture, pixels */
  constructor([width, height]) {
    this.width = width;
    this.height = height;
    /** @type {{ left: number, top: number, right: number, bottom: number }[]} */
    this.used = [];
    /** @type {import('./dom.js').Element[]} */
    this.shown = [];
  }

  /** A ring around a place. @param {[number, number]} at */
  ring([x, y]) {
    this.shown.push(
      h('i', { class: 'ring-mark', style: `transform:translate(${x.toFixed(1)}px,${y.toFixed(1)}px)` }),
    );
  }

  /**
   * @param {string} kind
   * @param {[number, number] | null} at
   * @param {string[]} lines
   * @param {[number, number]} offset
   * @param {boolean} always show it even over another label
   */
  add(kind, at, lines, [right, down], always) {
    if (!at || at[0] < 0 || at[0] > this.width || at[1] < 0 || at[1] > this.height) return;
    const half = (Math.max(...lines.map((line) => line.length)) * 6.7 + 18) / 2;
    const x = Math.max(half + 4, Math.min(this.width - half - 4, at[0] + right));
    const tall = 9 * lines.length;
    const y = Math.max(tall + 4, Math.min(this.height - tall - 4, at[1] + down));
    const box = { left: x - half, top: y - tall, right: x + half, bottom: y + tall };
    const covers = this.used.some(
      (it) =>
        box.left < it.right + 4 && box.right + 4 > it.left && box.top < it.bottom && box.bottom > it.top,
    );
    if (covers && !always) return;
    this.used.push(box);
    const style = `transform:translate(${x.toFixed(1)}px,${y.toFixed(1)}px) translate(-50%,-50%)`;
    const [first, ...rest] = lines;
    this.shown.push(
      h(
        'span',
        { class: kind, style },
        first,
        rest.map((line) => h('small', {}, line)),
      ),
    );
  }
}
