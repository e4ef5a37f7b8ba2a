/** Format numbers as people read them. */

const LENGTH = new Intl.NumberFormat("en", { maximumSignificantDigits: 6 });

export function length(value) {
  const size = Math.abs(value);
  return size && (size < 1e-3 || size >= 1e9) ? value.toPrecision(4) : LENGTH.format(value);
}

const LONG = 10000; // metres, from which on they are said in kilometres

/** A distance with its unit, as `said` says its number: "9,500 m", "12.4 km"; in kilometres as soon as one `beside` it is long. */
export const metres = (value, said = length, beside = value) => (Math.max(Math.abs(value), Math.abs(beside)) < LONG ? `${said(value, 1)} m` : `${said(value / 1000, 1000)} km`);

/** A value to three significant digits. */
export const rounded = (value) => Number(value.toPrecision(3));

/** A number in a cell of a table: degrees to a tenth of a metre, not the last bits of what was calculated. */
export const cellNumber = (value) => Number(Math.abs(value) < 1 ? value.toPrecision(6) : value.toFixed(6));

/** A value on an axis, to as many digits as tell it from those a step away. */
export function tick(value, step) {
  const decimals = Math.max(0, 1 - Math.floor(Math.log10(step)));
  if (decimals > 6 || Math.abs(value) >= 1e9) return length(value);
  return value.toLocaleString("en", { maximumFractionDigits: decimals });
}

export const degrees = (angle) => `${angle.toFixed(1)}°`;
export const share = (value) => `${(100 * value).toFixed(2)} %`;

/** How much more than another a value is, in per cent, with its sign. */
export function difference(value, beside) {
  if (beside === 0) return "";
  const shown = (100 * (value / beside - 1)).toFixed(1);
  const sign = Number(shown) > 0 ? "+" : Number(shown) < 0 ? "−" : "";
  return `${sign}${shown.replace("-", "")} %`;
}

export const counted = (count, one, many) => `${count.toLocaleString("en")} ${count === 1 ? one : many}`;
