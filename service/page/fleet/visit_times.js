/** Compute what a vehicle does at each stop of its route, and when. */

const NEAR = 1e-6; // times that differ by less, relative to them, are equal

/**
 * What a vehicle does at each stop of a route: `kind` is start, visit, loading (again) or end;
 * `begin` is when it has arrived and waited; `due` is when a visit should begin, or a shift ends,
 * and `late` how much later that is; `windows` are those of the stop; `released` is when the last
 * load of the trip that begins there is released, 0 without one.
 *
 * @param {{ vehicle: string, stops: string[], arrivals: number[], shift?: number }} route
 * @param {{ stops: Map<string, object>, types: Map<string, object> }} known the request, by `knownFleet`
 */
export function visitTimes({ vehicle, stops, arrivals, shift = 0 }, { stops: asked, types }) {
  const type = types.get(vehicle) ?? { reload: [], shifts: [] };
  const kinds = stops.map((stop, at) => kindOf(stop, at, stops.length - 1, type));
  return stops.map((stop, at) => {
    const [kind, arrival] = [kinds[at], arrivals[at]];
    const { service = 0, window, windows = window ? [window] : [], due } = kind === "visit" ? (asked.get(stop) ?? {}) : {};
    const released = kind === "start" || kind === "loading" ? releaseOf(at, stops, kinds, asked) : 0;
    const begin = kind === "loading" ? Math.max(arrival, released) : opened(windows, arrival);
    const until = due ?? (kind === "end" ? type.shifts[shift]?.[1] : undefined);
    return { stop, kind, arrival, begin, end: begin + service, due: until, late: laterBy(begin, until), windows, released };
  });
}

function kindOf(stop, at, last, { start, end, reload }) {
  if (at === 0 && stop === start) return "start";
  if (at === last && stop === end) return "end";
  return reload.includes(stop) ? "loading" : "visit";
}

/** When a visit may begin after an arrival: in the first window that is not over then. */
function opened(windows, arrival) {
  const open = windows.find(([, closes]) => closes >= arrival * (1 - NEAR));
  return Math.max(arrival, open?.[0] ?? arrival);
}

/** When the last load of the trip that begins at this place is released. */
function releaseOf(at, stops, kinds, asked) {
  const next = kinds.findIndex((kind, place) => place > at && kind !== "visit");
  const trip = stops.slice(at + 1, next < 0 ? stops.length : next);
  return trip.reduce((latest, stop) => Math.max(latest, asked.get(stop)?.release ?? 0), 0);
}

const laterBy = (begin, due) => (due === undefined || begin - due <= NEAR * Math.max(1, Math.abs(begin)) ? 0 : begin - due);
