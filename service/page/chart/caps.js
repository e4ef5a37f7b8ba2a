/** Limits on three or more objectives: a slider each, whose track shows what is left within the other limits. */

import { amount } from "../common/amounts.js";
import { titled } from "../common/objectives.js";

const STEPS = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 10, PageDown: -10 };

export class Caps {
  #element;
  #onLimits;
  #rows = []; // of each objective: its slider, and what is said beside it
  #front = [];
  #objectives = [];
  #limits = []; // of each objective, Infinity where there is none

  /** @param {() => void} onLimits called when a limit has changed */
  constructor(element, onLimits) {
    this.#element = element;
    this.#onLimits = onLimits;
  }

  /** Shows a front under its objectives; limits stay where a front of as many was shown before. */
  show(front, objectives) {
    const same = this.#limits.length === objectives.length;
    this.#front = front;
    this.#limits = same ? this.#limits : objectives.map(() => Infinity);
    if (!same || objectives.some(({ name }, at) => name !== this.#objectives[at]?.name)) this.#make(objectives);
    this.#objectives = objectives;
    this.#loosen();
    this.#draw();
  }

  /** Removes all limits. */
  forget() {
    this.#limits = [];
    this.#front = [];
  }

  /** Whether each tour of the front is within all limits. */
  get within() {
    return this.#front.map((tour) => this.#allows(tour));
  }

  /** The tour within all limits that has the least sum of losses. */
  get middle() {
    const sums = this.#front.map((tour) => (this.#allows(tour) ? tour.losses.reduce((sum, loss) => sum + loss, 0) : Infinity));
    return sums.indexOf(Math.min(...sums));
  }

  /** The limits in words, or how to set one. */
  get said() {
    const left = this.within.filter(Boolean).length;
    if (left === this.#front.length) return "No limits. Move a slider to say what an objective may be at most.";
    return `${left} of ${this.#front.length} are within the limits.`;
  }

  /** Removes the limits that a chosen tour is beyond. */
  release({ lengths }) {
    if (lengths.every((value, axis) => value <= this.#limits[axis])) return;
    this.#limits = this.#limits.map((most, axis) => (lengths[axis] <= most ? most : Infinity));
    this.#draw();
  }

  #allows({ lengths }, but = -1) {
    return lengths.every((value, axis) => axis === but || value <= this.#limits[axis]);
  }

  /** The lengths under one objective of the tours within the limits of all others, ascending. */
  #left(axis) {
    const found = this.#front.filter((tour) => this.#allows(tour, axis)).map(({ lengths }) => lengths[axis]);
    return found.sort((a, b) => a - b);
  }

  /** Removes limits in another front until it has a tour within them. */
  #loosen() {
    while (this.#front.length && !this.#front.some((tour) => this.#allows(tour))) {
      this.#limits[this.#limits.findLastIndex(Number.isFinite)] = Infinity;
    }
  }

  #make(objectives) {
    this.#rows = objectives.map((objective, axis) => {
      const slider = Object.assign(document.createElement("input"), { type: "range", step: "any", id: `cap-${axis}` });
      const said = Object.assign(document.createElement("output"), { htmlFor: slider.id });
      slider.addEventListener("input", () => this.#set(axis, Number(slider.value)));
      slider.addEventListener("change", () => this.#draw());
      slider.addEventListener("keydown", (event) => this.#step(axis, event));
      return { slider, said };
    });
    const parts = this.#rows.flatMap(({ slider, said }, axis) => {
      const label = Object.assign(document.createElement("label"), { htmlFor: slider.id, textContent: titled(objectives[axis]) });
      return [label, slider, said];
    });
    this.#element.replaceChildren(...parts);
  }

  /** From tour to tour of those within the other limits; Home is the tightest limit, End and Escape none. */
  #step(axis, event) {
    const left = this.#left(axis);
    const ends = { Home: left[0], End: Infinity, Escape: Infinity };
    if (!(event.key in STEPS) && !(event.key in ends)) return;
    event.preventDefault();
    if (event.key in ends) return this.#set(axis, ends[event.key]);
    const at = left.findLastIndex((value) => value <= this.#limits[axis]);
    this.#set(axis, left[Math.min(Math.max(at + STEPS[event.key], 0), left.length - 1)]);
  }

  /** A limit is never below the least that the other limits leave. */
  #set(axis, wanted) {
    const left = this.#left(axis);
    this.#limits[axis] = wanted >= this.#ends(axis)[1] ? Infinity : Math.max(wanted, left[0]);
    this.#draw();
    this.#onLimits();
  }

  #ends(axis) {
    const all = this.#front.map(({ lengths }) => lengths[axis]);
    return [Math.min(...all), Math.max(...all)];
  }

  #draw() {
    this.#rows.forEach(({ slider, said }, axis) => {
      slider.disabled = this.#front.length < 2;
      if (!this.#front.length) return;
      const [least, most] = this.#ends(axis);
      const left = this.#left(axis);
      const limit = Math.min(this.#limits[axis], most);
      Object.assign(slider, { min: least, max: most });
      slider.value = limit;
      const share = (value) => `${(100 * (value - least)) / (most - least || 1)}%`;
      slider.style.setProperty("--from", share(left[0]));
      slider.style.setProperty("--to", share(left.at(-1)));
      const atMost = Number.isFinite(this.#limits[axis]) ? `at most ${this.#amount(axis, limit)}` : "no limit";
      said.textContent = atMost;
      const range = `${this.#amount(axis, left[0])} to ${this.#amount(axis, left.at(-1))} within the other limits`;
      slider.setAttribute("aria-valuetext", `${atMost}; ${range}`);
    });
  }

  #amount(axis, value) {
    return amount(value, this.#objectives[axis]);
  }
}
