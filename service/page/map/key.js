/** Show what the colours on a map mean: of its ground, and of the routes of a plan. */

import { made } from "../common/elements.js";
import { swatch } from "../fleet/route_styles.js";

const MOST = 8; // routes that are named beside the map; the table below it has all

/** Fills a list with the colours of a grid, each named; `dear` names what there is more of where it is shaded, if it is. */
export function showGround(list, { unknown, dear }) {
  const signs = [["blocked", "obstacle"], ...(unknown ? [["unknown", "unknown"]] : []), ...(dear ? [["dear", `more ${dear}`]] : [])];
  list.replaceChildren(...signs.map(([className, said]) => made("li", { className }, said)));
}

/** Fills a list with the names of routes beside their colours, each `{ name, style }`. */
export function showRoutes(list, routes) {
  const named = routes.slice(0, MOST).map(({ name, style }) => made("li", {}, swatch(style), name));
  const left = routes.length - named.length;
  list.replaceChildren(...named, ...(left > 0 ? [made("li", {}, `and ${left} more`)] : []));
}
