// A small view layer: trees of plain objects, compared with the page.
//
// Texts reach the page as text nodes only, so a text of a log is never read as HTML. An element that stays at
// its place in the tree stays in the page, and keeps its focus and its scroll position.

/**
 * @typedef {Record<string, string | number | boolean | null | undefined>} Props
 * @typedef {{ tag: string, props: Props, children: Child[] }} Element
 * @typedef {Element | string | number | null | undefined | false} Child
 * @typedef {Child | Child[]} Children
 */

const SVG = new Set(['svg', 'path', 'circle', 'g', 'rect', 'text']);
const SVG_SPACE = 'http://www.w3.org/2000/svg';

/**
 * An element. A property that is null, undefined or false is left out. `style` is a text.
 * @param {string} tag
 * @param {Props} props
 * @param {Children[]} children
 * @returns {Element}
 */
export function h(tag, props, ...children) {
  return { tag, props, children: children.flat() };
}

/**
 * Make the children of an element equal to a tree.
 * @param {globalThis.Element} parent
 * @param {Children[]} children
 */
export function patch(parent, ...children) {
  const wanted = children.flat().filter((child) => child !== null && child !== undefined && child !== false);
  wanted.forEach((child, index) => {
    const old = parent.childNodes[index];
    if (typeof child !== 'object') {
      const text = String(child);
      if (old?.nodeType !== Node.TEXT_NODE) put(parent, old, document.createTextNode(text));
      else if (old.nodeValue !== text) old.nodeValue = text;
      return;
    }
    const made = /** @type {Element} */ (child);
    let element = /** @type {globalThis.Element} */ (old);
    if (!(old instanceof Element) || old.localName !== made.tag) {
      element = SVG.has(made.tag)
        ? document.createElementNS(SVG_SPACE, made.tag)
        : document.createElement(made.tag);
      put(parent, old, element);
    }
    assign(element, made.props);
    patch(element, made.children);
  });
  while (parent.childNodes.length > wanted.length) parent.lastChild?.remove();
}

/** @param {globalThis.Element} parent @param {ChildNode | undefined} old @param {Node} made */
function put(parent, old, made) {
  if (old) old.replaceWith(made);
  else parent.append(made);
}

/** @param {globalThis.Element} element @param {Props} props */
function assign(element, props) {
  // The painter of a canvas sets its size.
  const removable = element instanceof HTMLCanvasElement ? [] : [...element.attributes];
  for (const { name } of removable) {
    if (!present(props[name])) element.removeAttribute(name);
  }
  for (const [name, value] of Object.entries(props)) {
    if (!present(value)) continue;
    const text = value === true ? '' : String(value);
    if (element.getAttribute(name) === text) continue;
    element.setAttribute(name, text);
    // Typed text stays, because the program sets the value of a field only when it changes.
    if (name === 'value' && element instanceof HTMLInputElement) element.value = text;
  }
}

/** @param {Props[string]} value */
function present(value) {
  return value !== null && value !== undefined && value !== false;
}

/** An element of the page by its id. @param {string} id @returns {HTMLElement} */
export function byId(id) {
  const element = document.getElementById(id);
  if (!element) throw new Error(`The page has no element ${id}.`);
  return element;
}

/** Returns true if an element is shown. @param {HTMLElement} element */
export function isShown(element) {
  return element.offsetParent !== null || element.getClientRects().length > 0;
}

/**
 * A canvas for drawing in pixels of the page, cleared.
 * @param {HTMLCanvasElement} canvas
 * @param {number} width
 * @param {number} height
 */
export function context2d(canvas, width, height) {
  const ratio = Math.min(devicePixelRatio || 1, 2);
  const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== w) canvas.width = w;
  if (canvas.height !== h) canvas.height = h;
  const context = canvas.getContext('2d');
  if (!context) return null;
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return context;
}

/** A text with a capital letter; a name with an underscore stays as it is. @param {string} text */
export function sentence(text) {
  return /^[^ ]*_/.test(text) ? text : text.slice(0, 1).toUpperCase() + text.slice(1);
}

/** @typedef {'phone' | 'tablet' | 'desk'} Size */

/** The arrangement for the width of the window. @returns {Size} */
export function windowSize() {
  if (innerWidth <= 700) return 'phone';
  return innerWidth < 1200 ? 'tablet' : 'desk';
}

/**
 * The colours of the present theme by the names of their variables, without the dashes.
 * @returns {Record<string, string>}
 */
export function colours() {
  const style = getComputedStyle(document.documentElement);
  /** @type {Map<string, string>} */
  const known = new Map();
  /** @type {Record<string, string>} */
  const none = {};
  const get = (/** @type {unknown} */ _, /** @type {string | symbol} */ name) => {
    const variable = `--${String(name)}`;
    const value = known.get(variable) ?? style.getPropertyValue(variable).trim();
    known.set(variable, value);
    return value;
  };
  return new Proxy(none, /** @type {ProxyHandler<Record<string, string>>} */ ({ get }));
}
