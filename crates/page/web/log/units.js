// Lengths, forces and times as text, in the units that the reader chose.

/** Seconds of a tick. */
export const TICK_S = 0.04;
const MM_PER_INCH = 25.4;
const N_PER_POUND = 4.448;

/** @typedef {'in' | 'mm'} Units */

/** A length with its unit. @param {Units} units @param {number} inches @param {number} [digits] */
export function length(units, inches, digits = 2) {
  return `${bareLength(units, inches, digits)} ${units}`;
}

/** A length without its unit. @param {Units} units @param {number} inches @param {number} [digits] */
export function bareLength(units, inches, digits = 2) {
  return units === 'mm' ? (inches * MM_PER_INCH).toFixed(Math.max(0, digits - 1)) : inches.toFixed(digits);
}

/** @param {Units} units @param {number} pounds */
export function force(units, pounds) {
  return units === 'mm' ? `${(pounds * N_PER_POUND).toFixed(0)} N` : `${pounds} lb`;
}

/** @param {Units} units @param {number} inches inches per second */
export function speed(units, inches) {
  return units === 'mm' ? `${(inches * MM_PER_INCH).toFixed(0)} mm/s` : `${inches.toFixed(1)} in/s`;
}

/** The time of a tick: `24.92 s`. @param {number} tick */
export function seconds(tick) {
  return `${(tick * TICK_S).toFixed(2)} s`;
}

/** A duration for a person: `6.1 s`, `3 min 59 s`. @param {number} ticks */
export function duration(ticks) {
  const total = ticks * TICK_S;
  if (total < 59.95) return `${total.toFixed(1)} s`;
  const whole = Math.round(total);
  return `${Math.floor(whole / 60)} min ${String(whole % 60).padStart(2, '0')} s`;
}

/** A time on the ruler: `12 s`, `1:38`. @param {number} total seconds @param {number} digits */
export function clock(total, digits) {
  if (total < 60) return `${total.toFixed(digits)} s`;
  const rest = (total % 60).toFixed(digits);
  return `${Math.floor(total / 60)}:${rest.padStart(digits ? digits + 3 : 2, '0')}`;
}

/** A number of things: `1 error`, `2 errors`. @param {number} count @param {string} thing */
export function amount(count, thing) {
  return `${count} ${thing}${count === 1 ? '' : 's'}`;
}
