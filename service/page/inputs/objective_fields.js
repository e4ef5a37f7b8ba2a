/** The fields of the objectives: names and units, and for stops how each is measured. */

import { isOwnName } from "../planning/faults.js";
import { OWN_COSTS } from "./stops.js";

const TIMED = "speed"; // straight lines at a speed
export const SPEED = 30; // km/h, until another is typed
const SOURCES = { great_circle: "Straight lines, m", [TIMED]: "Time in straight lines, s", road_time: "Time by road, s", road_distance: "Way by road, m" };
const NTH = ["First", "Second", "Third", "Fourth"].map((each) => `${each} objective`);
const OWN = "own"; // costs that came with the stops
const MISSING = "no routing engine here";
const SHORT = 9; // letters of a unit for which there is room beside the name
let roads = true; // whether costs by road can be had

/** Greys all measures by road, from now on. */
export function offerNoRoads() {
  roads = false;
  for (const each of document.querySelectorAll('[data-member="source"] option')) greyed(each);
}

function greyed(option) {
  if (roads || !option.value.startsWith("road_")) return option;
  return Object.assign(option, { disabled: true, textContent: `${SOURCES[option.value]} (${MISSING})` });
}

export class ObjectiveFields {
  #element;
  #own = []; // the objectives that came with costs of their own

  /** @param {(axis: number, change: object) => void} onChange called with new members of one objective */
  constructor(element, onChange) {
    this.#element = element;
    element.addEventListener("change", ({ target }) => {
      const axis = Number(target.dataset.axis);
      if (target.dataset.member === "source") showSpeed(target);
      if (target.dataset.member === "name" && !this.#isName(target)) return;
      onChange(axis, this.#changed(axis, target.dataset.member, target.value.trim()));
    });
  }

  #isName(input) {
    const names = [...this.#element.querySelectorAll('[data-member="name"]')].map(({ value }) => value.trim());
    const [name] = names.splice(input.dataset.axis, 1);
    return isOwnName(input, name, names, "objective");
  }

  /** Shows the objectives under their titles; those of a request for stops have sources, others only names and units. */
  show(objectives, sourced, titles = NTH) {
    this.#own = objectives;
    this.#element.replaceChildren(...objectives.map((each, axis) => line(each, axis, sourced, titles[axis])));
  }

  #changed(axis, member, value) {
    if (member === "speed") return { speed: speedIn(value) };
    if (member !== "source") return { [member]: value || undefined };
    if (value === OWN) return { from: undefined, speed: undefined, ...Object.fromEntries(OWN_COSTS.map((own) => [own, this.#own[axis][own]])) };
    // A unit that was typed for another source would be wrong; the service knows that of the source.
    const others = ["unit", ...OWN_COSTS, "traffic"];
    const left = Object.fromEntries(others.map((other) => [other, undefined]));
    return value === TIMED ? { from: "great_circle", speed: SPEED, ...left } : { from: value, speed: undefined, ...left };
  }
}

/** The fields of one objective. A measure of plans has only a name. */
function line(objective, axis, sourced, which) {
  const { name, unit, measure } = objective;
  const made = Object.assign(document.createElement("div"), { className: "objective" });
  made.append(labelled(which, input(axis, "name", name ?? "")));
  if (measure) return made;
  made.classList.toggle("long", (unit ?? "").length > SHORT);
  made.append(labelled("Unit", input(axis, "unit", unit ?? ""), `Unit of the ${which.toLowerCase()}`));
  if (!sourced) return made;
  const speed = input(axis, "speed", objective.speed ?? SPEED);
  speed.inputMode = "decimal";
  const chosen = source(axis, objective);
  made.append(
    labelled("Measured by", chosen, `What the ${which.toLowerCase()} is measured by`),
    labelled("Speed, km/h", speed, `Speed of the ${which.toLowerCase()}, km/h`),
  );
  showSpeed(chosen);
  return made;
}

/** Shows the speed of an objective only where it has one, with the default when it is chosen anew. */
function showSpeed(chosen) {
  const speed = chosen.closest(".objective").querySelector('[data-member="speed"]');
  speed.closest("label").hidden = chosen.value !== TIMED;
  if (chosen.value !== TIMED) speed.value = SPEED;
}

/** The number that was typed; what is not a number stays as it is, so that the service names it. */
function speedIn(text) {
  const number = Number(text.replace(",", "."));
  return text === "" || Number.isNaN(number) ? text : number;
}

/** Whether the service takes the speed of a change. */
export const isSpeedRead = ({ speed = SPEED }) => speed >= 0.001 && speed <= 1000;

function labelled(title, input, label = title) {
  const made = document.createElement("label");
  input.setAttribute("aria-label", label);
  made.append(title, input);
  return made;
}

const input = (axis, member, value) => marked(Object.assign(document.createElement("input"), { value, autocomplete: "off" }), axis, member);

function source(axis, { from, speed, ...costs }) {
  const made = marked(document.createElement("select"), axis, "source");
  if (OWN_COSTS.some((name) => costs[name])) made.append(new Option(costs.coordinates ? "A plane from the file" : "Costs from the file", OWN));
  made.append(...Object.entries(SOURCES).map(([name, title]) => greyed(new Option(title, name))));
  made.value = from === "great_circle" && speed != null ? TIMED : (from ?? OWN);
  return made;
}

function marked(input, axis, member) {
  Object.assign(input.dataset, { axis, member });
  return input;
}
