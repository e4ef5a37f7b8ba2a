/** The fields of a request: their names, and which kinds of request have them. */

import { poseIn } from "./map_ends.js";
import { nameOf, stopNamed } from "./places.js";
import { nameOf as labelled } from "../planning/faults.js";

const ENDS = ["start", "end"];

// From the service's own fields. Requests for plans have those that say so, others have all; those of coverage stand where there is a grid.
const FIELDS = JSON.parse(document.querySelector("#fields-of-requests").textContent);

const BOXES = FIELDS.filter(({ name, box }) => box && name !== "open").map(({ name }) => name);

/** The names of the settings of how to plan: all fields but the ends of tours. */
export const SETTINGS = FIELDS.map(({ name }) => name).filter((name) => !ENDS.includes(name));

const OFFERED = 1000; // the most names in a list that a browser opens without delay

export class Fields {
  #form;
  #coverage;
  #layered = false; // whether the map has layers of costs, which paths may heed
  #plans = false; // whether the request is for plans
  #ids = null; // the ids of the stops, if they have them
  #brought = {}; // the settings that the request before named

  constructor(form) {
    this.#form = form;
    this.#coverage = form.querySelector("#coverage-fields");
    for (const field of FIELDS) {
      const place = field.where ? `#${field.where}-fields` : "#fields";
      form.querySelector(place).append(field.box ? madeBox(field) : made(field));
    }
  }

  /** The filled-in values. What is not a number stays as it is, so that the service names it. */
  get members() {
    const asked = FIELDS.filter((field) => this.#has(field));
    const texts = asked.filter(({ box }) => !box).map(({ name }) => [name, this.#form[name].value.trim()]);
    const filled = texts.filter(([, text]) => text);
    const given = filled.map(([name, text]) => this.#member(name, text));
    if (this.#plans) return Object.fromEntries(given);
    const ticked = BOXES.filter((name) => this.#form[name].checked && (name !== "detours" || this.#layered));
    const ends = this.#ends(filled.map(([name]) => name));
    return { ...Object.fromEntries([...given, ...ticked.map((name) => [name, true])]), ...ends };
  }

  /** The filled-in values but for the ends of tours. */
  get planning() {
    return Object.fromEntries(Object.entries(this.members).filter(([name]) => SETTINGS.includes(name)));
  }

  /** The first that is not a number, or an end that is not a stop, as an error of a request; undefined if there is none. */
  get fault() {
    const found = Object.entries(this.members).find(([, value]) => typeof value === "string" && !this.#ids?.includes(value));
    if (!found) return undefined;
    const [name] = found;
    return { pointer: `/${name}`, detail: `${labelled([name], name)} must be ${ENDS.includes(name) ? `the ${this.#ids ? "name" : "number"} of a stop` : "a number"}` };
  }

  /** Takes the names of stops, and offers them in the fields. */
  name(ids, cities) {
    if (this.#form.start.value === nameOf(this.#ids, 0)) this.#form.start.value = nameOf(ids, 0);
    this.#ids = ids;
    const names = Array.from({ length: Math.min(cities, OFFERED) }, (_, city) => new Option(nameOf(ids, city)));
    this.#form.querySelector("#stop-names").replaceChildren(...names);
  }

  /** The name and the value of the member that a field asks for. On a map, x and y are a pose. */
  #member(name, text) {
    if (!ENDS.includes(name)) return [name, numberOr(text)];
    const pose = this.#coverage.hidden ? null : poseIn(text);
    return pose ? [`${name}_pose`, pose] : [name, stopNamed(this.#ids, text)];
  }

  /** Puts an end of a tour on a map into its field: a place, a pose, or neither. */
  put(name, { place, pose }) {
    const none = name === "start" && !this.#form.open.checked ? nameOf(null, 0) : "";
    this.#form[name].value = pose?.join(", ") ?? (place === undefined ? none : nameOf(null, place));
  }

  /** What open routes need: that they are, and that an empty start leaves it to them. */
  #ends(given) {
    if (!this.#form.open.checked && !given.includes("end")) return {};
    return { closed: false, ...(given.includes("start") ? {} : { start: null }) };
  }

  /** Takes the settings that a request of a kind names, and gives back its other members. */
  take(request, { onGrid, movers }) {
    const rest = { ...request };
    this.#coverage.hidden = !onGrid;
    this.#layered = onGrid && Boolean(request.cost_layer || request.cost_layers);
    this.#show(Boolean(movers));
    this.#ids = request.stops?.map(({ id }) => id) ?? request.ids ?? null;
    if (!this.#plans) this.#takeRoute(rest);
    this.#forget();
    for (const field of FIELDS) {
      const { name, where, box } = field;
      if (box || ENDS.includes(name) || !this.#has(field)) continue;
      if (where === "coverage") this.#form[name].value = "";
      // What is there and no number, as a list of angles, is left as it is, unless one is typed.
      if (request[name] != null) this.#form[name].value = "";
      if (typeof request[name] !== "number") continue;
      this.#brought[name] = this.#form[name].value = String(request[name]);
      delete rest[name];
    }
    return rest;
  }

  /** Puts back what the request before brought, as an example its seed. What was typed since stays. */
  #forget() {
    for (const { name, value } of FIELDS) {
      if (this.#form[name].value === this.#brought[name]) this.#form[name].value = value;
    }
    this.#brought = {};
  }

  /** Shows the fields that requests for plans have, or all; the size is of what is planned. */
  #show(plans) {
    this.#plans = plans;
    for (const field of FIELDS) this.#form[field.name].parentElement.hidden = plans && !field.plans;
    this.#form.detours.parentElement.hidden = plans || !this.#layered;
    this.#form.querySelector('label[for="size"]').textContent = plans ? "Plans" : "Tours";
  }

  /** Whether the request has this field. */
  #has({ where, plans }) {
    return (plans || !this.#plans) && (where !== "coverage" || !this.#coverage.hidden);
  }

  /** Takes what is ticked and the ends, each an index, an id, or missing; a null start may be anywhere. */
  #takeRoute(rest) {
    this.#form.open.checked = rest.closed === false;
    for (const name of BOXES) this.#form[name].checked = rest[name] === true;
    const shown = (stop) => (typeof stop === "number" ? nameOf(this.#ids, stop) : (stop ?? ""));
    this.#form.start.value = rest.start_pose?.join(", ") ?? (rest.start === null ? "" : shown(rest.start ?? 0));
    this.#form.end.value = rest.end_pose?.join(", ") ?? shown(rest.end);
    for (const name of ["closed", ...BOXES, ...ENDS, "start_pose", "end_pose"]) delete rest[name];
  }
}

function numberOr(text) {
  const number = Number(text);
  return Number.isNaN(number) ? text : number;
}

function madeBox({ name, label }) {
  const caption = Object.assign(document.createElement("label"), { className: "box" });
  const input = Object.assign(document.createElement("input"), { id: name, name, type: "checkbox" });
  caption.append(input, label);
  return caption;
}

function made({ name, label, value }) {
  const field = document.createElement("div");
  field.className = "field";
  const caption = Object.assign(document.createElement("label"), { htmlFor: name, textContent: label });
  const input = Object.assign(document.createElement("input"), { id: name, name, value });
  if (ENDS.includes(name)) input.setAttribute("list", "stop-names");
  else input.inputMode = "decimal";
  input.autocomplete = "off";
  input.setAttribute("aria-describedby", `${name}-fault`);
  const fault = Object.assign(document.createElement("p"), { id: `${name}-fault`, className: "fault" });
  fault.setAttribute("role", "alert");
  field.append(caption, input, fault);
  return field;
}
