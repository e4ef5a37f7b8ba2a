/** Show each fault of an error at its field. A field whose text cannot be taken is invalid. */

import { Problem } from "./service.js";
import { made } from "../common/elements.js";

const FIELD_OF = { coordinates: "cities", matrices: "cities", stops: "cities", closed: "end", clock: "objectives", start_pose: "start", end_pose: "end" };
const REPLANNED = { tour: "at", done: "at", remove: "removed", add: "replan", position: "replan", now: "now" };
for (const member of Object.keys(REPLANNED)) FIELD_OF[member] = "replan";
const COLUMNS = ["x₁", "y₁", "x₂", "y₂"];
const FIELD_OF_CODE = { unauthorized: "key" };
const fieldOf = (member) => FIELD_OF[member] ?? member ?? "request";

/** Shows the faults of a problem at their fields, and all others below the buttons; or all of them in one `place`. */
export function showFaults(problem, place = null) {
  clearFaults();
  const faults = faultsOf(problem);
  let first = null;
  for (const fault of faults) {
    const parts = partsOf(fault.pointer);
    const [member, row, part] = parts;
    const field = FIELD_OF_CODE[problem.code] ?? fieldOf(member);
    const cell = cellOf(parts);
    const said = seen(document.getElementById(`${place ?? cell?.closest(".stops")?.id ?? field}-fault`)) ?? document.getElementById("request-fault");
    said.textContent ||= sentence(inWords(fault, parts, member === "coordinates" ? null : cell?.getAttribute("aria-label")));
    if (place) continue;
    if (cell) cell.setAttribute("aria-invalid", "true");
    first ??= cell ?? (member === "cities" ? markText(row) : mark(REPLANNED[member] ?? field, member === "matrices" ? undefined : row, part));
  }
  first?.focus();
}

/** Requests for plans do not have all fields of the form. */
const seen = (said) => (said?.closest("[hidden]") ? null : said);

/** A problem without faults is one. */
const faultsOf = ({ message, errors = [] }) => (errors.length ? errors : [{}]).map((fault) => ({ detail: message, ...fault }));

const partsOf = (pointer = "") => pointer.split("/").slice(1);

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

// What the page calls an item of a request, where the service says its place, as "stops/3/window/0".
const ITEMS = {
  stops: "stop", coordinates: "stop", vehicles: "vehicle", shipments: "shipment", robots: "robot",
  places: "place", relations: "relation", initial_tours: "tour to begin with", cost_layers: "further cost",
  remove: "a stop to drop", done: "a visited stop", add: "a new stop", tour: "a stop of the tour",
};
const UNCOUNTED = ["remove", "done", "add", "tour"]; // named one by one in one field, where their places say nothing

/** What people call a part of a request: an item by its name on the page, or counted from 1; a field by its label. */
export function nameOf([list, at, ...members], field = "") {
  if (at !== undefined && list === "objectives") return ofObjective(at, members);
  if (at !== undefined && list === "matrices" && members.length) return costsOf(at, ...members);
  if (list === "coordinates" && members[0] in COLUMNS) return `${COLUMNS[members[0]]} of stop ${counted(at)}`;
  if (at !== undefined && list in ITEMS) return itemNamed(list, at, members);
  const name = withoutPose(list);
  const label = name === field && document.querySelector(`label[for="${field}"]`)?.textContent;
  return [label || name, ...(at === undefined ? [] : [at, ...members])].join("/");
}

/** An item, and the member of it that is meant, as "window of order-17". */
function itemNamed(list, at, rest) {
  const members = rest.filter((part) => !/^\d+$/.test(part)).map((part) => withoutPose(part).replaceAll("_", " "));
  const name = document.querySelector(`#${list} [data-row="${at}"][data-column="name"]`)?.value;
  const item = UNCOUNTED.includes(list) ? ITEMS[list] : `${ITEMS[list]} ${name || counted(at)}`;
  return members.length ? `${members.join(" ")} of ${item}` : item;
}

function ofObjective(axis, [member, at, to]) {
  const objective = `the ${NTH[axis]} objective`;
  if (!member || member === "measure") return objective;
  if (member === "matrix" && at) return costsOf(axis, at, to);
  if (member === "coordinates" && at) return `the place of stop ${counted(at)} under ${objective}`;
  if (member === "over_the_day" && to) return `number ${counted(at)} of the rush hours`;
  return `${member === "speed" ? "the " : ""}${member.replaceAll("_", " ")} of ${objective}`;
}

const withoutPose = (member = "") => member.replace("_pose", ""); // the page has one field for both

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

// Sentences of the service that the page says otherwise, by the code of the fault.
const SAID = {
  "too-few": (_, parts) => ["coordinates", "stops"].includes(parts.join()) && "There must be a stop: open a file, add one, or add it on the map",
  "no-departure": () => "say when tours leave: travel changes over the day, or visits take time",
  "no-time": () => "one objective must be a time: measure it by road, or in straight lines at a speed",
  "clock-with-costs": () => "times must be those of one of the objectives",
  "not-in-seconds": ({ came }, [, axis]) => `the ${NTH[axis]} objective must be in s, as tours leave at a time of day; its unit is ${came}`,
  "other-unit": (values, parts) => values.unit === "s" && parts[0] === "objectives" && SAID["not-in-seconds"](values, parts),
};

// What the service demands of a part, where the page says it otherwise.
const DEMANDS = {
  "not-an-index": ({ last, came }, [member]) => ["start", "end"].includes(member) && `must be a stop, 1 to ${counted(last)}, got ${counted(came)}`,
  "no-ids": ({ came }, [member]) => ["start", "end"].includes(member) && `must be the number of a stop, as the stops have no names, got ${came}`,
  "not-an-id": (values) => `must be the name of a stop, got ${cameOf(values)}`,
  "not-a-vehicle": (values) => `must be the name of a vehicle, got ${cameOf(values)}`,
  "no-due": () => "needs stops that are due: write times into their column Due",
  "no-window-or-due": () => "needs stops with times: fill their column Window or Due",
  "measure-without-spread": () => "needs times that vary from day to day: write by how much",
  "no-overtime": () => "needs vehicles that may be late: fill their column Most overtime",
  "end-is-start": () => "must not be the start; leave it empty for a tour that returns",
  "end-place-is-start": () => "must not be the start; leave it empty for a tour that returns",
  "no-location": ({ other }) => {
    const [member, axis] = partsOf(other);
    return member === "objectives" && `is required by ${nameOf([member, axis])}, which is measured between places`;
  },
  untimed: () => "needs times: choose below what windows, shifts and service are",
  visited: ({ came }) => `must not be visited yet, got ${came}`,
  "named-twice": ({ came }) => `must not be given twice, got ${came}`,
};
const KINDS = { "int-type": "a whole number", "int-parsing": "a whole number", "int-from-float": "a whole number", "float-type": "a number", "list-type": "a list" };
const COUNTED = ["remove", "done", "tour"]; // lists of stops, which the service counts from 0

/** The sentence of a fault in the words of the page. */
function inWords({ code, detail, demand, values = {} }, parts, cell) {
  const said = SAID[code]?.(values, parts);
  if (said || !demand || !parts.length) return said || detail;
  const name = cell ?? nameOf(parts, fieldOf(parts[0]));
  if (cell && code in KINDS) return `${name} must be ${KINDS[code]}, got ${values.came}`;
  const { measure, came } = values;
  if (COUNTED.includes(parts[0]) && parts.length === 2 && Number.isInteger(came)) return `${name} ${ofStops(demand, code, values)}`;
  const own = DEMANDS[code]?.(values, parts);
  if (parts[2] !== "measure" || !measure) return `${name} ${own || withNames(demand, values)}`;
  return `${name}, ${measure}, ${own || demand.slice(measure.length + 1)}`;
}

/** A demand on a stop by its number, which the page counts from 1. */
function ofStops(demand, code, { came }) {
  const number = counted(came);
  return DEMANDS[code]?.({ came: number }, []) || `${demand.slice(0, -`${came}`.length)}${number}`;
}

const cameOf = ({ came, near }) => `${came}${near ? `; did you mean ${JSON.stringify(near)}?` : ""}`;

/** A demand with what the page calls the other part of the request in it. */
const withNames = (demand, { other }) => (other ? demand.replace(other.slice(1), nameOf(partsOf(other))) : demand);

const costsOf = (axis, from, to) =>
  `the costs of the ${NTH[axis]} objective from stop ${counted(from)}${to === undefined ? "" : ` to stop ${counted(to)}`}`;

function sentence(detail) {
  return `${detail[0].toUpperCase()}${detail.slice(1)}${detail.endsWith(".") ? "" : "."}`;
}
