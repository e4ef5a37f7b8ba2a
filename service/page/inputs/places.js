/** Tell where the stops of a request lie: on the earth, in the planes of its objectives, or nowhere. */

/** Cities as text: a row of four numbers on each line. */
export const textOf = (rows) => rows.map((row) => row.join(", ")).join("\n");

/** Whether the row can be drawn. */
export const isCity = (row) => row.length === 4 && row.every(Number.isFinite);

/** Marks a map of the earth, in place of the number of an objective's plane. */
export const EARTH = "earth";

/**
 * The maps of a request: `drawn` has EARTH, or the objective of the plane (0 or 1), for each map, and
 * `rows` has the places of each stop on all maps, two numbers per map. Beside a map of the earth, or of
 * the first objective's plane, there is a second map if the second objective has a plane.
 */
export function mapsOf({ stops = [], objectives }) {
  const located = stops.map(({ location }) => location);
  const planes = [0, 1].map((axis) => objectives?.[axis]?.coordinates);
  const places = new Map([[EARTH, located], ...planes.entries()]);
  const known = [...places.keys()].filter((each) => arePlaces(places.get(each), stops.length));
  const second = known.length > 1 && known.includes(1) ? [1] : [];
  const drawn = [...known.slice(0, 1), ...second];
  return { drawn, rows: drawn.length ? stops.map((_, row) => drawn.flatMap((each) => places.get(each)[row])) : [] };
}

const arePlaces = (rows, count) =>
  Array.isArray(rows) && rows.length === count && rows.every((row) => Array.isArray(row) && row.length === 2 && row.every(Number.isFinite));
