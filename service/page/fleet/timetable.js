/** The timetable of a plan: what each vehicle does at each stop, and the clock that puts its times into words. */

import { amount } from "../common/amounts.js";
import { knownFleet } from "./known_fleet.js";
import { clockOf } from "./times.js";
import { clockUnit } from "./units.js";
import { visitTimes } from "./visit_times.js";

/**
 * A lane for each route, `{ name, visits }` by `visitTimes`, and their `clock`, which also says how long something takes.
 * There are no lanes, and no clock, if the plan has no times.
 *
 * @param {object} asked the request, as far as it is known
 */
export function timetable(routes, names, asked) {
  if (!routes.length || !routes.every(({ arrivals }) => arrivals)) return { lanes: [], clock: null };
  const known = knownFleet(asked);
  const lanes = routes.map((route, at) => ({ name: names[at], visits: visitTimes(route, known) }));
  const times = lanes.flatMap(({ visits }) => visits.flatMap(({ arrival, leaves }) => [arrival, leaves]));
  const unit = clockUnit(asked);
  return { lanes, clock: { ...clockOf(times, unit), lasting: (time) => amount(time, { measure: "waiting", unit }) } };
}
