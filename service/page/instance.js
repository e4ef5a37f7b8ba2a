/** What is planned: cities in two planes, two matrices of costs, or places on a grid. */

import { rowsOf } from "./cities.js";

export const kindOf = (members) =>
  members.grid ? "grid" : members.matrices ? "matrices" : "coordinates";

/** In a few words, what was brought that cannot be typed. */
export function described({ grid, matrices, places }) {
  if (matrices) return `Two matrices of ${matrices[0]?.length ?? 0} cities.`;
  const where = places ? `${places.length} places` : "places laid out by the spacing";
  return `A grid of ${grid.length} by ${grid[0]?.length ?? 0} cells; ${where}.`;
}

/** The request for an instance: its members, those that are set, and the cities as typed. */
export function requestFor(members, settings, text) {
  const body = { ...members, ...settings };
  const kind = kindOf(members);
  if (kind === "grid") return { path: "coverage", body: { ...body, paths: true } };
  return { path: "front", body: kind === "matrices" ? body : { coordinates: rowsOf(text), ...body } };
}
