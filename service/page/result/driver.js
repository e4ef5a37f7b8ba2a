/** Write the selected tour or plan for those who drive it: a row for each stop as CSV, as GPX, and as a list to print. */

import { SECONDS } from "../common/durations.js";
import { knownFleet } from "../fleet/known_fleet.js";
import { namesOf } from "../fleet/routes_of_plan.js";
import { hoursOf } from "../fleet/times.js";
import { timetable } from "../fleet/timetable.js";
import { clockUnit } from "../fleet/units.js";
import { departureNote, spansIn } from "../fleet/visit_sentence.js";
import { quoted } from "./exports.js";

const TIMES = ["window", "arrives", "waits", "break", "leaves"];
const COLUMNS = ["vehicle", "position", "stop", "latitude", "longitude", ...TIMES, "load"];

/**
 * The routes of the selected tour or plan, each with a `name`, "" for that of a tour, a `note` on when it begins, and its
 * `visits`: `stop`, and where they are known its `place` (longitude and latitude), its times in words, and its `load`.
 *
 * @param {{ item: object, round: string[], movers: object | null }} selected the tour or plan, the stops of a tour in
 *   their order, and what drives the routes of a plan
 * @param {{ stops?: object[] }} answer the answer that it is of
 * @param {object | null} asked the request, as far as it is known
 */
export function routesOf({ item, round, movers }, answer, asked) {
  const places = new Map(answer.stops?.map(({ id, location }) => [String(id), location]));
  const placed = ({ stop, ...others }) => ({ stop: typeof stop === "number" ? stop + 1 : stop, place: places.get(String(stop)) ?? null, ...others });
  const routes = movers ? routesOfPlan(item.routes, movers, asked ?? {}) : [routeOfTour(item, round)];
  return routes.map((route) => ({ ...route, visits: route.visits.map(placed) }));
}

/** The route of a tour; the first of its hours, if it has a day, is its departure. */
function routeOfTour(tour, round) {
  const hours = hoursOf(tour);
  return { name: "", note: "", visits: round.map((stop, at) => ({ stop, [at ? "arrives" : "leaves"]: hours[at] })) };
}

/** The routes of a plan; without times if their unit is not one of time, or not known. */
function routesOfPlan(routes, movers, asked) {
  const names = namesOf(routes, movers, asked);
  const { lanes, clock } = SECONDS.has(clockUnit(asked)) ? timetable(routes, names, asked) : { lanes: [] };
  const { stops } = knownFleet(asked);
  return routes.map((route, at) => {
    const times = lanes[at]?.visits;
    const visit = (stop, place) => ({ stop, ...(times && inWords(times[place], clock)), load: stops.get(stop)?.demand?.join(", ") });
    return { name: names[at], note: times ? departureNote(times, clock.said) : "", visits: route[movers.through].map(visit) };
  });
}

/** The times of a visit in words: where a route starts it is only left, and where it ends only reached. */
function inWords({ kind, arrival, waiting, rests, leaves, windows, due }, { said, lasting }) {
  const until = kind === "visit" && due !== undefined ? [`due ${said(due)}`] : [];
  return {
    window: [...(windows.length ? [spansIn(windows, said).join(" or ")] : []), ...until].join(", "),
    arrives: kind === "start" ? "" : said(arrival),
    waits: waiting ? lasting(waiting) : "",
    break: spansIn(rests, said).join(", "),
    leaves: kind === "end" ? "" : said(leaves),
  };
}

/** A row for each visit; columns that are empty in all rows are left out. */
export function csvOfVisits(routes) {
  const rows = routes.flatMap(({ name, visits }) =>
    visits.map(({ place, ...visit }, at) => ({ ...visit, vehicle: name, position: at + 1, latitude: place?.[1], longitude: place?.[0] })),
  );
  const columns = COLUMNS.filter((column) => rows.some((row) => (row[column] ?? "") !== ""));
  return [columns, ...rows.map((row) => columns.map((column) => row[column] ?? ""))]
    .map((row) => `${row.map((field) => quoted(`${field}`, /[,"\r\n]/)).join(",")}\n`)
    .join("");
}

/** Whether each stop has a place on the earth. */
export const areLocated = (routes) => routes.every(({ visits }) => visits.every(({ place }) => place));

/** The routes as GPX, which navigation devices and phones open. */
export function gpxOf(routes) {
  const gpx = document.implementation.createDocument("http://www.topografix.com/GPX/1/1", "gpx");
  const made = (parent, tag, text = "") => {
    const element = gpx.createElementNS(gpx.documentElement.namespaceURI, tag);
    element.textContent = text;
    parent.append(element);
    return element;
  };
  gpx.documentElement.setAttribute("version", "1.1");
  gpx.documentElement.setAttribute("creator", "Paretour");
  for (const { name, note, visits } of routes) {
    const route = made(gpx.documentElement, "rte");
    made(route, "name", name || "Tour");
    if (note) made(route, "desc", note);
    for (const { stop, place, ...times } of visits) {
      const point = made(route, "rtept");
      point.setAttribute("lat", place[1]);
      point.setAttribute("lon", place[0]);
      made(point, "name", stop);
      const said = TIMES.filter((each) => times[each]).map((each) => `${each} ${times[each]}`);
      if (said.length) made(point, "desc", said.join(", "));
    }
  }
  return `<?xml version="1.0" encoding="UTF-8"?>\n${new XMLSerializer().serializeToString(gpx)}\n`;
}

/** Fills the sheet that is printed: a table for each route, below its name and when it begins. A stop's name opens the map of a phone that reads the sheet. */
export function fillSheet(sheet, routes) {
  sheet.replaceChildren(
    ...routes.map(({ name, note, visits }) => {
      const part = document.createElement("section");
      const heading = Object.assign(document.createElement("h2"), { textContent: name || "Tour" });
      const table = document.createElement("table");
      const columns = [...TIMES, "load"].filter((column) => visits.some((visit) => visit[column]));
      row(table.createTHead(), ["", "stop", ...columns]);
      const body = table.createTBody();
      for (const [at, visit] of visits.entries()) row(body, [at + 1, linked(visit), ...columns.map((column) => visit[column] ?? "")]);
      part.append(heading, ...(note ? [Object.assign(document.createElement("p"), { textContent: note })] : []), table);
      return part;
    }),
  );
}

function row(table, cells) {
  const made = table.insertRow();
  for (const cell of cells) made.insertCell().append(cell);
}

function linked({ stop, place }) {
  if (!place) return stop;
  const [longitude, latitude] = place;
  const href = `geo:${latitude},${longitude}?q=${latitude},${longitude}(${encodeURIComponent(stop)})`;
  return Object.assign(document.createElement("a"), { href, textContent: stop });
}
