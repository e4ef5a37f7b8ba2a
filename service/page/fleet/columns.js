/** The columns of the tables of a fleet, and which of them are shown. */

import { SECONDS } from "../common/durations.js";
import { clockUnit, unitOf } from "./units.js";

const [KILOMETRE, HOUR] = [1000, 3600]; // metres, seconds

/**
 * Each has the `member` it is about, in lists the `part` of that, and `several` for a member that holds several
 * instead of one; its `type`, as in `cells.js`, whose numbers may be `per` others; the `list` of proposals; and `always`, if it is shown even if empty.
 */
const OF_STOPS = [
  { title: "Longitude", member: "location", part: 0, type: "longitude" },
  { title: "Latitude", member: "location", part: 1, type: "latitude" },
  { title: "Demand", member: "demand", type: "loads" },
  { title: "Takes back", member: "pickup", type: "loads" },
  { title: "Window", member: "window", several: "windows", type: "spans" },
  { title: "Service", member: "service", type: "lasting" },
  { title: "Service by vehicle", member: "services", type: "services" },
  { title: "Due", member: "due", type: "due" },
  { title: "Urgency", member: "urgency", type: "amount" },
  { title: "Released", member: "release", type: "time" },
  { title: "Skills", member: "skills", type: "words" },
  { title: "Prize", member: "prize", type: "amount" },
  { title: "Served by", member: "vehicle", type: "text", list: "vehicle-names" },
];
const OF_VEHICLES = [
  { title: "Count", member: "count", type: "count", always: true },
  { title: "Capacity", member: "capacity", type: "loads", always: true },
  { title: "Shift", member: "shift", several: "shifts", type: "spans", always: true },
  { title: "Start", member: "start", type: "text", list: "stop-names" },
  { title: "End", member: "end", type: "text", list: "stop-names" },
  { title: "Skills", member: "skills", type: "words" },
  { title: "Most stops", member: "max_stops", type: "count" },
  { title: "Most overtime", member: "max_overtime", type: "lasting" },
  { title: "Breaks", member: "breaks", type: "breaks" },
  { title: "Loads again at", member: "reload", type: "words", list: "stop-names" },
  { title: "Most trips", member: "max_trips", type: "count" },
  { title: "Load at start", member: "initial_load", type: "loads" },
  { title: "Longest route", member: "longest", type: "limit" },
  { title: "Most distance", member: "max_distance", type: "limit" },
  { title: "Most driving", member: "max_driving", type: "long" },
  { title: "Profile", member: "profile", type: "text" },
  { title: "Speed, %", member: "speed_factor", type: "percent" },
  { title: "Time at stops, %", member: "service_factor", type: "percent" },
  { title: "Price per use", member: "fixed", type: "amount" },
  { title: "Price of the way", member: "per_distance", type: "price" },
  { title: "Price per hour", member: "per_time", type: "price" },
];
const ALL = { stops: OF_STOPS, vehicles: OF_VEHICLES };

/**
 * The columns of the table of `stops` or `vehicles` of a request, with the `names` of those that refer to stops or vehicles.
 * The limit on a route is a time if there is a clock. What costs something by the metre is said by the kilometre, and what does by the
 * time, by the hour.
 */
export function columnsOf(table, { clock, ...asked }) {
  return ALL[table].map((column) => {
    const names = column.list && asked[`${column.list.replace("-names", "")}s`]?.map((each) => each?.id);
    return column.member === "longest" && clock ? { ...column, type: "long" } : { ...column, names, ...measuredIn(column.member, { clock, ...asked }) };
  });
}

/** The title of a column whose numbers are by another unit than that of the request, and how many of those are `per` one. */
function measuredIn(member, asked) {
  const [first] = asked.objectives ?? [];
  const unit = member === "per_time" ? clockUnit(asked) : first && !first.measure ? unitOf(first) : "";
  if (member === "max_distance") return isMetric(asked) ? { title: "Most distance, km", per: KILOMETRE } : {};
  if (member === "per_distance" && unit === "m") return { title: "Price per km", per: 1 / KILOMETRE };
  if (["per_distance", "per_time"].includes(member) && SECONDS.has(unit)) return { title: `Price per hour${member === "per_time" ? "" : " of driving"}`, per: SECONDS.get(unit) / HOUR };
  return {};
}

/** Whether the costs that are not times are metres. */
const isMetric = ({ objectives = [] }) => objectives.some((each) => !each.measure && unitOf(each) === "m");

/** The columns that are shown: those that a row has something for, those that always are, and members that were added. */
export const isShown = ({ member, several, always }, rows, added) =>
  always || added.has(member) || rows.some((row) => isGiven(row?.[member]) || isGiven(row?.[several]));

const isGiven = (value) => value !== undefined && value !== null && (!Array.isArray(value) || value.length > 0);
