/** Compute what a vehicle does at each stop of its route, and when. */

import { breaksAt } from "./breaks.js";

const UNKNOWN = { reload: [], shifts: [] }; // the rules of a type of vehicles that is not known
const NEAR = 1e-6; // times that differ by less, relative to them, are equal

/**
 * What a vehicle does at each stop of a route: `kind` is start, visit, loading (again) or end;
 * `begin` and `end` are those of the visit, after the vehicle has arrived and waited; `waiting` is how long it waits before,
 * `rests` are breaks there, each `[from, to]`, and `leaves` is when it goes on; `due` is when a visit should begin, or a shift
 * ends, and `late` how much later that is; it is `wanted` from then on, if it is, and `early` says how much earlier that is; `windows` are those of the stop, and it `opens` when the visit begins, if it was
 * closed before, and `closes` after that, and must be reached `by` then; `released` is when the last load of the trip that begins there is released, 0
 * without one; `shift` is when the shift of a vehicle that starts there begins; `firsts` are the stops that must be done before, if
 * the visit waits for one of them.
 *
 * @param {{ vehicle: string, stops: string[], arrivals: number[], ends?: number[], breaks?: number[], shift?: number }} route
 * @param {{ stops: Map<string, object>, types: Map<string, object>, firsts: Map<string, string[]>, slack: number }} known the request, by `knownFleet`
 */
export function visitTimes(route, { stops: asked, types, firsts, slack }) {
  const { stops, arrivals, shift = 0 } = route;
  const type = types.get(route.vehicle) ?? UNKNOWN;
  const kinds = kindsOf(route, type);
  const breaks = breaksAt(route, type.breaks ?? []);
  const [from, to] = type.shifts[shift] ?? [];
  return stops.map((stop, at) => {
    const kind = kinds[at];
    const { service = 0, window, windows = window ? [window] : [], due } = kind === "visit" ? (asked.get(stop) ?? {}) : {};
    const released = kind === "start" || kind === "loading" ? releaseOf(at, stops, kinds, asked) : 0;
    const waitsFor = kind === "visit" ? firsts.get(stop) : undefined;
    const since = waitsFor && route.ends ? route.ends[at] - service : 0; // only the service knows when others are done
    const ready = (time) => (kind === "loading" ? Math.max(time, released) : Math.max(opened(windows, time), since));
    const times = timesAt(arrivals[at], ready, service, breaks[at]);
    const [wanted, until] = Array.isArray(due) ? due : [undefined, due ?? (kind === "end" ? to : undefined)];
    const opens = windows.find(([opening]) => Math.abs(times.begin - opening) <= NEAR * opening)?.[0];
    const closes = openIn(windows, times.begin)?.[1];
    return { stop, kind, ...times, wanted, early: laterBy(wanted ?? times.begin, times.begin), due: until, late: laterBy(times.begin, until), windows, opens, closes, by: closes - slack, released, firsts: laterBy(times.begin, opened(windows, times.arrival)) ? waitsFor : undefined, shift: kind === "start" && !isOnTheWay(route) ? from : undefined };
  });
}

/** The times at a stop whose visit begins when it is `ready` at a time. A break that begins before a visit is over is taken before it. */
function timesAt(arrival, ready, service, rests) {
  let [time, waiting] = [arrival, 0];
  for (const [from, to] of rests) {
    if (from >= ready(time) + service) break;
    waiting += from - time;
    time = to;
  }
  const begin = ready(time);
  const end = begin + service;
  waiting += begin - time;
  return { arrival, begin, end, rests, waiting: waiting > NEAR * begin ? waiting : 0, leaves: Math.max(end, rests.at(-1)?.[1] ?? end) };
}

/** The `kind` of each stop of a route of this type of vehicles. A vehicle that is replanned on its way starts where it is. */
export function kindsOf(route, { start, end, reload } = UNKNOWN) {
  return route.stops.map((stop, at) => {
    if (at === 0 && (stop === start || isOnTheWay(route))) return "start";
    if (at === route.stops.length - 1 && stop === end) return "end";
    return reload.includes(stop) ? "loading" : "visit";
  });
}

/** Whether a route is the rest of one that was planned before. */
export const isOnTheWay = ({ route }) => route !== undefined;

/** When a visit may begin after an arrival: in the first window that is not over then. */
function opened(windows, arrival) {
  return Math.max(arrival, openIn(windows, arrival)?.[0] ?? arrival);
}

/** The first window that is not over at a time; undefined if there is none. */
const openIn = (windows, time) => windows.find(([, closes]) => closes >= time * (1 - NEAR));

/** When the last load of the trip that begins at this place is released. */
function releaseOf(at, stops, kinds, asked) {
  const next = kinds.findIndex((kind, place) => place > at && kind !== "visit");
  const trip = stops.slice(at + 1, next < 0 ? stops.length : next);
  return trip.reduce((latest, stop) => Math.max(latest, asked.get(stop)?.release ?? 0), 0);
}

const laterBy = (begin, due) => (due === undefined || begin - due <= NEAR * Math.max(1, Math.abs(begin)) ? 0 : begin - due);
