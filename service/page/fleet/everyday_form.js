/** Ask above the tables of a fleet what every dispatcher has: a depot, minutes at the stops, shifts, time to spare, and a speed. */

import { Placing } from "../inputs/placing.js";
import { cellText, hintOf, withText } from "./cells.js";
import { everydayIn, isAskable, missingSaid, recalled, rememberedOf, wholeShift, withDepot, withDepotAt, withLeave, withReload, withService, withShift, withSlack, withSpeed } from "./everyday.js";
import { remember, remembered } from "./remembered.js";

const element = (id) => document.getElementById(id);
const COLUMNS = {
  service: { member: "service", type: "lasting" },
  shift: { member: "shift", type: "spans" },
  slack: { member: "slack", type: "lasting" },
  time: { member: "time", type: "time" },
  speed: { member: "speed", type: "limit" },
};
const INPUTS = ["depot", "service", "shift", "slack", "speed"];

export class EverydayForm {
  #onChange;
  #asked = null;
  #placing;
  #recalled = ""; // what was taken from last time, or from a stop

  /** @param {(asked: object) => void} onChange called with the changed request */
  constructor(onChange) {
    this.#onChange = onChange;
    this.#placing = new Placing(element("place-depot"), element("everyday-help"), (location) => this.#take("depot", withDepot(this.#asked, { location })), () => {}, { once: true });
    element("everyday-reload").addEventListener("change", ({ target }) => this.#take("reload", withReload(this.#asked, target.checked)));
    element("everyday-leave").addEventListener("change", ({ target }) => this.#take("leave", withLeave(this.#asked, target.value)));
    for (const name of INPUTS) element(`everyday-${name}`).addEventListener("change", ({ target }) => this.#typed(name, target));
  }

  /** Takes the place where a map was clicked. */
  clicked(...place) {
    this.#placing.clicked(...place);
  }

  /** Shows what a request gives; null hides the form. */
  show(asked) {
    const isOther = !asked || !this.#asked;
    this.#asked = asked && isAskable(asked) ? asked : null;
    element("everyday").hidden = !this.#asked;
    if (isOther) this.#placing.stop();
    if (!this.#asked) return;
    const given = everydayIn(asked);
    element("everyday-depot").value = given.depot ?? "";
    element("everyday-service").value = cellText(given, COLUMNS.service, 1);
    element("everyday-shift").value = cellText(given, COLUMNS.shift, 1);
    element("everyday-slack").value = cellText(given, COLUMNS.slack, 1);
    element("everyday-leave").value = given.leave;
    element("everyday-speed").value = given.speed ?? "";
    Object.assign(element("everyday-reload"), { checked: Boolean(given.reload), indeterminate: given.reload === undefined, disabled: given.depot === null });
    element("everyday-speed").parentElement.hidden = given.speed === null;
    for (const name of INPUTS) {
      const input = element(`everyday-${name}`);
      input.placeholder = given[name] === undefined ? "in the table" : (input.dataset.example ?? "");
      input.removeAttribute("aria-invalid");
    }
    element("everyday-fault").textContent = "";
    element("file-notes").classList.toggle("has-depot", !given.missing.depot);
    element("everyday-said").textContent = [this.#recalled, missingSaid(given)].filter(Boolean).join(" ");
  }

  /** Forgets what was said of the request before. */
  open() {
    this.#recalled = "";
  }

  /** Fills in what is remembered and a file does not give. Returns whether that is anything. */
  recall() {
    if (!this.#asked) return false;
    const { asked, said } = recalled(this.#asked, remembered());
    if (!said.length) return false;
    this.#recalled = `As last time: ${said.join(", ")}.`;
    this.#onChange(asked);
    return true;
  }

  #typed(name, input) {
    const text = input.value.trim();
    const changed = this.#changed(name, text);
    if (changed) return this.#take(name, changed, name === "depot" && everydayIn(changed).depot !== text && text ? `The depot is where ${text} is.` : "");
    input.setAttribute("aria-invalid", "true");
    const hint = name === "depot" ? "the name of a stop, or click where it is" : name === "shift" ? "when shifts begin, as 8:00, or when they begin and end, as 8:00-16:00" : hintOf(COLUMNS[name], 1);
    element("everyday-fault").textContent = `That cannot be “${text}”: write ${hint}.`;
  }

  /** The request with what was typed; undefined if that is not understood. */
  #changed(name, text) {
    if (name === "depot") return text ? withDepotAt(this.#asked, text) : withoutDepot(this.#asked);
    const value = text ? read(name, text) : null;
    if (value === undefined || (name === "speed" && value === null)) return undefined;
    return { service: withService, shift: withShift, slack: withSlack, speed: withSpeed }[name](this.#asked, value);
  }

  /** Takes a request with something else in it, and remembers that. */
  #take(name, asked, said = "") {
    this.#recalled = said;
    this.#onChange(asked);
    if (this.#asked) remember({ ...remembered(), [name]: rememberedOf(this.#asked)[name] });
  }
}

/** A text as a number, or a shift as its begin and end, in seconds; undefined if it is not understood. */
function read(name, text) {
  const value = withText({}, COLUMNS[name], text, 1)[name];
  if (name !== "shift") return typeof value === "string" ? undefined : value;
  if (Array.isArray(value)) return value.length === 1 ? value[0] : undefined;
  const { time } = withText({}, COLUMNS.time, text, 1);
  return typeof time === "string" ? undefined : wholeShift([time]);
}

/** The request whose vehicles start and end anywhere, if they did so at one depot. */
function withoutDepot(asked) {
  const vehicles = asked.vehicles.map(({ start: _, end: __, reload: ___, ...others }) => others);
  return everydayIn(asked).depot === undefined ? undefined : { ...asked, vehicles };
}
