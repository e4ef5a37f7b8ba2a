/** The timetable of a plan: what each vehicle does at each stop, and the clock that puts its times into words. */

import { amount } from "../common/amounts.js";
import { SECONDS } from "../common/durations.js";
import { customersIn } from "../inputs/details.js";
import { knownFleet } from "./known_fleet.js";
import { stylesOf } from "./route_styles.js";
import { clockOf } from "./times.js";
import { clockUnit } from "./units.js";
import { visitTimes } from "./visit_times.js";

const [TIGHT, MINUTE] = [300, 60]; // seconds: looking for a place to park takes as long as the first

/**
 * A lane for each route, `{ name, style, visits }` by `visitTimes`, and their `clock`, which also says how long something takes.
 * A visit has the `customer` there, and says in `closing` how soon its window closes, if that is within minutes of the vehicle's arrival; "" if not.
 * A plan without times has neither lanes nor a clock.
 *
 * @param {object} asked the request, as far as it is known
 */
export function timetable(routes, names, asked) {
  if (!routes.length || !routes.every(({ arrivals }) => arrivals)) return { lanes: [], clock: null };
  const known = knownFleet(asked);
  const unit = clockUnit(asked);
  const customerOf = customersIn(asked);
  const visitsOf = (route) => visitTimes(route, known).map((visit) => ({ ...visit, customer: customerOf(visit.stop), closing: closing(visit, SECONDS.get(unit)) }));
  const styles = stylesOf(routes, asked);
  const lanes = routes.map((route, at) => ({ name: names[at], style: styles[at], visits: visitsOf(route) }));
  const times = lanes.flatMap(({ visits }) => visits.flatMap(({ arrival, leaves }) => [arrival, leaves]));
  return { lanes, clock: { ...clockOf(times, unit), second: SECONDS.get(unit), lasting: (time) => amount(time, { measure: "waiting", unit }) } };
}

/** The timetable of a plan, if its times are times of day; no lanes, and no clock, if they are not, or not known. */
export function hoursOfPlan(routes, names, asked) {
  const found = timetable(routes, names, asked);
  return found.clock?.second ? found : { lanes: [], clock: null };
}

/** When the last vehicle of a plan is back, as a sentence; "" if that is not known. */
export function lastBack({ routes }, asked) {
  const { lanes, clock } = hoursOfPlan(routes, [], asked);
  if (!clock) return "";
  const last = lanes.map(({ visits }) => visits.at(-1)).reduce((latest, each) => (each.leaves > latest.leaves ? each : latest));
  return ` The last vehicle is ${last.kind === "end" ? "back" : "done"} at ${clock.said(last.leaves)}.`;
}

/** How soon the window of a visit closes, in words; "" if there is time enough. A vehicle that waits for it to open could arrive later. */
function closing({ begin, closes, waiting, rests }, second) {
  const left = Math.round((closes - begin) * second);
  if (!(left + (rests.length ? 0 : waiting * second) <= TIGHT)) return "";
  return `${Math.floor(left / MINUTE) || "less than 1"} min before its window closes`;
}
