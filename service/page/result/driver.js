/** Write the selected tour or plan for those who drive it: a row for each stop as CSV, as GPX, and as a list to print. */

import { made as newElement } from "../common/elements.js";
import { knownFleet } from "../fleet/known_fleet.js";
import { namesOf } from "../fleet/routes_of_plan.js";
import { hoursOf } from "../fleet/times.js";
import { hoursOfPlan } from "../fleet/timetable.js";
import { dueIn, routeNote, spansIn } from "../fleet/visit_sentence.js";
import { kindsOf } from "../fleet/visit_times.js";
import { quoted } from "./exports.js";

const TIMES = ["window", "arrives", "waits", "break", "leaves"];
const TITLES = { leaves: "sets off" }; // of columns of a sheet that people read
const COLUMNS = ["vehicle", "position", "stop"];
const ROLES = { start: "Start: ", end: "End: ", loading: "Load again: " }; // of stops that are not visited
const LOADS = ["load", "takes back"];
const AFTER_DETAILS = ["latitude", "longitude", ...TIMES, ...LOADS];

/**
 * The routes of the selected tour or plan, each with a `name`, "" for that of a tour, a `note` on when it begins, and its
 * `visits`: `stop`, and where they are known its `place` (longitude and latitude), its times in words, its `load`,
 * and its `details`: pairs of a column of the file and a text.
 *
 * @param {{ item: object, round: string[], movers: object | null }} selected the tour or plan, the stops of a tour in
 *   their order, and what drives the routes of a plan
 * @param {{ stops?: object[] }} answer the answer that it is of
 * @param {object | null} asked the request, as far as it is known
 * @param {(name: string) => string[][]} details what drivers are told of a stop
 */
export function routesOf({ item, round, movers }, answer, asked, details) {
  const places = new Map(answer.stops?.map(({ id, location }) => [String(id), location]));
  const placed = ({ stop, ...others }) => {
    const name = typeof stop === "number" ? stop + 1 : stop;
    return { stop: name, details: details(name), place: places.get(String(stop)) ?? null, ...others };
  };
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
  const { lanes, clock } = hoursOfPlan(routes, names, asked);
  const { stops, types } = knownFleet(asked);
  return routes.map((route, at) => {
    const times = lanes[at]?.visits;
    const kinds = route.stops ? kindsOf(route, types.get(route.vehicle)) : [];
    const visit = (stop, place) => ({ stop, kind: kinds[place], ...(times && inWords(times[place], clock)), ...loadsOf(stops.get(stop)) });
    return { name: names[at], note: times ? routeNote(times, clock.said) : "", visits: route[movers.through].map(visit) };
  });
}

/** What a stop gets, and what it gives back. */
const loadsOf = ({ demand, pickup } = {}) => ({ load: demand?.join(", "), "takes back": pickup?.some((each) => each > 0) ? pickup.join(", ") : "" });

/** The times of a visit in words: where a route starts it is only left, and where it ends only reached. */
function inWords({ kind, arrival, waiting, rests, leaves, windows, wanted, due }, { said, lasting }) {
  const until = dueIn({ kind, wanted, due }, said);
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
  const [before, after] = [COLUMNS, AFTER_DETAILS].map((columns) => columns.filter((column) => rows.some((row) => (row[column] ?? "") !== "")));
  const told = detailsIn(rows);
  const cells = (row, columns) => columns.map((column) => row[column] ?? "");
  return [[...before, ...told.names, ...after], ...rows.map((row) => [...cells(row, before), ...told.texts(row), ...cells(row, after)])]
    .map((row) => `${row.map((field) => quoted(`${field}`, /[,"\r\n]/)).join(",")}\n`)
    .join("");
}

/** The names of the details that a visit has a text for, and their texts of a visit. */
function detailsIn(visits) {
  const known = visits[0]?.details ?? [];
  const given = known.flatMap((_, at) => (visits.some(({ details }) => details[at][1]) ? [at] : []));
  return { names: given.map((at) => known[at][0]), texts: ({ details }) => given.map((at) => details[at][1]) };
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
    for (const { stop, place, details, ...times } of visits) {
      const point = made(route, "rtept");
      point.setAttribute("lat", place[1]);
      point.setAttribute("lon", place[0]);
      made(point, "name", stop);
      const said = TIMES.filter((each) => times[each]).map((each) => `${each} ${times[each]}`);
      const told = details.filter(([, text]) => text).map(([column, text]) => `${column}: ${text}`);
      const described = [...told, ...(said.length ? [said.join(", ")] : [])];
      if (described.length) made(point, "desc", described.join("; "));
    }
  }
  return `<?xml version="1.0" encoding="UTF-8"?>\n${new XMLSerializer().serializeToString(gpx)}\n`;
}

/**
 * Fills the sheets that are printed, a page for each route: its name, what it comes to, when it begins, and its table. A stop's name opens the
 * map of a phone that reads the sheet; where a vehicle starts, loads again or ends says so.
 *
 * @param {{ title: string, date: Date, totals: { whole: string, ofRoutes: string[] } }} head what stands on each page: the title, the day on
 *   which it is printed, and totals, as of `totalsOf`
 */
export function fillSheet(sheet, routes, { title, date, totals }) {
  const printed = `Printed on ${date.toLocaleString("en", { dateStyle: "full", timeStyle: "short", hourCycle: "h23" })}. ${totals.whole}.`;
  sheet.replaceChildren(
    ...routes.map(({ name, note, visits }, at) => {
      const part = document.createElement("section");
      part.append(newElement("header", {}, newElement("h1", {}, title || (name ? "Plan" : "Tour")), newElement("p", {}, printed)));
      const heading = Object.assign(document.createElement("h2"), { textContent: name || "Tour" });
      const table = document.createElement("table");
      const columns = [...TIMES, ...LOADS].filter((column) => visits.some((visit) => visit[column]));
      const told = detailsIn(visits);
      row(table.createTHead(), ["", "stop", ...told.names, ...columns.map((column) => TITLES[column] ?? column)]);
      const body = table.createTBody();
      for (const [turn, visit] of visits.entries()) row(body, [turn + 1, linked(visit), ...told.texts(visit), ...columns.map((column) => visit[column] ?? "")]);
      const said = [totals.ofRoutes[at], note].filter(Boolean);
      part.append(heading, ...said.map((text) => newElement("p", {}, text)), table);
      return part;
    }),
  );
}

function row(table, cells) {
  const made = table.insertRow();
  for (const cell of cells) made.insertCell().append(cell);
}

function linked({ stop, kind, place }) {
  const textContent = `${ROLES[kind] ?? ""}${stop}`;
  if (!place) return textContent;
  const [longitude, latitude] = place;
  const href = `geo:${latitude},${longitude}?q=${latitude},${longitude}(${encodeURIComponent(stop)})`;
  return Object.assign(document.createElement("a"), { href, textContent });
}
