// Icons as paths in a square of 24.

import { h } from './dom.js';

/**
 * Each icon is a list of paths: data, and the width of its line; 0 for a filled one.
 * @type {Record<string, [string, number][]>}
 */
const ICONS = {
  run: [['M7 4.5v15l12.5-7.5z', 0]],
  pause: [['M6 4.5h4.4v15H6zM13.6 4.5H18v15h-4.4z', 0]],
  fault: [
    ['M12 2.8 22.6 21H1.4z', 2.4],
    ['M12 9v6M12 17.2v1.6', 2.6],
  ],
  estop: [
    ['M8 2h8l6 6v8l-6 6H8l-6-6V8z', 2.4],
    ['M12 7v6M12 15.6v1.6', 2.6],
  ],
  done: [['M4 12.5l5.5 5.5L20 6.5', 3]],
  stop: [['M5 5h14v14H5z', 0]],
  lost: [
    ['M4 4l16 16M8.5 15.5a5 5 0 0 1 5-1.6M5 12a10 10 0 0 1 3-2M16 10a10 10 0 0 1 3 2', 2.3],
    ['M1.8 8.6A15 15 0 0 1 5 6.3M10 4.7a15 15 0 0 1 12.2 3.9M12 18v1.4', 2.3],
  ],
  first: [['M18 5v14L8 12zM5 5h2.4v14H5z', 0]],
  last: [['M6 5v14l10-7zM16.6 5H19v14h-2.4z', 0]],
  flag: [['M6 21V4h11l-2.5 4L17 12H8', 2.2]],
  theme: [
    ['M12 3a9 9 0 1 0 0 18z', 0],
    ['M12 3a9 9 0 1 1 0 18a9 9 0 1 1 0-18', 2],
  ],
  cell: [['M12 2.8l8.5 4.8v8.8L12 21.2l-8.5-4.8V7.6zM3.5 7.6L12 12.4l8.5-4.8M12 12.4v8.8', 1.8]],
  hierarchy: [['M8.5 3.5h7v4h-7zM8.5 10h7v4h-7zM8.5 16.5h7v4h-7zM12 7.5V10M12 14v2.5', 1.8]],
  table: [['M3.5 4.5h17v15h-17zM3.5 9.5h17M3.5 14.5h17M9 4.5v15', 1.8]],
  time: [['M3 6h8M3 12h14M8 18h13', 3.2]],
  help: [['M8.5 9a3.5 3.5 0 1 1 5 3.1c-1.2.6-1.5 1.2-1.5 2.4M12 17.6v.9', 2.2]],
  executing: [['M5 3.5v17l15-8.5z', 0]],
  idle: [['M12 4.5a7.5 7.5 0 1 1 0 15a7.5 7.5 0 1 1 0-15', 2.4]],
  off: [['M5 12h4M10.5 12h4M16 12h4', 3]],
};

/**
 * An icon, which screen readers skip.
 * @param {string} name
 * @param {string} [kind] further classes
 */
export function icon(name, kind = '') {
  const paths = ICONS[name] ?? [];
  return h(
    'svg',
    { class: `i ${kind}`, viewBox: '0 0 24 24', 'aria-hidden': 'true' },
    paths.map(([d, width]) => {
      const line = {
        fill: 'none',
        stroke: 'currentColor',
        'stroke-width': width,
        'stroke-linejoin': 'round',
      };
      return h('path', width ? { d, ...line } : { d, fill: 'currentColor' });
    }),
  );
}
