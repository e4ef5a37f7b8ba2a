/** Write a request as a curl command, a front as CSV, and one tour or plan alone as JSON. */

import { kindNamed } from "../common/kinds.js";
import { MEASURES } from "../common/measures_table.js";
import { unnamed } from "../common/objectives.js";
import { moversOf } from "../fleet/routes_of_plan.js";
import { hoursOfPlan } from "../fleet/timetable.js";

const COLUMNS = Object.entries(MEASURES).filter(([, { column }]) => column);

/** The same request as a shell command. */
export function curl({ path, body }) {
  const address = new URL(path, document.baseURI).href;
  return `curl ${address} -H 'Content-Type: application/json' -d @- <<'END'\n${JSON.stringify(body)}\nEND\n`;
}

/** One tour or plan as an answer whose front holds nothing else, with the stops that it visits. */
export function alone({ id, kind, closed, objectives, places, stops }, item) {
  const visited = new Set(item.routes ? item.routes.flatMap((route) => route.stops) : item.stops);
  return { id, kind, closed, objectives, places, stops: stops?.filter((stop) => visited.has(stop.id)), front: [item] };
}

/**
 * A front as CSV: a tour on each line, or a route of a plan, with these names of objectives, the answer's ids
 * where it has them, and the departure in seconds of the day where it has one. The last column says whether it is the
 * selected one, whose place in the front is `selected`.
 *
 * @param {object | null} asked the request, as far as it is known
 */
export function csv({ kind, front }, { objectives, asked }, selected) {
  const { movers } = kindNamed({ kind });
  const titles = objectives.every(({ name }, axis) => name === unnamed(axis).name) ? objectives.map((_, axis) => `length_${axis + 1}`) : objectives.map(titled);
  if (movers) {
    const plans = front.map((plan) => {
      const names = moversOf(plan.routes, movers, asked ?? {});
      return { ...plan, names, ...hoursOfPlan(plan.routes, names, asked ?? {}) };
    });
    // Where the plan compares its routes, each row has the whole of its own.
    const ofRoutes = objectives.map(({ measure, unit }, axis) => (measure === "imbalance" ? titled({ name: "whole route", unit }) : `route ${titles[axis]}`));
    return csvOfPlans(plans, titles, ofRoutes, movers, selected);
  }
  const spreading = objectives.map((_, axis) => axis).filter((axis) => front.some(({ means, p90 }) => p90 && p90[axis] > means[axis]));
  const ofDays = ["mean", "p90"].flatMap((name) => spreading.map((axis) => `${name} ${titles[axis]}`));
  const rows = front.map(({ angle, departure, lengths, means, p90, tour, stops }, at) => {
    const places = stops?.map((id) => quoted(id, /[ "]/)) ?? tour;
    return [...[angle, departure].filter((each) => each !== undefined), ...lengths, ...[means, p90].flatMap((each) => spreading.map((axis) => each[axis])), places.join(" "), yesOrNo(at === selected)];
  });
  const before = [...(titles.length === 2 ? ["angle"] : []), ...(front[0]?.departure === undefined ? [] : ["departure"])];
  return [[...before, ...titles, ...ofDays, "tour", "selected"], ...rows].map(line).join("");
}

/** A route on each line, after the members of its plan, with the name of its vehicle or robot; with its shift, if its vehicle has several; and when it leaves and is back. */
function csvOfPlans(plans, titles, ofRoutes, { one, stops, through }, selected) {
  const shifts = plans.some(({ routes }) => routes.some(({ shift }) => shift !== undefined));
  const timed = plans.some(({ clock }) => clock);
  const spreading = COLUMNS.filter(([measure]) => measure in (plans[0]?.measures ?? {}));
  const rows = plans.flatMap(({ balance, lengths, measures, routes, names, lanes, clock }, plan) =>
    routes.map((route, at) => {
      const visits = lanes[at]?.visits;
      const hours = visits ? [visits[0].arrival, visits.at(-1).leaves].map(clock.said) : ["", ""];
      const places = route[through].map((stop) => quoted(`${stop}`, /[ "]/)).join(" ");
      const before = balance === undefined ? [plan] : [plan, balance];
      return [...before, ...lengths, ...spreading.map(([measure]) => measures[measure]), names[at], ...(shifts ? [route.shift ?? ""] : []), ...route.lengths, ...(timed ? hours : []), places, yesOrNo(plan === selected)];
    }),
  );
  const flat = titles.length === 2 ? ["balance"] : [];
  const head = ["plan", ...flat, ...titles, ...spreading.map(([, { column }]) => column), one.toLowerCase(), ...(shifts ? ["shift"] : []), ...ofRoutes, ...(timed ? ["leaves", "back"] : []), stops.toLowerCase(), "selected"];
  return [head, ...rows].map(line).join("");
}

const titled = ({ name, unit }) => (unit ? `${name} (${unit})` : name);

const yesOrNo = (is) => (is ? "yes" : "no");

/** The GeoJSON of a front whose lines say whether they are of the selected tour or plan. */
export function withSelected(text, selected) {
  const collection = JSON.parse(text);
  // The lines of tours come first, in the order of the front.
  for (const [at, { properties }] of collection.features.entries()) {
    if (properties.front !== undefined) properties.selected = (properties.plan ?? at) === selected;
  }
  return JSON.stringify(collection);
}

const line = (row) => `${row.map((field) => quoted(`${field}`, /[,"]/)).join(",")}\n`;

/** The text in quotation marks, if it has a character that would end it. */
export const quoted = (text, ending) => (ending.test(text) ? `"${text.replaceAll('"', '""')}"` : text);

/** Lets the browser save a text, or a blob, as a file. */
export function download(name, type, content) {
  const address = URL.createObjectURL(new Blob([content], { type }));
  const link = Object.assign(document.createElement("a"), { href: address, download: name });
  link.click();
  URL.revokeObjectURL(address);
}
