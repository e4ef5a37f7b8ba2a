/** Format numbers as people read them. */

const LENGTH = new Intl.NumberFormat("en", { maximumSignificantDigits: 6 });

export function length(value) {
  const size = Math.abs(value);
  return size && (size < 1e-3 || size >= 1e9) ? value.toPrecision(4) : LENGTH.format(value);
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
