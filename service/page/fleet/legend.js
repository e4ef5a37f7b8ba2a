/** A table of a plan's routes: the colour of each, its vehicle or robot, how many stops, its load, and its lengths. */

import { compared } from "../common/amounts.js";
import { made } from "../common/elements.js";
import { isLongest, withUnit } from "../common/objectives.js";
import { knownFleet } from "./known_fleet.js";
import { stylesOf, swatch } from "./route_styles.js";
import { loadOf, visits } from "./routes_of_plan.js";

/** Fills a table with the routes of a plan, and the plan itself in the last row; `lanes` and their `clock` are its timetable. */
export function showLegend(table, plan, movers, asked, objectives, { names, lanes, clock }) {
  const said = ({ lengths }) => lengths.map((value, axis) => compared(value, objectives[axis]));
  const styles = stylesOf(plan.routes, asked.robots);
  const counts = plan.routes.map((route) => visits(route, movers, asked));
  const known = knownFleet(asked);
  const loads = plan.routes.map((route) => loadOf(route, known));
  const load = (said) => (loads.some(Boolean) ? [said] : []); // a column, if a vehicle has a capacity
  const hours = clock?.second ? lanes.map(({ visits: all }) => [all[0].arrival, all.at(-1).leaves]) : []; // leaving, and back
  const ends = hours.length ? [Math.min(...hours.map(([leaves]) => leaves)), Math.max(...hours.map(([, back]) => back))] : [];
  const rows = plan.routes.map((route, at) => {
    const head = made("th", { scope: "row" }, swatch(styles[at]), names[at]);
    return [head, ...cells([counts[at], ...load(loads[at]), ...(hours[at] ?? []).map((time) => clock.said(time)), ...said(route)])];
  });
  const all = counts.reduce((sum, count) => sum + count, 0);
  table.tHead.replaceChildren(line([movers.one, movers.stops, ...load("Load"), ...(hours.length ? ["Leaves", "Back"] : []), ...objectives.map(titleOf)].map((title) => made("th", { scope: "col" }, title))));
  table.tBodies[0].replaceChildren(...rows.map(line));
  table.tFoot.replaceChildren(line([made("th", { scope: "row" }, "Plan"), ...cells([all, ...load(""), ...ends.map((time, at) => `${clock.said(time)}, ${at ? "the last" : "the first"}`), ...said(plan).map((value, axis) => `${value}${ofRoutes(objectives[axis])}`)])]));
}

/** The title of a column: each row has the whole of its own route where the plan compares its routes. */
const titleOf = (objective) => withUnit(ofRoutes(objective) ? { ...objective, name: "whole route" } : objective);

/** What a plan has of the lengths of its routes, to be said behind it; "" if that is their sum. */
export function ofRoutes(objective) {
  if (objective.measure === "imbalance") return ", longest minus shortest";
  return isLongest(objective) ? ", the longest" : "";
}

const cells = (values) => values.map((value) => made("td", {}, value));
const line = (parts) => made("tr", {}, ...parts);
