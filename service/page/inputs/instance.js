/** The kinds of instance (planes, matrices, grid, stops, or not known) and the requests for them. */

import { isCity, rowsOf } from "./cities.js";
import { rounded } from "./distances.js";
import { counted } from "../common/numbers.js";
import { Problem } from "../planning/service.js";

// Two matrices of more fill the longest body that a service takes, and the browser's memory.
const MOST_ROUNDED = 1500;

export const kindOf = ({ grid, matrices, coordinates, stops }) =>
  grid ? "grid" : matrices ? "matrices" : coordinates ? "coordinates" : stops ? "stops" : "unknown";

/** In a few words, what was brought that cannot be typed. */
export function described(asked) {
  const { grid, matrices, places, stops } = asked;
  if (kindOf(asked) === "unknown") return "The link names a front alone: where its stops lie is not known here.";
  if (stops) return `${counted(stops.length, "stop", "stops")} with ids.`;
  if (matrices) return `Two matrices of ${matrices[0]?.length ?? 0} cities.`;
  const where = places ? `${places.length} places` : "places laid out by the spacing";
  return `A grid of ${grid.length} by ${grid[0]?.length ?? 0} cells; ${where}.`;
}

/**
 * What is asked for, as the page opens it: a request, beside whose coordinates `rounded` may stand.
 * It is what was opened, with the settings and the cities as they have become since.
 */
export function askedFor(opened, settings, { text, whole }) {
  const asked = { ...opened, ...settings };
  return kindOf(opened) === "coordinates" ? { ...asked, coordinates: rowsOf(text), rounded: whole } : asked;
}

/** The request by which the service is asked for it. */
export function requestFor({ rounded: whole, ...body }) {
  const kind = kindOf(body);
  if (kind === "grid") return { path: "coverage", body: { ...body, paths: true } };
  if (kind !== "coordinates" || !whole) return { path: "front", body };
  const { coordinates, ...others } = body;
  // A row that is no city is named by the service, which wants to see it for that.
  if (!coordinates.length || !coordinates.every(isCity)) return { path: "front", body };
  return { path: "front", body: { matrices: wholeDistances(coordinates), ...others } };
}

function wholeDistances(rows) {
  if (rows.length > MOST_ROUNDED) {
    const detail = `distances can be rounded between at most ${MOST_ROUNDED} cities, got ${rows.length}`;
    throw new Problem({ code: "too-many-cities", detail, errors: [{ pointer: "/coordinates", detail }] });
  }
  return [0, 2].map((axis) => rounded(rows.map((row) => row.slice(axis, axis + 2))));
}
