/** A table of a plan's routes: the colour of each, its vehicle or robot, how many stops, its load, and its lengths. */

import { comparedAlike } from "../common/amounts.js";
import { made } from "../common/elements.js";
import { isLongest, withUnit } from "../common/objectives.js";
import { knownFleet } from "./known_fleet.js";
import { stylesOf, swatch } from "./route_styles.js";
import { loadOf, visits } from "./routes_of_plan.js";
import { isOnTheWay } from "./visit_times.js";

/** Fills a table with the routes of a plan, and the plan itself in the last row; `lanes` and their `clock` are its timetable. */
export function showLegend(table, plan, movers, asked, objectives, { names, lanes, clock }) {
  const columns = objectives.map((objective, axis) => comparedAlike([plan, ...plan.routes].map(({ lengths }) => lengths[axis]), objective));
  const said = (row) => columns.map((column) => column[row]); // of the plan, and of each of its routes
  const styles = stylesOf(plan.routes, asked);
  const counts = plan.routes.map((route) => visits(route, movers, asked));
  const known = knownFleet(asked);
  const loads = plan.routes.map((route) => loadOf(route, known));
  const load = (said) => (loads.some(Boolean) ? [said] : []); // a column, if a vehicle has a capacity
  const hours = clock?.second ? lanes.map(({ visits: all }) => [all[0].arrival, all.at(-1).leaves]) : []; // leaving, and back
  const ends = hours.length ? [Math.min(...hours.map(([leaves]) => leaves)), Math.max(...hours.map(([, back]) => back))] : [];
  const rows = plan.routes.map((route, at) => {
    const head = made("th", { scope: "row" }, swatch(styles[at]), names[at]);
    return [head, ...cells([counts[at], ...load(loads[at]), ...(hours[at] ?? []).map((time) => clock.said(time)), ...said(at + 1)])];
  });
  const all = counts.reduce((sum, count) => sum + count, 0);
  const isRest = plan.routes.some(isOnTheWay);
  const titles = [movers.one, isRest ? "Stops still to visit" : movers.stops, ...load("Load"), ...(hours.length ? [isRest ? "Goes on at" : "Sets off", "Back"] : []), ...objectives.map((each) => titleOf(each, isRest))];
  table.tHead.replaceChildren(line(titles.map((title) => made("th", { scope: "col" }, title))));
  table.tBodies[0].replaceChildren(...rows.map((row) => line(named(row, titles))));
  table.tFoot.replaceChildren(line(named([made("th", { scope: "row" }, isRest ? "Rest of the day" : "Plan"), ...cells([all, ...load(""), ...ends.map((time, at) => `${clock.said(time)}, ${at ? "the last" : "the first"}`), ...said(0).map((value, axis) => `${value}${ofRoutes(objectives[axis])}`)])], titles)));
}

/** The title of a column: each row has the whole of its own route where the plan compares its routes. */
const titleOf = (objective, isRest) => withUnit(ofRoutes(objective) ? { ...objective, name: isRest ? "rest of the route" : "whole route" } : objective);

/** Cells that know the titles of their columns, which stand in each of them on a phone. */
function named(row, titles) {
  row.forEach((cell, at) => (cell.dataset.title = titles[at]));
  return row;
}

/** What a plan has of the lengths of its routes, to be said behind it; "" if that is their sum. */
export function ofRoutes(objective) {
  if (objective.measure === "imbalance") return ", longest minus shortest";
  return isLongest(objective) ? ", the longest" : "";
}

const cells = (values) => values.map((value) => made("td", {}, value));
const line = (parts) => made("tr", {}, ...parts);
