/** A fleet's request: in a few words, as JSON, and where its stops lie. */

import { counted } from "../common/numbers.js";

export function describedFleet({ vehicles, stops }) {
  const count = vehicles.reduce((all, each) => all + (each?.count ?? 1), 0);
  const fleet = `${counted(count, "vehicle", "vehicles")} and ${counted(stops?.length ?? 0, "stop", "stops")}`;
  return `A fleet: ${fleet}. Fleets are shown here and not edited: change the request’s JSON, and open it again.`;
}

/** The request as JSON, costs and planes in a few words. */
export function jsonOf(asked) {
  const short = (name, value) =>
    ["matrix", "coordinates"].includes(name) && Array.isArray(value)
      ? `${value.length} rows of ${value[0]?.length ?? 0} numbers`
      : value;
  return JSON.stringify(asked, short, 1);
}

/** Longitude and latitude of the stops, or without them their places in an objective's plane; none without either. */
export function placesOf({ stops = [], objectives }) {
  const located = stops.map(({ location }) => location);
  if (arePlaces(located)) return { places: located, onEarth: true };
  const sources = Array.isArray(objectives) ? objectives : [];
  const plane = sources.map((each) => each?.coordinates).find((rows) => arePlaces(rows) && rows.length === stops.length);
  return { places: plane ?? [], onEarth: false };
}

const arePlaces = (rows) =>
  Array.isArray(rows) && rows.every((row) => Array.isArray(row) && row.length === 2 && row.every(Number.isFinite));
