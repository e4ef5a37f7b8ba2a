/** Colours and dashes that distinguish the routes of a plan. */

const COLOURS = 8; // colours of Okabe and Ito (2008), in palette.css, which colour-blind people can tell apart
const ALIKE = 4; // from one colour to another shade of it, which gets another dash
const DASHES = [[], [9, 5], [3, 4]];

/** The style of the route at this place among those of a plan: the name of its colour, and its dash. */
export function routeStyle(at) {
  const dash = DASHES[Math.floor(at / ALIKE) % DASHES.length];
  return { colour: `route-${(at % COLOURS) + 1}`, dash };
}

/** The style of each route of a plan of a request. */
export const stylesOf = (routes, asked) => placesOf(routes, asked).map(routeStyle);

/**
 * The place of each route's style among all: a robot and a vehicle have the same in every plan, by their place in the request, and a
 * vehicle on its way that of the plan before, in which it had this `place`. Where there are more vehicles than styles, it is the place in the plan.
 */
export function placesOf(routes, asked) {
  const robots = new Map(asked.robots?.map(({ id }, at) => [id, at]));
  const ranges = rangesOf(asked);
  const given = new Map(); // how many of a type have a place
  const next = (vehicle) => {
    const number = given.get(vehicle) ?? 0;
    given.set(vehicle, number + 1);
    return ranges.get(vehicle)[0] + number;
  };
  return routes.map(({ robot, place, vehicle }, at) => robots.get(robot) ?? place ?? (ranges.has(vehicle) ? next(vehicle) : at));
}

/** The places of each type of vehicles, `[from, to]`, by its id; none where there are more vehicles than styles. */
export function rangesOf({ vehicles = [] }) {
  const ranges = new Map();
  let all = 0;
  for (const { id, count = 1, shifts = [0] } of vehicles) ranges.set(id, [all, (all += count * shifts.length)]);
  return all <= COLOURS * DASHES.length ? ranges : new Map();
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
