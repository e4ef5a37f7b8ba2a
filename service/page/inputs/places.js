/** Tell how the stops of a request are named, and where they lie: on the earth, in the planes of its objectives, or nowhere. */

/** The name of a stop: its id, or if stops have none, its number from 1. */
export const nameOf = (ids, city) => ids?.[city] ?? String(city + 1);

/** How a request refers to the stop that is named: by its id or its index; the text itself if it is neither. */
export function stopNamed(ids, name) {
  if (ids?.includes(name)) return name;
  return !ids && /^\d+$/.test(name) && Number(name) > 0 ? Number(name) - 1 : name;
}

/** Cities as text: a row of four numbers on each line. */
export const textOf = (rows) => rows.map((row) => row.join(", ")).join("\n");

/** A coordinate of a place that was pointed at, without digits that nobody can point to. */
export const rounded = (value) => Number(value.toPrecision(7));

/** Whether the row can be drawn. */
export const isCity = (row) => row.length === 4 && row.every(Number.isFinite);

/** Has a map move only if stops that were typed have left its view, or have become a small part of it. */
export const IF_LOST = "if lost";

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
