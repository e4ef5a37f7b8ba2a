/** The routes of a plan by vehicle or robot: their names, and how much they visit and carry. */

import { length } from "../common/numbers.js";
import { daysOf, knownFleet } from "./known_fleet.js";
import { isOnTheWay } from "./visit_times.js";

/**
 * The name of each route: that of its vehicle or robot, and its shift; or the `name` that it had in the plan before.
 *
 * @param {object} asked the request, as far as it is known
 */
export const namesOf = (routes, movers, asked) =>
  moversOf(routes, movers, asked).map((name, at) => routes[at].name ?? (routes[at].shift === undefined ? name : `${name}, ${shiftOf(routes[at], asked)}`));

/**
 * The name of each route's vehicle or robot: its id, with a number if several routes have the same id and shift.
 * A number is left out if there is a vehicle of that name: beside "van 1", two vehicles "van" are "van 2" and "van 3".
 */
export function moversOf(routes, { by }, { vehicles = [] }) {
  const taken = new Set([...routes.map((route) => route[by]), ...vehicles.map((type) => type?.id)]);
  const last = new Map(); // the number given last, by id and shift
  const alike = (one, other) => one[by] === other[by] && one.shift === other.shift;
  return routes.map((route) => {
    const { [by]: name, shift } = route;
    if (routes.filter((other) => alike(route, other)).length === 1) return name;
    const key = JSON.stringify([name, shift]);
    let number = (last.get(key) ?? 0) + 1;
    while (taken.has(`${name} ${number}`)) number += 1;
    last.set(key, number);
    return `${name} ${number}`;
  });
}

/** The shift of a route: its day, if each shift of its vehicle is on another day, or its number. */
function shiftOf({ vehicle, shift }, asked) {
  const days = daysOf(asked, vehicle);
  return days ? `day ${days[shift]}` : `shift ${shift + 1}`;
}

/** How many stops a route visits, beside those at which it starts, ends and loads again. */
export function visits(route, { through }, asked) {
  const stops = route[through];
  const ends = endsOf(route, asked);
  const round = stops.length > 1 && stops[0] === stops.at(-1);
  const { reload = [] } = knownFleet(asked).types.get(route.vehicle) ?? {};
  const loads = reload.length ? stops.slice(1, -1).filter((stop) => reload.includes(stop)).length : 0;
  if (isOnTheWay(route)) return stops.length - loads - 1 - (stops.length > 1 && ends?.[1] != null);
  return stops.length - loads - (ends ? ends.filter((end) => end != null).length : round ? 2 : 0);
}

/**
 * The most load that a vehicle has on board at once, of its capacity, such as "18 of 20", or "18 of 20 at once" if it loads
 * again: one for each kind of load. "" if it has no capacity.
 */
export function loadOf(route, { stops: asked, types, pickups }) {
  const { vehicle } = route;
  const stops = isOnTheWay(route) ? route.stops.slice(1) : route.stops; // where it is, it has been
  const { capacity, reload, initial_load: initial } = types.get(vehicle) ?? {};
  const loads = (capacity ?? []).map((most, kind) => {
    const demand = (stop) => asked.get(stop)?.demand?.[kind] ?? 0;
    const taken = (stop) => asked.get(stop)?.pickup?.[kind] ?? 0;
    const carried = tripsIn(stops, reload).map((trip, at) => onBoard(trip, { demand, taken }, pickups, at ? 0 : (initial?.[kind] ?? 0)));
    return `${length(Math.max(...carried))} of ${length(most)}${carried.length > 1 ? " at once" : ""}`;
  });
  return loads.join(", ");
}

/** The stops of each trip: another one begins where the vehicle loads again. */
function tripsIn(stops, reload = []) {
  const trips = [[]];
  for (const [at, stop] of stops.entries()) {
    if (at && reload.includes(stop)) trips.push([]);
    else trips.at(-1).push(stop);
  }
  return trips;
}

/** The most on board on a trip. What is not picked up on the way is on board from its start; what a stop gives back stays to the end. */
function onBoard(trip, { demand, taken }, pickups, initial) {
  const picked = new Set(pickups.values());
  const change = (stop) => (picked.has(stop) ? demand(stop) : taken(stop) - demand(pickups.get(stop) ?? stop));
  let load = trip.reduce((sum, stop) => (picked.has(stop) || pickups.has(stop) ? sum : sum + demand(stop)), initial);
  return Math.max(load, ...trip.map((stop) => (load += change(stop))));
}

/** Where the request wants a route to start and end; undefined if that is not known. */
function endsOf({ vehicle, robot }, { vehicles = [], robots = [], closed }) {
  const type = vehicles.find(({ id }) => id === vehicle);
  if (type) return [type.start, type.end];
  const one = robots.find(({ id }) => id === robot);
  const start = one?.start_pose ?? one?.start ?? 0;
  return one && [start, closed === false ? (one.end_pose ?? one.end) : start];
}
