/** Say what a selected tour or plan comes to, and each of its routes: stops, load and lengths, for the sheets that are printed. */

import { amount } from "../common/amounts.js";
import { counted } from "../common/numbers.js";
import { capital } from "../common/objectives.js";
import { knownFleet } from "../fleet/known_fleet.js";
import { ofRoutes } from "../fleet/legend.js";
import { loadOf, visits } from "../fleet/routes_of_plan.js";
import { isOnTheWay } from "../fleet/visit_times.js";

/**
 * @param {{ item: object, movers: object | null }} selected the tour or plan, and what drives its routes
 * @param {object[]} objectives
 * @param {object | null} asked the request, as far as it is known
 * @returns {{ whole: string, ofRoutes: string[] }} of all routes together, and of each; of a tour there is one
 */
export function totalsOf({ item, movers }, objectives, asked) {
  const lengths = (each, names) => each.lengths.map((value, axis) => `${names(objectives[axis])} ${amount(value, objectives[axis])}`);
  const whole = lengths(item, ({ name }) => name);
  if (!movers) return { whole: said([counted(item.tour.length, "stop", "stops"), ...whole]), ofRoutes: [""] };
  const known = knownFleet(asked ?? {});
  const counts = item.routes.map((route) => visits(route, movers, asked ?? {}));
  const all = counts.reduce((sum, count) => sum + count, 0);
  const vehicles = counted(item.routes.length, movers.one.toLowerCase(), movers.words);
  const of = (count) => (movers.through === "stops" ? counted(count, "stop", "stops") : counted(count, "place", "places"));
  const routes = item.routes.map((route, at) => {
    const load = loadOf(route, known);
    return said([of(counts[at]), ...(load ? [`load ${load}`] : []), ...lengths(route, (objective) => (ofRoutes(objective) ? (item.routes.some(isOnTheWay) ? "rest of the route" : "whole route") : objective.name))]);
  });
  return { whole: said([vehicles, of(all), ...whole]), ofRoutes: routes };
}

const said = (parts) => capital(parts.join(", "));
