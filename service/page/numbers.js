/** Numbers as people read them. */

const LENGTH = new Intl.NumberFormat("en", { maximumSignificantDigits: 6 });
const DIFFERENCE = new Intl.NumberFormat("en", {
  style: "percent",
  signDisplay: "exceptZero",
  minimumFractionDigits: 1,
  maximumFractionDigits: 1,
});

export function length(value) {
  const size = Math.abs(value);
  return size && (size < 1e-3 || size >= 1e9) ? value.toPrecision(4) : LENGTH.format(value);
}

export const degrees = (angle) => `${angle.toFixed(1)}°`;
export const share = (value) => `${(100 * value).toFixed(2)} %`;
export const difference = (value, beside) => (beside === 0 ? "" : DIFFERENCE.format(value / beside - 1));
export const counted = (count, one, many) => `${count.toLocaleString("en")} ${count === 1 ? one : many}`;
