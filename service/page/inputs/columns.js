/** From tables of CSV to the members of a request: stops with locations, two planes, or two matrices. */

import { isNumber, parseTable } from "./csv.js";
import { metres } from "./distances.js";

const NAMES = {
  id: ["id", "name", "stop", "stop_id", "order"],
  longitude: ["lon", "lng", "long", "longitude"],
  latitude: ["lat", "latitude"],
};
const MOST_WEIGHTED = 1500; // stops, of which a matrix is no longer than a service takes

/** What stops are measured by where nothing else is said. */
export const MEASURED = [
  { name: "distance", from: "great_circle" },
  { name: "time", from: "road_time" },
];

/** The request of one table, which holds both objectives, or stops where they lie. */
export function membersOfTable({ name, text }) {
  const { heading, rows } = parseTable(text);
  if (!rows.length) throw new Error(`${name} must have a stop on each line, got none`);
  const [longitude, latitude] = [columnOf(heading, "longitude"), columnOf(heading, "latitude")];
  if (longitude >= 0 && latitude >= 0) return located(name, heading, rows, [longitude, latitude]);
  const { ids, numbers } = numbered(name, heading, rows, 4, "four numbers on each line");
  return { coordinates: numbers, ...(ids && { ids }) };
}

/** The request of two tables about the same stops, an objective each. */
export function membersOfTables(texts) {
  const stops = texts.find(({ text }) => columnOf(parseTable(text).heading, "longitude") >= 0);
  if (stops) return withCosts(stops, texts.find((each) => each !== stops));
  const [first, second] = texts.map(planeOrCosts);
  if (first.numbers.length !== second.numbers.length || first.numbers[0].length !== second.numbers[0].length) {
    throw new Error(`${texts[0].name} and ${texts[1].name} must have as many rows and columns as each other`);
  }
  const ids = first.ids ?? second.ids;
  if (first.numbers[0].length !== 2) return { matrices: [first.numbers, second.numbers], ...(ids && { ids }) };
  return { coordinates: first.numbers.map((place, row) => [...place, ...second.numbers[row]]), ...(ids && { ids }) };
}

const columnOf = (heading, which) => heading.findIndex((each) => NAMES[which].includes(each));

/** Stops with longitude and latitude, and the second objective by the columns that are left, if any is. */
function located(name, heading, rows, place) {
  const id = columnOf(heading, "id");
  checkRows(name, heading, rows, place);
  const stops = rows.map((row, at) => ({ id: id < 0 ? String(at + 1) : row[id], location: place.map((column) => Number(row[column])) }));
  checkIds(name, stops.map((stop) => stop.id));
  const left = heading.map((_, column) => column).filter((column) => ![id, ...place].includes(column));
  return { stops, objectives: [MEASURED[0], second(name, heading, rows, stops, left)] };
}

/** Columns x and y are a plane; another one of numbers says what a metre costs at each stop. */
function second(name, heading, rows, stops, left) {
  const plane = ["x", "y"].map((each) => heading.indexOf(each));
  if (!plane.includes(-1)) {
    checkRows(name, heading, rows, plane);
    return { name: "second length", coordinates: rows.map((row) => plane.map((column) => Number(row[column]))) };
  }
  const column = left.find((each) => rows.every((row) => isNumber(row[each] ?? "") && Number(row[each]) >= 0));
  if (column === undefined || rows.length > MOST_WEIGHTED) return MEASURED[1];
  return { name: heading[column], matrix: weighted(stops, rows.map((row) => Number(row[column]))) };
}

/** The metres from each stop to each, times the mean of both stops' weights. */
const weighted = (stops, weights) =>
  stops.map((from, row) =>
    stops.map((to, column) => Number(((metres(from.location, to.location) * (weights[row] + weights[column])) / 2).toPrecision(7))),
  );

function withCosts(stops, { name, text }) {
  const members = membersOfTable(stops);
  const { numbers } = planeOrCosts({ name, text });
  const cities = members.stops.length;
  if (numbers.length !== cities || numbers[0].length !== cities) {
    throw new Error(`${name} must have a row and a column for each of the ${cities} stops of ${stops.name}`);
  }
  return { ...members, objectives: [MEASURED[0], { name: name.replace(/\.\w+$/, ""), matrix: numbers }] };
}

function planeOrCosts({ name, text }) {
  const { heading, rows } = parseTable(text);
  if (!rows.length) throw new Error(`${name} must have a row for each stop, got none`);
  const named = namesFirst(heading, rows);
  const width = rows[0].length - (named ? 1 : 0);
  if (![2, rows.length].includes(width)) {
    throw new Error(`${name} must have 2 columns, x and y, or as many as rows, got ${rows.length} rows of ${width}`);
  }
  return numbered(name, heading, rows, width, `${width} numbers on each line`);
}

/** Whether the first column holds ids: its heading says so, or it is the one that is no number. */
const namesFirst = (heading, [first]) =>
  columnOf(heading.slice(0, 1), "id") === 0 || (first.length > 1 && !isNumber(first[0]) && first.slice(1).every(isNumber));

function numbered(name, heading, rows, width, demand) {
  const named = namesFirst(heading, rows);
  const wrong = rows.findIndex((row) => row.length !== width + (named ? 1 : 0) || !row.slice(named ? 1 : 0).every(isNumber));
  if (wrong >= 0) {
    throw new Error(`${name} must have ${demand}, or columns lon and lat, got "${rows[wrong].join(", ").slice(0, 60)}" as row ${wrong + 1}`);
  }
  const ids = named ? rows.map(([id]) => id) : undefined;
  if (ids) checkIds(name, ids);
  return { ids, numbers: rows.map((row) => row.slice(named ? 1 : 0).map(Number)) };
}

function checkRows(name, heading, rows, columns) {
  for (const [at, row] of rows.entries()) {
    const wrong = columns.find((column) => !isNumber(row[column] ?? ""));
    if (wrong !== undefined) {
      throw new Error(`${heading[wrong]} of ${name} must be a number, got "${(row[wrong] ?? "").slice(0, 60)}" as row ${at + 1}`);
    }
  }
}

function checkIds(name, ids) {
  const seen = new Set();
  for (const [at, id] of ids.entries()) {
    if (!id || seen.has(id)) throw new Error(`${name} must have an id of its own in row ${at + 1}, got "${id.slice(0, 60)}"`);
    seen.add(id);
  }
}
