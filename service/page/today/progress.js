/** Tell how far each vehicle of a plan has come: what is done by now comes from the plan's own times. */

import { knownFleet } from "../fleet/known_fleet.js";
import { timetable } from "../fleet/timetable.js";
import { kindsOf } from "../fleet/visit_times.js";
import { customersIn } from "../inputs/details.js";

/**
 * Each route of a plan: its `name`, and its `visits`, each with the `stop`, the `customer` there, its `kind` as of `visitTimes`, whether it is
 * `done`, and with a clock `begin`, when it begins; `isOut`, whether its vehicle has left; `isBack`, whether all is done;
 * and where the vehicle is: `at` is the visit that it goes on from, `share` how far it has come from there to the next, and `leaves` when it
 * leaves there, if that is later; null if it is not. By then it has driven a `distance` and has been `driving`, where its route says these.
 * A visit that has begun is done. Once somebody has taken a stop back or added one, the vehicle is at the last that is done.
 *
 * @param {{ routes: object[], names: string[], asked: object }} driven the plan that is driven
 * @param {{ now: number | null, turned: Set<string> }} day the time in the unit of the clock, null if it is not known; and the
 *   stops that are done though they are not by the plan, or the other way round
 */
export function progressOf({ routes, names, asked }, { now, turned }) {
  const { lanes, clock } = timetable(routes, names, asked);
  const { types } = knownFleet(asked);
  const customerOf = customersIn(asked);
  const visitsOf = (route, at) => lanes[at]?.visits ?? kindsOf(route, types.get(route.vehicle)).map((kind, place) => ({ kind, stop: route.stops[place], customer: customerOf(route.stops[place]) }));
  return { clock, vans: routes.map((route, at) => withDriven(vanOf(names[at], visitsOf(route, at), now, turned), route)) };
}

/** A van with what its route says that it has driven, which between two visits is a share of the leg. */
function withDriven(van, { distance, driving }) {
  const { at, share } = van;
  const reached = (each) => each && each[at] + share * ((each[at + 1] ?? each[at]) - each[at]);
  return { ...van, distance: reached(distance), driving: reached(driving) };
}

function vanOf(name, visits, now, turned) {
  const planned = visits.map(({ begin }) => now !== null && begin !== undefined && begin <= now);
  const known = visits.map((visit, at) => ({ ...visit, done: visit.kind === "visit" ? planned[at] !== turned.has(visit.stop) : planned[at] }));
  const isTurned = visits.some(({ stop, kind }) => kind === "visit" && turned.has(stop));
  const isDone = ({ kind, done }) => kind === "visit" && done;
  const last = isTurned ? Math.max(known.findLastIndex(isDone), 0) : planned.lastIndexOf(true);
  return {
    name,
    visits: known,
    isOut: planned[0] || known.some(isDone),
    isBack: known.every(({ kind, done }) => kind !== "visit" || done) && (now === null || isTurned || planned.at(-1)),
    at: Math.max(last, 0),
    leaves: !isTurned && visits[last]?.leaves > now ? visits[last].leaves : null,
    share: isTurned ? 0 : shareOf(visits[last], visits[last + 1], now),
  };
}

/** How far a vehicle has come from one visit to the next: 1 if it waits there. */
function shareOf(from, to, now) {
  if (now === null || from?.leaves === undefined || !to || now <= from.leaves) return 0;
  return to.arrival > from.leaves ? Math.min((now - from.leaves) / (to.arrival - from.leaves), 1) : 1;
}

/** The stops of a van that are visited, in order. */
export const doneOf = ({ visits }) => visits.filter(({ kind, done }) => kind === "visit" && done).map(({ stop }) => stop);

/** Those that are not yet. */
export const leftOf = ({ visits }) => visits.filter(({ kind, done }) => kind === "visit" && !done).map(({ stop }) => stop);

/**
 * The part of a way that is behind a vehicle.
 *
 * @param {number[][]} way the places along the whole way, in order
 * @param {number[][]} stops the places of the stops on it, in order
 * @param {number} at the stop that the vehicle goes on from
 * @param {number} share how far it has come from there to the next
 */
export function travelled(way, stops, at, share) {
  const reached = indexesOf(way, stops);
  const [from, to] = [reached[at], reached[at + 1] ?? reached[at]];
  return [...way.slice(0, from), ...partOf(way.slice(from, to + 1), share)];
}

/** The place on a way that is nearest to each stop, after that of the stop before. */
function indexesOf(way, stops) {
  let least = 0;
  return stops.map((stop) => {
    for (let at = least; at < way.length; at++) if (distance(way[at], stop) < distance(way[least], stop)) least = at;
    return least;
  });
}

/** The first part of a line, by its length. */
function partOf(line, share) {
  const lengths = line.slice(1).map((place, at) => distance(line[at], place));
  let left = share * lengths.reduce((sum, each) => sum + each, 0);
  const part = line.slice(0, 1);
  for (const [at, length] of lengths.entries()) {
    if (left <= 0) break;
    const [from, to] = [line[at], line[at + 1]];
    const far = Math.min(left / length, 1) || 0;
    part.push(far === 1 ? to : from.map((value, axis) => value + far * (to[axis] - value)));
    left -= length;
  }
  return part;
}

const distance = ([x, y], [u, v]) => Math.hypot(x - u, y - v);
