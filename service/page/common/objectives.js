/** Names and units of the objectives: two, three or four. */

import { SECONDS } from "./durations.js";

const TIMES = ["driving", "service", "waiting", "lateness", "overtime", "longest", "shortest", "imbalance"]; // measures of plans

/** The name of an objective that has none. */
export const unnamed = (axis) => ({ name: `length ${axis + 1}`, unit: "" });

/** The first objective on a map. */
export const DISTANCE = { name: "distance", unit: "m" };

export const UNNAMED = [unnamed(0), unnamed(1)];

/** The names in a request or an answer; where it has none, UNNAMED, or as many as its scale has numbers. */
export function namesIn({ objectives, scale }) {
  const named = objectives?.length >= 2 && objectives.every((each) => each?.name && typeof each.name === "string");
  if (!named) return scale?.length > 2 ? scale.map((_, axis) => unnamed(axis)) : UNNAMED;
  return objectives.map(({ name, unit, measure, over }) => ({ name, unit: typeof unit === "string" ? unit : "", ...(measure && { measure }), ...(over === "max" && { over }) }));
}

export const titled = ({ name }) => name[0].toUpperCase() + name.slice(1);

/** Whether this is the number of vehicles. */
export const isCounted = ({ measure }) => measure === "vehicles";

/** Whether this is the longest of a plan's routes: it is shorter or longer, where sums are less or more. */
export const isLongest = ({ over, measure }) => over === "max" || measure === "longest";

/** Whether this is a time in a known unit. */
export const isTime = ({ measure, unit }) => SECONDS.has(unit) && (!measure || TIMES.includes(measure));

/** The unit, if it is short enough to stand beside a number. */
export const shortUnit = ({ unit }) => (unit && unit.length < 10 ? unit : "");

/** The title with its unit, if there is room for that, and its values do not have units of their own. */
export const withUnit = (objective) =>
  shortUnit(objective) && !isCounted(objective) && !isTime(objective) ? `${titled(objective)}, ${objective.unit}` : titled(objective);
