/** The kinds of plans: looked up for a request by its members, or for an answer by its `kind`. */

import { KINDS as LISTED } from "./kinds_table.js";

const capital = (word) => word[0].toUpperCase() + word.slice(1);

// The names of vehicles or robots on the page; the members of a route with its mover and its visits; and how Python prints it.
const moversOf = ({ mover, visits, stops }) => ({
  one: capital(mover), many: `${capital(mover)}s`, words: `${mover}s`, stops: capital(stops), listed: `${capital(stops)} of each ${mover}`,
  by: mover, through: visits, printed: visits === "stops" ? "route.stops" : `(route.${mover}, route.${visits}.tolist())`,
});

// The `path` of HTTP, the `call` in Python, and the `noun` of what a front holds: tours, or plans with routes of `movers`.
const KINDS = Object.fromEntries(
  Object.entries(LISTED).map(([name, kind]) => {
    const noun = { one: kind.item, many: `${kind.item}s` };
    return [name, { path: kind.path, call: name, noun, onGrid: kind.onGrid, ...(kind.mover && { movers: moversOf(kind) }) }];
  }),
);

/** The kind of an answer. */
export const kindNamed = ({ kind }) => KINDS[kind];

/** The kind of a request; that of a front if nothing is known. */
export const kindOf = ({ vehicles, grid, robots }) =>
  KINDS[Array.isArray(vehicles) ? "fleet" : !grid ? "front" : Array.isArray(robots) ? "robots" : "coverage"];

/** The member with the stops in a request for a front; null for other kinds, or if it is not known. */
export const formOf = (request) =>
  (kindOf(request) === KINDS.front && ["matrices", "coordinates", "stops"].find((member) => request[member])) || null;
