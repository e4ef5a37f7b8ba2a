/** The timetable of a plan: what each vehicle does at each stop, and the clock that puts its times into words. */

import { amount } from "../common/amounts.js";
import { SECONDS } from "../common/durations.js";
import { knownFleet } from "./known_fleet.js";
import { stylesOf } from "./route_styles.js";
import { clockOf } from "./times.js";
import { clockUnit } from "./units.js";
import { visitTimes } from "./visit_times.js";

const [TIGHT, MINUTE] = [300, 60]; // seconds: looking for a place to park takes as long as the first

/**
 * A lane for each route, `{ name, style, visits }` by `visitTimes`, and their `clock`, which also says how long something takes.
 * A visit says in `closing` how soon its window closes, if that is within minutes of the vehicle's arrival; "" if not.
 * A plan without times has neither lanes nor a clock.
 *
 * @param {object} asked the request, as far as it is known
 */
export function timetable(routes, names, asked) {
  if (!routes.length || !routes.every(({ arrivals }) => arrivals)) return { lanes: [], clock: null };
  const known = knownFleet(asked);
  const unit = clockUnit(asked);
  const visitsOf = (route) => visitTimes(route, known).map((visit) => ({ ...visit, closing: closing(visit, SECONDS.get(unit)) }));
  const styles = stylesOf(routes);
  const lanes = routes.map((route, at) => ({ name: names[at], style: styles[at], visits: visitsOf(route) }));
  const times = lanes.flatMap(({ visits }) => visits.flatMap(({ arrival, leaves }) => [arrival, leaves]));
  return { lanes, clock: { ...clockOf(times, unit), lasting: (time) => amount(time, { measure: "waiting", unit }) } };
}

/** How soon the window of a visit closes, in words; "" if there is time enough. A vehicle that waits for it to open could arrive later. */
function closing({ begin, closes, waiting, rests }, second) {
  const left = Math.round((closes - begin) * second);
  if (!(left + (rests.length ? 0 : waiting * second) <= TIGHT)) return "";
  return `${Math.floor(left / MINUTE) || "less than 1"} min before its window closes`;
}
