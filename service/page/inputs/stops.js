/** Change the stops of a request and, with them, its costs: rename, move, add, delete. */

import { detailsWithAnother, detailsWithout } from "./details.js";
import { EARTH, mapsOf } from "./places.js";

/** Whether all costs and times of a request are known for a stop at any place. */
export const isMeasured = (asked) => Boolean(asked.objectives?.every(({ from, measure }) => from || measure)) && !hasOwnTimes(asked);

/** The members of an objective or a clock that hold costs of each stop, as a file brings them. */
export const OWN_COSTS = ["matrix", "matrices", "coordinates", "slices", "breakpoints", "days"];

const hasOwnTimes = ({ clock }) => OWN_COSTS.some((name) => clock?.[name]);

/** Whether some costs or times of a request are those of a matrix, and not measured between places. */
export const isPriced = ({ objectives = [], clock }) => [...objectives, clock].some((each) => OWN_COSTS.some((name) => name !== "coordinates" && each?.[name]));

/** The same request with other stops; objectives and a clock keep the rows and columns of `kept`. */
function withStops(asked, stops, kept) {
  const { objectives, clock } = asked;
  const timed = hasOwnTimes(asked) && { clock: costsOf(clock, kept) };
  return { ...asked, stops, objectives: objectives?.map((objective) => costsOf(objective, kept)), ...timed };
}

function costsOf(objective, kept) {
  const between = (rows) => kept.map((from) => kept.map((to) => rows[from][to]));
  const each = (items) => items.map((item) => costsOf(item, kept));
  const change = { matrix: between, breakpoints: between, coordinates: (rows) => kept.map((row) => rows[row]), slices: each, matrices: each, days: each };
  if (Array.isArray(objective.spread)) change.spread = between;
  return Object.fromEntries(Object.entries(objective).map(([name, value]) => [name, value && change[name] ? change[name](value) : value]));
}

export function renamed(asked, row, id) {
  const before = asked.stops[row].id;
  const stops = asked.stops.map((stop, at) => (at === row ? { ...stop, id } : stop));
  const ends = ["start", "end"].filter((end) => asked[end] === before).map((end) => [end, id]);
  return { ...asked, stops, ...Object.fromEntries(ends) };
}

/** The request with one of the two numbers of a stop's location changed. */
export function moved(asked, row, column, value) {
  const stops = asked.stops.map((stop, at) =>
    at === row ? { ...stop, location: (stop.location ?? [0, 0]).with(column, value) } : stop,
  );
  return { ...asked, stops };
}

/** The request with a stop moved on the first or second of its maps. */
export function put(asked, map, row, place) {
  const plane = mapsOf(asked).drawn[map];
  if (plane === EARTH) return { ...asked, stops: asked.stops.with(row, { ...asked.stops[row], location: place }) };
  const objective = asked.objectives[plane];
  const coordinates = objective.coordinates.with(row, place);
  return { ...asked, objectives: asked.objectives.with(plane, { ...objective, coordinates }) };
}

export function without(asked, row) {
  const kept = asked.stops.map((_, at) => at).filter((at) => at !== row);
  return { ...withStops(asked, kept.map((at) => asked.stops[at]), kept), ...detailsWithout(asked, row) };
}

/** The request with one more stop; its costs are known to measured objectives only. */
export const withAnother = (asked, id, location) => ({ ...asked, stops: [...asked.stops, { id, location }], ...detailsWithAnother(asked) });
