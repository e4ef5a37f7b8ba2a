/** The fields of the objectives: names and units, and for stops how each is measured. */

import { namesIn } from "../common/objectives.js";

const SOURCES = { great_circle: "Straight lines, m", road_time: "Time by road, s", road_distance: "Way by road, m" };
const NTH = ["First", "Second", "Third", "Fourth"];
const OWN = "own"; // costs that came with the stops

export class ObjectiveFields {
  #element;
  #own = []; // the objectives that came with costs of their own
  #shown = [];

  /** @param {(axis: number, change: object) => void} onChange called with new members of one objective */
  constructor(element, onChange) {
    this.#element = element;
    element.addEventListener("change", ({ target }) => {
      const axis = Number(target.dataset.axis);
      onChange(axis, this.#changed(axis, target.dataset.member, target.value.trim()));
    });
  }

  /** Shows the objectives; those of a request for stops have sources, others only names and units. */
  show(objectives, sourced) {
    this.#own = objectives;
    this.#shown = sourced ? namesIn({ objectives }) : objectives;
    this.#element.replaceChildren(...this.#shown.map((named, axis) => line(named, axis, sourced && objectives[axis])));
  }

  #changed(axis, member, value) {
    if (member !== "source") return { [member]: value || undefined };
    const { matrix, coordinates } = this.#own[axis];
    // A unit that was typed for another source would be wrong; the service knows that of the source.
    return value === OWN ? { from: undefined, matrix, coordinates } : { from: value, unit: undefined, matrix: undefined, coordinates: undefined };
  }
}

function line({ name, unit }, axis, objective) {
  const made = Object.assign(document.createElement("div"), { className: "objective" });
  const which = `${NTH[axis]} objective`;
  made.append(labelled(which, input(axis, "name", name)), labelled("Unit", input(axis, "unit", unit), `Unit of the ${which.toLowerCase()}`));
  if (objective) made.append(labelled("Measured by", source(axis, objective), `What the ${which.toLowerCase()} is measured by`));
  return made;
}

function labelled(title, input, label = title) {
  const made = document.createElement("label");
  input.setAttribute("aria-label", label);
  made.append(title, input);
  return made;
}

const input = (axis, member, value) => marked(Object.assign(document.createElement("input"), { value, autocomplete: "off" }), axis, member);

function source(axis, { from, matrix, coordinates }) {
  const made = marked(document.createElement("select"), axis, "source");
  if (matrix || coordinates) made.append(new Option(matrix ? "Costs from the file" : "A plane from the file", OWN));
  made.append(...Object.entries(SOURCES).map(([name, title]) => new Option(title, name)));
  made.value = from ?? OWN;
  return made;
}

function marked(input, axis, member) {
  Object.assign(input.dataset, { axis, member });
  return input;
}
