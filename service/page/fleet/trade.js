/** Find what a fleet trades for its first objective, and what its times are measured by. */

import { CHOICES } from "../common/measures_table.js";
import { SECONDS } from "../common/durations.js";
import { SPEED } from "../inputs/objective_fields.js";
import { variesBy, varyingBy } from "./spread.js";
import { clockUnit, unitOf } from "./units.js";

const STRAIGHT = { from: "great_circle" };
const USUAL = 20; // per cent by which times vary, until others are typed

/** The second objectives, by their measure or by `over` of their costs, each with its title and its name. */
export const AGAINST = {
  max: { title: "Longest route", name: "longest route" },
  sum: { title: "Total of other costs", name: "other costs" },
  ...CHOICES,
};
const COSTS = ["max", "sum"];

/** Whether the objectives of a request can be chosen here. */
export const isTraded = ({ objectives }) =>
  Array.isArray(objectives) && [2, 3].includes(objectives.length) && objectives.every((each) => each?.name);

/** The key in AGAINST of an objective of a request, by its number; "" if there is none. */
export const againstOf = ({ objectives }, axis = 1) => (objectives[axis] ? (objectives[axis].measure ?? objectives[axis].over ?? "sum") : "");

/** The keys of third objectives, each with its title: not what the first two are already. */
export const alsoAgainst = (asked) => [
  ["", "nothing else"],
  ...Object.entries(AGAINST)
    .filter(([key]) => key === "sum" || (key !== againstOf(asked) && key !== againstOf(asked, 0)))
    .map(([key, { title }]) => [key, title]),
];

/** The request whose times vary, if an objective is of that. */
const varyingFor = (key, asked) => (key === "on_time" && variesBy(asked) === null ? varyingBy(withClock(asked), USUAL) : asked);

/** The request with another third objective; "" takes it away. Costs are those of the second or the first objective. */
export const tradedAlsoAgainst = (asked, key) => varyingFor(key, withThird(asked, key));

function withThird(asked, key) {
  const objectives = asked.objectives.slice(0, 2);
  if (!key) return { ...asked, objectives };
  const { name } = AGAINST[key];
  const unique = objectives.some((each) => each.name === name) ? `${name} too` : name;
  if (!COSTS.includes(key)) return { ...asked, objectives: [...objectives, { name: unique, measure: key }] };
  const { name: _, over: __, spread: ___, percentile: ____, ...costs } = objectives.findLast(({ measure }) => !measure);
  return { ...asked, objectives: [...objectives, { ...costs, name: unique, over: key }] };
}

/** The request with another second objective. Its costs become those of the clock if they were, and back. */
export const tradedAgainst = (asked, key) => varyingFor(key, withSecond(asked, key));

function withSecond(asked, key) {
  const [first, second, ...more] = asked.objectives;
  const { name } = AGAINST[key];
  const { clock, ...others } = asked;
  const kept = more.filter((each) => againstOf({ objectives: [each] }, 0) !== key || key === "sum");
  const timed = (made) => ({ ...others, objectives: [first, made, ...kept], ...(clock && { clock }) });
  if (!COSTS.includes(key)) {
    const made = timed({ name, measure: key });
    const { over: _, ...costs } = second;
    return !second.measure && clock === second.name ? { ...made, clock: { ...costs, name: "time" } } : made;
  }
  if (!second.measure) return { ...timed({ ...second, name, over: key }), ...(clock === second.name && { clock: name }) };
  if (clock && typeof clock === "object") return { ...timed({ ...clock, name, over: key }), clock: name };
  return timed({ ...STRAIGHT, name, over: key });
}

/** What the times of a request are: those of its `first` or `second` objective, of their `own`, or null. */
export function timesOf({ clock, objectives }) {
  if (!clock) return null;
  if (typeof clock === "object") return "own";
  return clock === objectives[0].name ? "first" : "second";
}

/** The request with times, if it has none. */
export function withClock(asked) {
  if (asked.clock) return asked;
  const [first, { measure, from }] = asked.objectives;
  if (!measure && from !== "road_distance") return timedBy(asked, "second");
  return timedBy(asked, !first.measure && SECONDS.has(unitOf(first)) ? "first" : "own");
}

/** The request with other times, which vary as those before. Metres in straight lines become seconds at a speed. */
export function timedBy(asked, times) {
  const percent = variesBy(asked) ?? null;
  const timed = withTimes(percent === null ? asked : varyingBy(asked, null), times);
  return percent === null || !times ? timed : varyingBy(timed, percent);
}

function withTimes(asked, times) {
  const { clock: _, ...others } = asked;
  if (!times) return others;
  if (times === "own") return { ...others, clock: { name: "time", ...STRAIGHT, speed: SPEED } };
  const axis = times === "first" ? 0 : 1;
  const objective = asked.objectives[axis];
  const timed = objective.from === "great_circle" ? { ...objective, speed: objective.speed ?? SPEED } : objective;
  return { ...others, objectives: asked.objectives.with(axis, timed), clock: objective.name };
}

/** What is wrong with the times of a request that the service takes as they are; "" if nothing is. */
export const doubtOfTimes = (asked) =>
  clockUnit(asked) === "m" ? "Times are measured in metres here: choose a measure that is a time, or a speed." : "";
