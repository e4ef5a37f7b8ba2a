/** Say how far a vehicle has come, and what it has on board. */

import { counted } from "../common/numbers.js";
import { knownFleet } from "../fleet/known_fleet.js";
import { doneOf, leftOf } from "./progress.js";

/**
 * The sentence about a vehicle beside its name.
 *
 * @param {object} van as of `progressOf`
 * @param {{ isOutOfService: boolean, clock: object | null, known: object, vehicle: string }} day the request by `knownFleet`, and
 *   the type of the vehicle
 */
export function vanSaid(van, { isOutOfService, clock, known, vehicle }) {
  const load = van.isOut && !van.isBack ? onBoard(van, known, vehicle) : "";
  const where = whereOf(van, clock);
  if (!isOutOfService || van.isBack) return load ? `${where}; load ${ofCapacity(load, known, vehicle)}` : where;
  return `${where}; ${/[1-9]/.test(load) ? `others bring its load of ${load}, which they load anew, not from this vehicle` : "others take over its stops still to visit"}`;
}

/** What is on board of what a vehicle holds, such as "9 of 22". */
function ofCapacity(load, { types }, vehicle) {
  const { capacity } = types.get(vehicle);
  return load.split(", ").map((each, kind) => `${each} of ${capacity[kind]}`).join(", ");
}

function whereOf(van, clock) {
  const { visits, at, share, leaves, isOut, isBack } = van;
  const all = doneOf(van).length + leftOf(van).length;
  const done = doneOf(van).length - isThere(van);
  if (!isOut) return clock ? `sets off at ${clock.said(visits[0].leaves)}` : "has not set off";
  if (isBack) return `all ${all} done${visits[at].kind === "end" ? `, back at ${visits[at].stop}` : ""}`;
  const next = visits.slice(at + 1).find(({ done: isDone }) => !isDone);
  const where = share >= 1 ? `waits at ${next.stop}` : share > 0 ? `on the way to ${next.stop}` : `at ${visits[at].stop}${leaves === null ? "" : ` until ${clock.said(leaves)}`}`;
  return `${done} of ${all} done, ${where}`;
}

/**
 * What a vehicle has on board for the stops still to visit until it loads again, and from those that gave something back, one number for each kind
 * of load; "" without a capacity.
 */
export function onBoard({ visits }, { stops, types, pickups }, vehicle) {
  const { capacity } = types.get(vehicle) ?? {};
  if (!capacity) return "";
  const loading = visits.findIndex(({ kind, done }) => kind === "loading" && !done);
  const trip = loading < 0 ? visits : visits.slice(0, loading);
  const [done, pickedUp] = [new Set(visits.filter((visit) => visit.done).map(({ stop }) => stop)), new Set(pickups.values())];
  const carried = trip.filter(({ stop, kind, done: isDone }) => kind === "visit" && !isDone && !pickedUp.has(stop) && (!pickups.has(stop) || done.has(pickups.get(stop))));
  const demand = ({ stop }, axis) => stops.get(pickups.get(stop) ?? stop)?.demand?.[axis] ?? 0;
  const back = visits.filter(({ kind, done: isDone }) => kind === "visit" && isDone);
  const taken = ({ stop }, axis) => stops.get(stop)?.pickup?.[axis] ?? 0;
  const sum = (each, of, axis) => each.reduce((all, visit) => all + of(visit, axis), 0);
  return capacity.map((_, axis) => sum(carried, demand, axis) + sum(back, taken, axis)).join(", ");
}

const NO_LOADING =
  "All vehicles are on their way, and none loads again today: nobody can bring new orders with a load, or what a vehicle out of service has on board. Before you plan the next day, tick “Vehicles load again at the depot” above the stops.";

/**
 * Says that nobody can bring what must be loaded first; "" if somebody can, or nothing is loaded.
 *
 * @param {object[]} vans as of `progressOf`, with their `routes`
 * @param {{ vehicles: object[], stops: object[] }} asked the request
 * @param {Set<string>} out vehicles that are out of service, by name
 */
export function loadingSaid(vans, routes, { vehicles, stops }, out) {
  if (!stops.some(({ demand }) => demand?.some((amount) => amount > 0))) return "";
  const loads = (id) => vehicles.some((each) => each.id === id && each.reload?.length);
  const { types } = knownFleet({ stops, vehicles });
  const isHome = ({ isBack, visits, at }, { vehicle }) => isBack && visits[at].kind === "end" && visits[at].stop === types.get(vehicle)?.start;
  const isSpare = ({ id, count = 1 }) => routes.filter(({ vehicle }) => vehicle === id).length < count;
  const canLoad = vans.some((van, at) => !out.has(van.name) && (!van.isOut || isHome(van, routes[at]) || loads(routes[at].vehicle))) || vehicles.some(isSpare);
  return canLoad ? "" : NO_LOADING;
}

/** Whether a vehicle is at a stop whose visit has begun, and is not over: it counts as done for what is planned anew. */
export const isThere = ({ visits, at, leaves }) => leaves !== null && visits[at].kind === "visit";

/** How many stops are done by now, and how to change that; `isPlanned` says whether all of that is by the plan. */
export function doneSaid(vans, now, isPlanned) {
  const [done, toVisit] = [doneOf, leftOf].map((of) => vans.flatMap(of).length);
  const there = vans.filter(isThere).length;
  const far = now === null ? "Say what time it is, or mark what is done." : `${done - there} of ${counted(done + toVisit, "stop is", "stops are")} done by then${there ? `, and ${counted(there, "vehicle is", "vehicles are")} at a stop` : ""}${isPlanned ? ", if all went as planned" : ""}.`;
  return `${far} Press a stop to mark it as done or as not done, and × to cancel it.`;
}
