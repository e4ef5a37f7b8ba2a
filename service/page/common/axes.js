/** Say how the axis of an objective is written: its title, its ticks, and the steps between them that suit it. */

import { SECONDS, durationOnAxis } from "./durations.js";
import { metres, tick } from "./numbers.js";
import { isCounted, isMetres, isTime, perUnit, withUnit } from "./objectives.js";

const DAY = 86400; // seconds
const STEPS = [1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 14400, 21600, 43200, DAY, ...[2, 5, 10, 50, 100, 1000].map((days) => days * DAY)];
const COUNTS = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 10000, 100000];
const DECIMAL = Array.from({ length: 33 }, (_, at) => [1, 2, 5][at % 3] * 10 ** (Math.floor(at / 3) - 3));
const ROUND = [1, 2, 2.5, 5, 10];

/** The `title`, a tick that is a step from the next as `said`, and the `steps` that suit it, ascending; null if any do. */
export function axisOf(objective) {
  const title = withUnit(objective);
  if (isCounted(objective)) return { title, steps: COUNTS, said: (value) => tick(Math.round(value), 1) };
  if (isMetres(objective)) return { title, steps: null, said: (value, step) => metres(value, (number, per) => tick(number, step / per)) };
  if (!isTime(objective)) return inUnits(title, perUnit(objective));
  const unit = SECONDS.get(objective.unit);
  return { title, steps: STEPS.map((step) => step / unit), said: (value, step) => durationOnAxis(value * unit, step * unit) };
}

const inUnits = (title, per) => ({ title, steps: per > 1 ? DECIMAL.map((step) => step * per) : null, said: (value, step) => tick(value / per, step / per) });

/** Round values from the least to the greatest, at most `most` of them, and the `step` from one to the next. */
export function ticksOf({ steps }, least, greatest, most) {
  const wanted = (greatest - least) / most;
  if (!(wanted > 0)) return { values: [least], step: Math.abs(least) / 100 || 1 };
  const tens = 10 ** Math.floor(Math.log10(wanted));
  const step = steps?.find((each) => each >= wanted) ?? tens * ROUND.find((each) => each * tens >= wanted);
  const first = Math.ceil(least / step);
  const values = Array.from({ length: Math.floor(greatest / step) - first + 1 }, (_, at) => (first + at) * step);
  return values.length ? { values, step } : { values: [least], step };
}
