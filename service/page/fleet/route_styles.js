/** Colours and dashes that distinguish the routes of a plan. */

const COLOURS = 8; // colours of Okabe and Ito (2008), in palette.css, which colour-blind people can tell apart
const ALIKE = 4; // from one colour to another shade of it, which gets another dash
const DASHES = [[], [9, 5], [3, 4]];

/** The style of the route at this place among those of a plan: the name of its colour, and its dash. */
export function routeStyle(at) {
  const dash = DASHES[Math.floor(at / ALIKE) % DASHES.length];
  return { colour: `route-${(at % COLOURS) + 1}`, dash };
}

/**
 * The style of each route of a plan: a robot has the same one in every plan, by its place in the request, and a vehicle
 * on its way that of the plan before, in which it had this `place`.
 */
export function stylesOf(routes, robots = []) {
  const places = new Map(robots.map(({ id }, at) => [id, at]));
  return routes.map(({ robot, place }, at) => routeStyle(places.get(robot) ?? place ?? at));
}

/** A piece of its line as SVG, for a legend. */
export function swatch({ colour, dash }) {
  const line = (stroke, width) =>
    `<path d="M1 6h26" stroke="var(--${stroke})" stroke-width="${width}" stroke-dasharray="${dash.join(" ")}"/>`;
  const made = document.createElement("span");
  made.className = "swatch";
  made.innerHTML = `<svg viewBox="0 0 28 12" width="28" height="12" aria-hidden="true">${line("ink", 6)}${line(colour, 4)}</svg>`;
  return made;
}
