/** Show what the colours on a map mean: of its ground, and of the routes of a plan. */

import { made } from "../common/elements.js";
import { swatch } from "../fleet/route_styles.js";

const MOST = 8; // routes that are named beside the map; the table below it has all

/** Fills a list with the colours of a grid, each named; `dear` names what there is more of where it is shaded, if it is. */
export function showGround(list, { unknown, dear }) {
  const signs = [["blocked", "obstacle"], ...(unknown ? [["unknown", "unknown"]] : []), ...(dear ? [["dear", `more ${dear}`]] : [])];
  list.replaceChildren(...signs.map(([className, said]) => made("li", { className }, said)));
}

/**
 * Fills a list with the names of routes beside their colours, each `{ name, stops, style }`, and on a map of vehicles with what its signs mean:
 * `passed` has in `driven` what they have driven, each `{ tip, out }` with the vehicle that is out of service, if it is.
 */
export function showRoutes(list, routes, passed) {
  const named = routes.slice(0, MOST).map(({ name, style }) => made("li", {}, swatch(style), name));
  const left = routes.length - named.length;
  list.replaceChildren(...named, ...(left > 0 ? [made("li", {}, `and ${left} more`)] : []), ...(passed ? signs(routes, passed) : []));
}

const GREY = { colour: "alone", dash: [] }; // as in plane.js
const CIRCLES = {
  dot: 'fill="var(--ink)" stroke="var(--card)" stroke-width="3"',
  ring: 'fill="none" stroke="var(--selected)" stroke-width="2"',
  disc: 'fill="var(--route-1)" stroke="var(--ink)" stroke-width="1.5"',
};

/** What the signs on a map of vehicles mean, of those that there are. */
function signs(routes, { driven: passed, isCancelled }) {
  const out = new Map(passed.flatMap(({ out: each }) => (each ? [[each.name, each]] : [])));
  const starts = new Set(routes.map(({ stops }) => stops[0])).size;
  return [
    ...[...out.values()].map(({ name, style }) => made("li", {}, swatch(style), `${name}: out of service`)),
    ...(passed.length ? [made("li", {}, swatch(GREY), "driven already")] : []),
    ...(passed.some(({ tip }) => tip) || starts > 1 ? [made("li", {}, circle("disc"), starts > 1 && !passed.length ? "a vehicle starts here" : "a vehicle is here now")] : []),
    ...(isCancelled ? [made("li", {}, circle("dot"), "without a line: cancelled")] : []),
    ...(starts === 1 ? [made("li", {}, circle("ring"), "all start here")] : []),
  ];
}

function circle(kind) {
  const sign = made("span", { className: "swatch" });
  sign.innerHTML = `<svg viewBox="0 0 14 12" width="14" height="12" aria-hidden="true"><circle cx="7" cy="6" r="4.5" ${CIRCLES[kind]}/></svg>`;
  return sign;
}
