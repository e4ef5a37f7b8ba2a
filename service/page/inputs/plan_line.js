/** Say above the Plan button what will be planned, and lead to where it is changed, or on a phone to the stops. */

import { duration } from "../common/durations.js";
import { titled } from "../common/objectives.js";

const element = (id) => document.getElementById(id);

export class PlanLine {
  #form;
  #objectives = [];

  constructor(form) {
    this.#form = form;
    form.addEventListener("input", () => this.#say());
    element("change").addEventListener("click", () => this.#lead());
    element("to-stops").addEventListener("click", () => lead(element("example")));
  }

  /** Takes the objectives of what will be planned. */
  show(objectives) {
    this.#objectives = objectives;
    this.#say();
  }

  #say() {
    element("will-plan").hidden = !this.#objectives.length;
    if (!this.#objectives.length) return;
    const [first, ...others] = this.#objectives.map(({ name }) => name);
    const traded = [titled({ name: first }), others.join(" and ")].join(" against ");
    const seconds = Number(this.#form.time_limit.value);
    element("will-plan").firstElementChild.textContent = `${traded}${seconds > 0 ? `, ${duration(seconds)} of planning` : ""}.`;
  }

  /** Puts the cursor into the first field of the objectives, or where they cannot be changed, of the settings. */
  #lead() {
    const fields = [...document.querySelectorAll("#named :is(input, select), #coverage-fields input, #fields input")];
    const field = fields.find((each) => each.checkVisibility() && !each.disabled);
    if (field) lead(field);
  }
}

function lead(field) {
  field.closest("section").scrollIntoView({ block: "start" });
  field.focus({ preventScroll: true });
}
