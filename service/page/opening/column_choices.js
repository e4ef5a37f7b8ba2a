/** Show what the columns of an open table were taken for, as lists in which something else can be chosen. */

import { made } from "../common/elements.js";

const LABELS = {
  id: "name",
  place: "place",
  demand: "load",
  pickup: "load taken back",
  profile: "kind of vehicle, for its roads",
  service: "time at the stop",
  due: "due, late from then on",
  due_from: "wanted from, early before",
  urgency: "urgency",
  release: "ready from",
  vehicle: "vehicle that serves it",
  cost: "cost by the metre",
  prize: "prize for serving it",
  together: "rides with",
  apart: "does not ride with",
  before: "comes before",
  after: "comes after",
  waits_for: "waits until these are done",
  fixed: "cost of using it",
  per_km: "cost by the kilometre",
  per_hour: "cost by the hour",
  detail: "shown to the driver",
  ignored: "not used",
};

export class ColumnChoices {
  #element;
  #list;
  #onChosen;
  #files = [];
  #chosen = []; // columns with what was chosen for them, of these files
  #last = null; // the list in which something was chosen last

  /**
   * @param {HTMLDetailsElement} element with a `dl`
   * @param {(files: File[], columns: object[]) => void} onChosen called to read files anew, with all that was chosen
   */
  constructor(element, onChosen) {
    this.#element = element;
    this.#list = element.querySelector("dl");
    this.#onChosen = onChosen;
    this.#list.addEventListener("change", ({ target }) => this.#choose(target));
  }

  /** Shows the columns of files that were read, or refused; `chosen` is what was chosen for them before. */
  show(files, chosen, { columns = [], choices = {} }) {
    this.#files = files;
    this.#chosen = chosen;
    this.#list.replaceChildren(...columns.flatMap((each, at) => row(each, at, choices[each.file] ?? [])));
    this.#element.hidden = !columns.length;
    this.#element.open = true;
    if (!columns.length) return;
    if (document.activeElement === document.body) document.getElementById(this.#last)?.focus(); // it was replaced
    this.#last = null;
  }

  clear() {
    this.show([], [], {});
  }

  #choose({ id, dataset: { file, name }, value }) {
    this.#last = id;
    const others = this.#chosen.filter((each) => each.file !== file || each.name !== name);
    this.#onChosen(this.#files, [...others, { file, name, taken_for: value }]);
  }
}

function row({ file, name, taken_for: taken }, at, choices) {
  const id = `column-${at}`;
  const label = made("label", { htmlFor: id }, name || `column ${at + 1}`);
  const list = made("select", { id });
  Object.assign(list.dataset, { file, name });
  const offered = choices.includes(taken) ? choices : [taken, ...choices];
  list.append(...offered.map((each) => new Option(labelOf(each), each)));
  list.value = taken;
  list.classList.toggle("ignored", taken === "ignored");
  return [made("dt", {}, label), made("dd", {}, list)];
}

const labelOf = (field) => LABELS[field] ?? field.replaceAll("_", " ");
