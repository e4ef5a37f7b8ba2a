/** Show each fault of an error at its field. A field whose text cannot be taken is invalid. */

import { Problem } from "./service.js";
import { made } from "../common/elements.js";

const FIELD_OF = { coordinates: "cities", matrices: "cities", stops: "cities", closed: "end", clock: "objectives", start_pose: "start", end_pose: "end" };
const REPLANNED = { tour: "at", done: "at", remove: "removed", add: "replan", position: "replan", now: "now" };
for (const member of Object.keys(REPLANNED)) FIELD_OF[member] = "replan";
const COLUMNS = ["x₁", "y₁", "x₂", "y₂"];
const FIELD_OF_CODE = { unauthorized: "key" };

/** Shows the faults of a problem at their fields, and all others below the buttons. */
export function showFaults(problem) {
  clearFaults();
  const faults = faultsOf(problem);
  let first = null;
  for (const { pointer = "", detail } of faults) {
    const parts = pointer.split("/").slice(1);
    const [member, row, part] = parts;
    const field = FIELD_OF_CODE[problem.code] ?? FIELD_OF[member] ?? member ?? "request";
    const cell = cellOf(parts);
    const said = seen(document.getElementById(`${cell?.closest(".stops")?.id ?? field}-fault`)) ?? document.getElementById("request-fault");
    said.textContent ||= sentence(cell && member !== "coordinates" ? ofCell(detail, cell) : inWords(detail, field));
    if (cell) cell.setAttribute("aria-invalid", "true");
    first ??= cell ?? (member === "cities" ? markText(row) : mark(REPLANNED[member] ?? field, member === "matrices" ? undefined : row, part));
  }
  first?.focus();
}

/** Requests for plans do not have all fields of the form. */
const seen = (said) => (said?.closest("[hidden]") ? null : said);

/** If there is only one fault, the problem itself says the most. */
function faultsOf({ message, errors = [] }) {
  return errors.length > 1 ? errors : [{ ...errors[0], detail: message }];
}

export function clearFaults() {
  for (const said of document.querySelectorAll(".fault")) said.textContent = "";
  for (const field of document.querySelectorAll("[aria-invalid]")) field.removeAttribute("aria-invalid");
}

/** Says what is wrong with one field, and with its parts in a list. */
export function showFault(field, detail, parts = []) {
  clearFaults();
  const said = tellFault(field, detail);
  if (parts.length) said.append(made("ul", {}, ...parts.map((each) => made("li", {}, each))));
  said.scrollIntoView({ block: "nearest" });
}

/** Says what is wrong with one field beside what is said of others; returns where that is said. */
export function tellFault(field, detail) {
  return Object.assign(document.getElementById(`${field}-fault`), { textContent: sentence(detail) });
}

const INVALID = ":is(input, textarea):invalid";

/** Whether what was typed can be taken; if not, its field says the fault. */
export function isRead(field, readable, fault) {
  field.setCustomValidity(readable ? "" : fault);
  if (!readable) {
    field.setAttribute("aria-invalid", "true");
    tellFault(pointerOf(field).split("/")[1], fault);
  }
  return readable;
}

/** Whether a name is none of the others. */
export const isOwnName = (field, name, others, what) =>
  isRead(field, Boolean(name) && !others.includes(name), `Each ${what} needs a name of its own, got “${name}”`);

/** The fault of the first invalid field of a form, as an error of a request; null if there is none. */
export function firstFault(form) {
  const field = form.querySelector(INVALID);
  return field && { detail: field.validationMessage, pointer: pointerOf(field) };
}

/** A fault as a Problem. */
export const problemOf = (fault) => fault && new Problem({ ...fault, errors: [fault] });

/** Reads the invalid fields of a form again, as others have changed. */
export function readAgain(form) {
  for (const field of form.querySelectorAll(INVALID)) field.dispatchEvent(new Event("change", { bubbles: true }));
}

/** The member of a request that a field is about. */
function pointerOf(field) {
  const { row, members, axis, member, at } = field.dataset;
  if (at) return `/cost_layers/${at}/name`;
  if (row) return `/${field.closest(".stops").id}/${row}/${members}`;
  return axis ? `/objectives/${axis}/${member}` : `/${field.id}`;
}

/** Brings the first fault into view, where focus alone may not, and returns it. */
export function revealFault() {
  const said = document.querySelector(".fault:not(:empty)");
  said.scrollIntoView({ block: "nearest" });
  return said.textContent;
}

/** The cell of the table of stops or vehicles that a fault is about; null if there is none. */
function cellOf([member, row, part, ...rest]) {
  if (member === "coordinates") return cellOfPlane(0, row, part);
  if (member === "objectives" && part === "coordinates") return cellOfPlane(row, ...rest); // of stops with names
  if (member === "cost_layers") return document.querySelector(`#layers-list [data-at="${row}"]`);
  if (!part || !["stops", "vehicles"].includes(member)) return null;
  const cells = document.querySelectorAll(`#${member} [data-row="${row}"][data-members~="${CSS.escape(part)}"]`);
  return cells[rest[0]] ?? cells[0] ?? null; // a location has two
}

const cellOfPlane = (axis, row, part) => document.querySelector(`#stops .grouped [data-row="${row}"][data-column="${2 * axis + Number(part)}"]`);

/** The sentence of a fault with the cell by name, such as "Window of order-17". */
function ofCell(detail, cell) {
  return IN_CELLS.reduce((said, [pattern, instead]) => said.replace(pattern, instead), detail)
    .replace(/^\w+\/\d+\/\w+(\/\d+)*/, cell.getAttribute("aria-label"))
    .replace(PATH, itemNamed);
}

// What the page calls an item of a request, where a sentence of the service says its place, as "stops/3/window/0".
const ITEMS = {
  stops: "stop", coordinates: "stop", vehicles: "vehicle", shipments: "shipment", robots: "robot",
  places: "place", relations: "relation", initial_tours: "tour to begin with", cost_layers: "further cost",
  remove: "a stop to drop", done: "a visited stop", add: "a new stop", tour: "a stop of the tour",
};
const UNCOUNTED = ["remove", "done", "add", "tour"]; // named one by one in one field, where their places say nothing
const PATH = new RegExp(`\\b(${Object.keys(ITEMS).join("|")})/(\\d+)((?:/\\w+)*)`, "g");

/** An item as people name it: by its name on the page, or counted from 1; and the member of it that a sentence is about. */
function itemNamed(_, list, at, rest) {
  const members = rest.split("/").filter((part) => part && !/^\d+$/.test(part)).map((part) => part.replaceAll("_", " "));
  const name = document.querySelector(`#${list} [data-row="${at}"][data-column="name"]`)?.value;
  const item = UNCOUNTED.includes(list) ? ITEMS[list] : `${ITEMS[list]} ${name || counted(at)}`;
  return members.length ? `${members.join(" ")} of ${item}` : item;
}

function mark(name, row, part) {
  const of = ["name", "speed"].includes(part) ? part : "source";
  const sources = document.querySelectorAll(`#${name === "objectives" ? "named" : name} [data-axis="${row}"][data-member="${of}"]`);
  const field = [...sources].find((each) => each.checkVisibility()) ?? document.getElementById(name);
  if (!field) return null;
  field.setAttribute("aria-invalid", "true");
  const folded = field.closest("details:not(#typed)");
  if (folded) folded.open = true;
  if (name !== "cities" || row === undefined) return field;
  selectLine(field, Number(row));
  return document.querySelector(`#stops [data-row="${row}"]`) ?? field;
}

/** Marks a row of the text: stops are not in the table while the text cannot be read. */
function markText(row) {
  const area = document.getElementById("cities");
  area.setAttribute("aria-invalid", "true");
  area.closest("details").open = true;
  if (row) selectLine(area, Number(row));
  return area;
}

/** Selects a row of text; empty lines are not rows. */
function selectLine(area, row) {
  const line = [...area.value.matchAll(/^.*\S.*$/gm)][row];
  if (line) area.setSelectionRange(line.index, line.index + line[0].length);
}

const NTH = ["first", "second", "third", "fourth"];
const counted = (index) => Number(index) + 1; // as people count

// Sentences of the service about requests, and those that the page shows instead.
const SAID = [
  [/^(start|end) must be a city, 0 to (\d+), got (-?\d+)/, (_, name, last, got) => `${name} must be a stop, 1 to ${counted(last)}, got ${counted(got)}`],
  [/^(start|end) must be the index of a city, as there are no stops with ids/, (_, name) => `${name} must be the number of a stop, as the stops have no names`],
  [/^objectives\/1\/measure (\w+) needs/, (_, measure) => `the second objective, ${measure}, needs`],
  [/\bneeds stops with due\b/, () => "needs stops that are due: write times into their column Due"],
  [/\bneeds vehicles with max_overtime\b/, () => "needs vehicles that may be late: fill their column Most overtime"],
  [/^((?:remove|done|tour)\/\d+ .*), got (\d+)$/, (_, said, got) => `${said}, got ${counted(got)}`],
  [/^remove\/\d+ must be a stop that is not done/, () => "a stop to drop must not be visited yet"],
  [/^(remove|done|tour)\/\d+ must not be \1\/\d+ again/, (_, list) => `${list}/0 must not be given twice`],
  [/^departure is required.*/, () => "say when tours leave: travel changes over the day, or visits take time"],
  [/^clock is required.*/, () => "one objective must be a time: measure it by road, or in straight lines at a speed"],
  [/^objectives\/([0-3])\/unit must be s\b.*?, got/, (_, axis) => `the ${NTH[axis]} objective must be in s, as tours leave at a time of day; its unit is`],
  [/^objectives\/[0-3]\/over_the_day\/(\d+)\/[01]/, (_, at) => `number ${counted(at)} of the rush hours`],
  [/^clock must be the name of an objective.*/, () => "times must be those of one of the objectives"],
  [/\b(start|end)_pose\b/g, (_, role) => role],
  [/^end must not be the start.*/, () => "end must not be the start; leave it empty for a tour that returns"],
  [/^(coordinates|stops) must have 1 item or more.*/, () => "There must be a stop: open a file, add one, or add it on the map"],
];

// The same within sentences.
const WITHIN = [
  [/\bobjectives\/([0-3])\/from \w+$/, (_, axis) => `the ${NTH[axis]} objective, which is measured between places`],
  [/needs the name of the objective that is time, in clock/, "needs times: choose below what windows, shifts and service are"],
  [/must be the id of a type of vehicles/, "must be the name of a vehicle"],
  [/must be the id of a stop/, "must be the name of a stop"],
];

// The same of sentences about the cells of tables.
const IN_CELLS = [
  ...WITHIN,
  [/must be a valid (integer|number|array)\b/, (_, type) => `must be ${{ integer: "a whole number", number: "a number", array: "a list" }[type]}`],
];

/** Replaces names of members in the sentence of a fault by their labels on the page. */
function inWords(fault, field) {
  const label = document.querySelector(`label[for="${field}"]`)?.textContent;
  const detail = [...SAID, ...WITHIN].reduce((said, [pattern, instead]) => said.replace(pattern, instead), fault);
  return detail
    .replace(/^coordinates\/(\d+)\/([0-3])\b/, (_, city, column) => `${COLUMNS[column]} of stop ${Number(city) + 1}`)
    .replace(/^objectives\/([0-3])\/speed\b/, (_, axis) => `the speed of the ${NTH[axis]} objective`)
    .replace(/^objectives\/([0-3])\/measure\b/, (_, axis) => `the ${NTH[axis]} objective`)
    .replace(/\bmatrices\/(\d)\/(\d+)(?:\/(\d+))?/g, (_, axis, from, to) => costsOf(axis, from, to))
    .replace(/\bobjectives\/([0-3])\/(?:matrix|coordinates)\/(\d+)(?:\/(\d+))?/g, (said, axis, from, to) => (said.includes("matrix") ? costsOf(axis, from, to) : `the place of stop ${counted(from)} under the ${NTH[axis]} objective`))
    .replace(/\bobjectives\/([0-3])\/([a-z_]+)(?:\/\w+)*/g, (_, axis, member) => `${member.replaceAll("_", " ")} of the ${NTH[axis]} objective`)
    .replace(/\bobjectives\/([0-3])/g, (_, axis) => `the ${NTH[axis]} objective`)
    .replace(PATH, itemNamed)
    .replace(new RegExp(`^${field}\\b`), label ?? field);
}

const costsOf = (axis, from, to) =>
  `the costs of the ${NTH[axis]} objective from stop ${counted(from)}${to === undefined ? "" : ` to stop ${counted(to)}`}`;

function sentence(detail) {
  return `${detail[0].toUpperCase()}${detail.slice(1)}${detail.endsWith(".") ? "" : "."}`;
}
