/** Put lengths of objectives and measures of plans into words: vehicles are counted, and times are hours and minutes. */

import { SECONDS, duration } from "./durations.js";
import { counted, difference, length, metres, rounded } from "./numbers.js";
import { isCounted, isLongest, isMetres, isOfThings, isPlural, isTime, perUnit, shortUnit } from "./objectives.js";

const FEW = 10; // things; from there on nobody counts tenths

/** A value to six digits, where a title beside it has the unit unless it is one of time, or metres. */
export function figure(value, objective) {
  if (isCounted(objective) || (isOfThings(objective) && Math.abs(value) >= FEW)) return length(Math.round(value));
  if (isMetres(objective)) return metres(value);
  return isTime(objective) ? duration(value * SECONDS.get(objective.unit), { exact: true }) : length(value / perUnit(objective));
}

/** The same to three digits, as people compare it with others; a time to seconds or minutes, which is rounded once. */
export function compared(value, objective) {
  if (isTime(objective)) return duration(value * SECONDS.get(objective.unit));
  const unit = perUnit(objective);
  return figure(isCounted(objective) ? value : rounded(value / unit) * unit, objective);
}

/** Values of one column, as `compared`: distances are in one unit. */
export function comparedAlike(values, objective) {
  if (!isMetres(objective)) return values.map((value) => compared(value, objective));
  const longest = Math.max(...values.map(Math.abs));
  return values.map((value) => metres(rounded(value), length, longest));
}

/** A value to three digits with its unit, such as "7 vehicles", "12 min", "340 m" or "12.4 km". */
export function amount(value, objective) {
  if (isCounted(objective)) return counted(Math.round(value), "vehicle", "vehicles");
  if (isTime(objective) || isMetres(objective)) return compared(value, objective);
  const unit = shortUnit(objective);
  return `${compared(value, objective)}${unit && ` ${unit}`}`;
}

/** The same with its unit even if that is long, where there is room for it. */
export const inFull = (value, objective) => (shortUnit(objective) ? amount(value, objective) : `${compared(value, objective)} ${objective.unit}`.trim());

/** How much more than another a value is: in per cent, or for a measure of plans, which may be 0, as it is. */
export function change(value, beside, objective) {
  if (!objective.measure) return difference(value, beside);
  const said = compared(Math.abs(value - beside), objective);
  if (said === compared(0, objective)) return "same";
  return `${value > beside ? "+" : "−"}${said}`;
}

/** The words that compare an objective. */
export function wordsOf(objective) {
  if (isCounted(objective) || isPlural(objective)) return { least: "fewest", less: "fewer", more: "more", much: "many" };
  if (isLongest(objective)) return { least: "shortest", less: "shorter", more: "longer", much: "long" };
  return { least: "least", less: "less", more: "more", much: "much" };
}

/** The name on the chart of the tour with the least of an objective, such as "least time". */
export const leastOf = (objective) => (isLongest(objective) ? `${objective.name} kept short` : `${wordsOf(objective).least} ${objective.name}`);

/** What there is towards that tour, such as "less time". */
export const lessOf = (objective) => (isLongest(objective) ? `${objective.name} shorter` : `${wordsOf(objective).less} ${objective.name}`);
