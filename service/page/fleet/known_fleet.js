/** Look up the stops and vehicles of a request for a fleet by their ids. */

import { SECONDS } from "../common/durations.js";
import { clockUnit } from "./units.js";

const DAY = 86400; // seconds

/**
 * The stops and the types of vehicles of a request by id, as far as it is known. Each type has its
 * `start`, `end` and `reload` as ids of stops, and its `shifts`. `pickups` maps
 * the stop of each delivery to that of its pick-up. `slack` is how long before a window closes its stop is reached. `firsts` maps
 * each stop to those that must be done before its visit begins, whoever drives.
 */
export function knownFleet({ stops = [], vehicles = [], shipments, before, slack = 0 }) {
  const idOf = (stop) => (typeof stop === "number" ? stops[stop]?.id : stop);
  const typed = vehicles.map(({ id, start, end, reload = [], shift, shifts = shift ? [shift] : [], ...others }) => {
    return [id, { ...others, start: idOf(start), end: idOf(end), reload: reload.map(idOf), shifts }];
  });
  const pickups = new Map((shipments ?? []).map(({ pickup, delivery }) => [idOf(delivery), idOf(pickup)]));
  const firsts = new Map();
  for (const { first, then, vehicles: of } of before ?? []) {
    for (const stop of of === "any" ? then.map(idOf) : []) firsts.set(stop, [...new Set([...(firsts.get(stop) ?? []), ...first.map(idOf)])]);
  }
  return { stops: new Map(stops.map((stop) => [stop.id, stop])), types: new Map(typed), pickups, firsts, slack };
}

/** The day of each shift of a type of vehicles, from 1; null if that is not known, or two are on the same day. */
export function daysOf(request, vehicle) {
  const second = SECONDS.get(clockUnit(request));
  const { shifts = [] } = knownFleet(request).types.get(vehicle) ?? {};
  const days = shifts.map(([begin]) => Math.floor((begin * second) / DAY) + 1);
  return second && days.length && new Set(days).size === days.length ? days : null;
}
