/** Describe what is asked for, and make the request for it. */

import { describedFleet, describedRobots } from "../fleet/fleet_request.js";
import { formOf, kindOf } from "../common/kinds.js";
import { counted } from "../common/numbers.js";
import { DISTANCE, DURATION, UNNAMED, namesIn, unnamed } from "../common/objectives.js";
import { framed } from "./map_ends.js";
import { isCity, nameOf } from "./places.js";
import { Problem } from "../planning/service.js";

const COUNTS = { 2: "Two", 3: "Three", 4: "Four" };
const PLANE = 2; // numbers of a place
// Two matrices of more fill the longest body that a service takes, and the browser's memory.
const MOST_ROUNDED = 1500;

/** Describes what was opened that cannot be typed. */
export function described(asked) {
  const { grid, matrices, places } = asked;
  const { onGrid, movers } = kindOf(asked);
  if (!onGrid && movers) return describedFleet(asked);
  if (!onGrid && matrices) return `${COUNTS[matrices.length] ?? matrices.length} matrices of ${counted(matrices[0]?.length ?? 0, "stop", "stops")}.`;
  if (!onGrid) return formOf(asked) ? "" : "The link only names a result: the places of its stops are not known.";
  const where = places ? `${places.length} places` : "places laid out by the spacing";
  const map = `grid ${grid[0]?.length ?? 0} cells wide and ${grid.length} high; ${where}.`;
  return movers ? describedRobots(asked, `a ${map}`) : `A ${map}`;
}

/**
 * The request as the page opens it. Beside coordinates or matrices it may have `rounded`, the `ids` of the
 * stops, and `names`: the user's names of both objectives. Beside a grid it may have `unknownCells`, and the cost layer by which it
 * is `shaded`, to draw them. Beside stops of any form it may have their `details` for drivers.
 */
export function askedFor(opened, settings, { rows, whole }) {
  const asked = framed({ ...opened, ...settings });
  return formOf(opened) === "coordinates" ? { ...asked, coordinates: rows, rounded: whole } : asked;
}

/** A text that two requests have in common if they are the same, whatever the order of their members. */
export const keyOf = (asked) => JSON.stringify(Object.entries(asked).sort(([one], [other]) => (one < other ? -1 : 1)));

/** The request to send to the service. */
export function requestFor({ rounded: whole, ids, names, unknownCells: _, shaded: __, details: ___, ...body }) {
  const { path, onGrid } = kindOf(body);
  const form = formOf(body);
  if (onGrid) return { path, body: { ...body, paths: true } };
  // A row that is not a city is sent as it is, so that the service can name it.
  const planes = form === "coordinates" && whole && body.coordinates.length && body.coordinates.every(isCity);
  const short = planes ? { ...without(body, "coordinates"), matrices: wholeDistances(body.coordinates) } : body;
  return { path, body: (ids || names) && form && form !== "stops" ? long(short, ids, names) : short };
}

/** The names of the objectives of more than two matrices or of cost layers; undefined for any other request. */
export function ownNames({ matrices, cost_layers: layers, departure }) {
  if (layers) return namesIn({ objectives: [departure == null ? DISTANCE : DURATION, ...layers] });
  return matrices?.length > 2 ? matrices.map((_, axis) => unnamed(axis)) : undefined;
}

/** A request whose rows have more than two planes, as stops under objectives with a plane each; any other as it is. */
export function inPlanes(request) {
  const { coordinates, names, ids, ...others } = request;
  const columns = coordinates?.[0]?.length ?? 0;
  if (formOf(request) !== "coordinates" || columns <= 2 * PLANE) return request;
  const planes = Array.from({ length: columns / PLANE }, (_, axis) => coordinates.map((row) => row.slice(PLANE * axis, PLANE * (axis + 1))));
  const objectives = planes.map((plane, axis) => ({ name: (names?.[axis] ?? unnamed(axis)).name, coordinates: plane }));
  return { ...others, stops: coordinates.map((_, city) => ({ id: nameOf(ids, city) })), objectives };
}

/** The long form of a request, in which stops have ids and objectives have names. */
function long({ coordinates, matrices, ...others }, ids, names = UNNAMED) {
  const cities = (coordinates ?? matrices[0]).length;
  const sources = names.map((_, axis) =>
    matrices ? { matrix: matrices[axis] } : { coordinates: coordinates.map((row) => row.slice(2 * axis, 2 * axis + 2)) },
  );
  return {
    stops: Array.from({ length: cities }, (_, city) => ({ id: nameOf(ids, city) })),
    objectives: names.map(({ name, unit }, axis) => ({ name, ...(unit && { unit }), ...sources[axis] })),
    ...others,
  };
}

/** Stops that only have places in both planes, as rows that can be edited: the reverse of `long`. */
export function inRows(request) {
  const { stops, objectives, ...others } = request;
  const planes = objectives?.length === 2 ? objectives.map(({ coordinates }) => coordinates) : [];
  const inPlanes = stops && planes.length && planes.every((plane) => isPlane(plane, stops.length));
  if (!inPlanes || formOf(request) !== "stops" || stops.some((stop) => Object.keys(stop).join() !== "id")) return request;
  const coordinates = planes[0].map((place, row) => [...place, ...planes[1][row]]);
  return { ...others, coordinates, ids: stops.map(({ id }) => id), names: namesIn(request) };
}

const isPlane = (rows, count) => Array.isArray(rows) && rows.length === count && rows.every((row) => Array.isArray(row) && row.length === 2);
export const without = (members, ...names) => Object.fromEntries(Object.entries(members).filter(([each]) => !names.includes(each)));

function wholeDistances(rows) {
  if (rows.length > MOST_ROUNDED) {
    const detail = `distances can be rounded between at most ${MOST_ROUNDED} cities, got ${rows.length}`;
    throw new Problem({ code: "too-many-cities", detail, errors: [{ pointer: "/coordinates", detail }] });
  }
  return [0, 2].map((axis) => rounded(rows.map((row) => row.slice(axis, axis + 2))));
}

/** Distances in a plane from each place to each, as TSPLIB's EUC_2D has them: rounded to whole numbers. */
const rounded = (places) =>
  places.map((from) => places.map((to) => Math.floor(distance(from, to) + 0.5)));

/** Not Math.hypot, whose last digit may be another, and decide what a half is rounded to. */
function distance([x, y], [u, v]) {
  return Math.sqrt((x - u) * (x - u) + (y - v) * (y - v));
}
