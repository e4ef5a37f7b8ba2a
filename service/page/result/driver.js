/** Write the selected tour or plan for those who drive it: a row for each stop as CSV, as GPX, and as a list to print. */

import { SECONDS } from "../common/durations.js";
import { knownFleet } from "../fleet/known_fleet.js";
import { namesOf } from "../fleet/routes_of_plan.js";
import { clockOf, hoursOf } from "../fleet/times.js";
import { clockUnit } from "../fleet/units.js";
import { quoted } from "./exports.js";

const COLUMNS = ["vehicle", "position", "stop", "latitude", "longitude", "arrives", "load"];

/**
 * The routes of the selected tour or plan, each with a `name`, "" for that of a tour, and its `visits`: `stop`,
 * and where they are known its `place` (longitude and latitude), when the vehicle `arrives`, and its `load`.
 *
 * @param {{ item: object, round: string[], movers: object | null }} selected the tour or plan, the stops of a tour in
 *   their order, and what drives the routes of a plan
 * @param {{ stops?: object[] }} answer the answer that it is of
 * @param {object | null} asked the request, as far as it is known
 */
export function routesOf({ item, round, movers }, answer, asked) {
  const places = new Map(answer.stops?.map(({ id, location }) => [String(id), location]));
  const visit = (stop, arrives, load) => ({ stop: typeof stop === "number" ? stop + 1 : stop, place: places.get(String(stop)) ?? null, arrives, load });
  if (!movers) {
    const hours = hoursOf(item);
    return [{ name: "", visits: round.map((stop, at) => visit(stop, hours[at] ?? "", "")) }];
  }
  const names = namesOf(item.routes, movers, asked ?? {});
  const said = timesOf(item.routes.map(({ arrivals }) => arrivals ?? []), clockUnit(asked ?? {}));
  const { stops } = knownFleet(asked ?? {});
  return item.routes.map((route, at) => ({
    name: names[at],
    visits: route[movers.through].map((stop, place) => visit(stop, said(route.arrivals?.[place]), (stops.get(stop)?.demand ?? []).join(", "))),
  }));
}

/** Puts times into words, "" where there is none or their unit is not one of time. */
function timesOf(rows, unit) {
  const times = rows.flat();
  if (!times.length || !SECONDS.has(unit)) return () => "";
  const clock = clockOf(times, unit);
  return (time) => (time === undefined ? "" : clock.said(time));
}

/** A row for each visit; columns that are empty in all rows are left out. */
export function csvOfVisits(routes) {
  const rows = routes.flatMap(({ name, visits }) =>
    visits.map(({ stop, place, arrives, load }, at) => ({
      vehicle: name, position: at + 1, stop, latitude: place?.[1] ?? "", longitude: place?.[0] ?? "", arrives, load,
    })),
  );
  const columns = COLUMNS.filter((column) => rows.some((row) => row[column] !== ""));
  return [columns, ...rows.map((row) => columns.map((column) => row[column]))]
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
  for (const { name, visits } of routes) {
    const route = made(gpx.documentElement, "rte");
    made(route, "name", name || "Tour");
    for (const { stop, place, arrives } of visits) {
      const point = made(route, "rtept");
      point.setAttribute("lat", place[1]);
      point.setAttribute("lon", place[0]);
      made(point, "name", stop);
      if (arrives) made(point, "desc", `arrives ${arrives}`);
    }
  }
  return `<?xml version="1.0" encoding="UTF-8"?>\n${new XMLSerializer().serializeToString(gpx)}\n`;
}

/** Fills the sheet that is printed: a table for each route. A stop's name opens the map of a phone that reads the sheet. */
export function fillSheet(sheet, routes) {
  sheet.replaceChildren(
    ...routes.map(({ name, visits }) => {
      const part = document.createElement("section");
      const heading = Object.assign(document.createElement("h2"), { textContent: name || "Tour" });
      const table = document.createElement("table");
      const columns = ["arrives", "load"].filter((column) => visits.some((visit) => visit[column]));
      row(table.createTHead(), ["", "stop", ...columns]);
      const body = table.createTBody();
      for (const [at, visit] of visits.entries()) row(body, [at + 1, linked(visit), ...columns.map((column) => visit[column])]);
      part.append(heading, table);
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
