/** Names and units of the objectives: two, three or four. */

import { SECONDS } from "./durations.js";
import { MEASURES } from "./measures_table.js";

const TIMES = ["clock", "routes"]; // units of measures that may be times
const THINGS = ["people", "pedestrians", "accidents", "vehicles", "stops", "orders", "parcels", "customers", "visits", "turns", "crossings"];

const SHORT = 16; // letters
const NTH = ["first", "second", "third", "fourth"]; // what the service calls objectives without names

/** The name of an objective that has none. */
export const unnamed = (axis) => ({ name: `length ${axis + 1}`, unit: "" });

/** The first objective on a map. */
export const DISTANCE = { name: "distance", unit: "m" };

/** It over the day. */
export const DURATION = { name: "time", unit: "s" };

export const UNNAMED = [unnamed(0), unnamed(1)];

/** Whether the service named these objectives, since the request did not. */
export const isUnnamed = (objectives) => objectives.every(({ name }, axis) => name === NTH[axis]);

const TIME = /^(driving |travel )?(time|duration)$/i;

/** The longest of a plan's routes, where the name could be that of a total. */
const plainly = (name, over) => (over === "max" && TIME.test(name) ? "longest route" : name);

/** The names in a request or an answer; where it has none, UNNAMED, or as many as its scale has numbers. */
export function namesIn({ objectives, scale }) {
  const named = objectives?.length >= 2 && objectives.every((each) => each?.name && typeof each.name === "string");
  if (!named) return scale?.length > 2 ? scale.map((_, axis) => unnamed(axis)) : UNNAMED;
  return objectives.map(({ name, unit, measure, over }) => ({ name: plainly(name, over), unit: typeof unit === "string" ? unit : "", ...(measure && { measure }), ...(over === "max" && { over }) }));
}

export const titled = ({ name }) => capital(name);

/** A text with a capital letter at its beginning. */
export const capital = (text) => text[0].toUpperCase() + text.slice(1);

/** Whether this is the number of vehicles. */
export const isCounted = ({ measure }) => measure === "vehicles";

/** Whether the unit names things that people count: their numbers are whole. */
export const isOfThings = ({ unit }) => THINGS.includes(unit);

/** Whether the name says what is counted, as "people passed" of people does. */
export const namesThings = ({ name, unit }) => isOfThings({ unit }) && name.split(" ").includes(unit);

/** Whether there are fewer or more of it, where of other objectives there is less: "people passed", or "left turns" without a unit. */
export const isPlural = ({ name, unit }) => namesThings({ name, unit }) || (!unit && name.split(" ").some((word) => THINGS.includes(word)));

/** Whether this is the longest of a plan's routes: it is shorter or longer, where sums are less or more. */
export const isLongest = ({ over, measure }) => over === "max" || measure === "longest";

/** Whether this is a time in a known unit. */
export const isTime = ({ measure, unit }) => SECONDS.has(unit) && (!measure || TIMES.includes(MEASURES[measure]?.unit));

/** Whether this is a distance in metres, of which many are kilometres. */
export const isMetres = ({ unit }) => unit === "m";

/** The units of loads that are carried so far, or for so long. */
export const [LOAD_KM, LOAD_HOURS] = ["load-km", "load-hours"];

/** How many of what the service counts in are one of the unit. Some are a share beside a plan, and are counted as an objective. */
export const perUnit = ({ measure, unit }) => (isShare(measure, unit) ? PER_CENT : (measure === "load_distance" && { [LOAD_KM]: 1000, [LOAD_HOURS]: 3600 }[unit]) || 1);

const PER_CENT = 0.01; // of a share
const isShare = (measure, unit) => MEASURES[measure]?.unit === "%" || (unit === "%" && MEASURES[measure]?.ofPlan === "%");

/** The unit, if it is short enough to stand beside a number. */
export const shortUnit = ({ unit }) => (unit && unit.length < SHORT ? unit : "");

/** The title with its unit, if there is room for that, and neither the name nor the values say it; "Risk × m" of the unit "risk × m". */
export function withUnit(objective) {
  const said = isCounted(objective) || isTime(objective) || isMetres(objective) || namesThings(objective);
  if (!shortUnit(objective) || said) return titled(objective);
  if (objective.unit.startsWith(`${objective.name} ×`)) return titled({ name: objective.unit });
  return `${titled(objective)}, ${objective.unit}`;
}
