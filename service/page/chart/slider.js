/** A slider from the least first length of a front to the least second; arrow keys go tour by tour. */

import { figure } from "../common/amounts.js";
import { UNNAMED } from "../common/objectives.js";
import { nearest } from "../result/tours.js";
import { markAt, ticks } from "./ticks.js";

const STEPS = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 10, PageDown: -10 };

export class BalanceSlider {
  #input;
  #shown;
  #ticks = ticks();
  #front = [];
  #balance = 0; // the index of the selected tour
  #objectives = UNNAMED;
  #noun; // of what the front holds

  /** @param {(index: number) => void} onSelect called with the tour to select */
  constructor(input, shown, onSelect) {
    this.#input = input;
    this.#shown = shown;
    input.after(this.#ticks);
    input.addEventListener("input", () => onSelect(nearest(this.#front, Number(input.value))));
    input.addEventListener("change", () => (input.value = this.#balance));
    input.addEventListener("keydown", (event) => this.#step(event, onSelect));
  }

  name(objectives) {
    this.#objectives = objectives;
  }

  show(front, noun) {
    this.#front = front;
    this.#noun = noun;
    this.#input.disabled = front.length < 2;
    markAt(this.#ticks, front.map(({ balance }) => balance));
    if (!front.length) this.#shown.textContent = "";
  }

  /** Moves to a tour of the front, but leaves the thumb alone while it is dragged next to that tour. */
  select(index) {
    const { balance, lengths } = this.#front[index];
    this.#balance = balance;
    if (!this.#input.matches(":active") || nearest(this.#front, Number(this.#input.value)) !== index) this.#input.value = balance;
    const at = balance.toFixed(2);
    const place = `${this.#noun.one} ${index + 1} of ${this.#front.length}`;
    this.#shown.textContent = place;
    const said = this.#objectives.map((objective, axis) => `${objective.name} ${figure(lengths[axis], objective)}`);
    this.#input.setAttribute("aria-valuetext", `${at}, ${place}: ${said.join(", ")}`);
  }

  #step(event, onSelect) {
    const last = this.#front.length - 1;
    const index = nearest(this.#front, Number(this.#input.value));
    const ends = { Home: 0, End: last };
    const wanted = ends[event.key] ?? index + STEPS[event.key];
    if (Number.isNaN(wanted)) return;
    event.preventDefault();
    onSelect(Math.min(Math.max(wanted, 0), last));
  }
}
