/** Put lengths of objectives and measures of plans into words: vehicles are counted, and times are hours and minutes. */

import { SECONDS, duration, durationOnAxis } from "./durations.js";
import { counted, difference, length } from "./numbers.js";
import { isCounted, isLongest, isTime, shortUnit, titled, withUnit } from "./objectives.js";

/** A value for a column, or a tick of an axis, whose title has the unit. */
export function figure(value, objective) {
  if (isCounted(objective)) return length(Math.round(value));
  return isTime(objective) ? duration(value * SECONDS.get(objective.unit)) : length(value);
}

/** A value of as many digits with its unit, such as "7 vehicles", "12 min" or "340 m". */
export function amount(value, objective, digits = 5) {
  if (isCounted(objective)) return counted(Math.round(value), "vehicle", "vehicles");
  if (isTime(objective)) return figure(value, objective);
  const unit = shortUnit(objective);
  return `${length(Number(value.toPrecision(digits)))}${unit && ` ${unit}`}`;
}

/** How much more than another a value is: in per cent, or for a measure of plans, which may be 0, as it is. */
export function change(value, beside, objective) {
  if (!objective.measure) return difference(value, beside);
  const said = figure(Math.abs(value - beside), objective);
  if (said === figure(0, objective)) return "same";
  return `${value > beside ? "+" : "−"}${said}`;
}

/** The words that compare an objective. */
export function wordsOf(objective) {
  if (isCounted(objective)) return { least: "fewest", less: "fewer", more: "more", much: "many" };
  if (isLongest(objective)) return { least: "shortest", less: "shorter", more: "longer", much: "long" };
  return { least: "least", less: "less", more: "more", much: "much" };
}

/**
 * How an axis over this range of an objective is written: its `title`, a tick as `said`, and the distances between
 * ticks that suit it as `steps`, null if any do. A long range of times is in hours and minutes.
 */
export function axisOf(objective, range) {
  const unit = SECONDS.get(objective.unit);
  if (isTime(objective) || !unit || range * unit <= LONG) {
    return { title: withUnit(objective), steps: stepsOf(objective), said: (value) => figure(value, objective) };
  }
  const steps = STEPS.filter((step) => step >= MINUTE).map((step) => step / unit);
  return { title: titled(objective), steps, said: (value) => durationOnAxis(value * unit) };
}

function stepsOf(objective) {
  if (isCounted(objective)) return [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 10000, 100000];
  if (!isTime(objective)) return null;
  const unit = SECONDS.get(objective.unit);
  return STEPS.map((step) => step / unit).filter((step) => step >= 1 || step === 0.5);
}

const [MINUTE, LONG, DAY] = [60, 600, 86400]; // seconds
const STEPS = [1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 14400, 21600, 43200, DAY, ...[2, 5, 10, 50, 100, 1000].map((days) => days * DAY)];
