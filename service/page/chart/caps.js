/** Limits on three or more objectives: a slider each, whose track shows what is left within the other limits. */

import { amount, compared, figure, leastOf, wordsOf } from "../common/amounts.js";
import { made } from "../common/elements.js";
import { capital, isTime, titled } from "../common/objectives.js";
import { markAt, ticks } from "./ticks.js";

const STEPS = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 10, PageDown: -10 };
const orNull = (limits) => limits.map((most) => (Number.isFinite(most) ? most : null));

export class Caps {
  #element;
  #onLimits;
  #rows = []; // of each objective: its slider with marks and what both of its ends mean, and what is said beside it
  #front = [];
  #objectives = [];
  #wanted = []; // the limit of each objective, Infinity where there is none
  #limits = []; // the same, without those that no tour of the front is within
  #onLeast;

  /**
   * @param {() => void} onLimits called when a limit has changed
   * @param {(index: number) => void} onLeast called with the tour within the limits that has the least of an objective
   */
  constructor(element, onLimits, onLeast) {
    this.#element = element;
    this.#onLimits = onLimits;
    this.#onLeast = onLeast;
  }

  /** Shows a front; limits stay where one of as many objectives was shown before, even if drafts between are beyond them. */
  show(front, objectives) {
    const same = this.#wanted.length === objectives.length;
    this.#front = front;
    this.#wanted = same ? this.#wanted : objectives.map(() => Infinity);
    this.#limits = [...this.#wanted];
    if (!same || objectives.some(({ name }, at) => name !== this.#objectives[at]?.name)) this.#make(objectives);
    this.#objectives = objectives;
    this.#loosen();
    this.#draw();
  }

  /** The limit of each objective, null where there is none. */
  get limits() {
    return orNull(this.#wanted);
  }

  /** The limits that are shown: those that some tour of the front is within. */
  get shown() {
    return orNull(this.#limits);
  }

  /** Sets the limits of the next front, from a link: they are dropped unless there is one, or null, for each objective. */
  want(limits) {
    const known = Array.isArray(limits) && limits.every((most) => most === null || Number.isFinite(most));
    this.#wanted = known ? limits.map((most) => most ?? Infinity) : [];
  }

  /** Removes all limits. */
  forget() {
    [this.#wanted, this.#limits] = [[], []];
    this.#front = [];
  }

  /** Whether each tour of the front is within all limits. */
  get within() {
    return this.#front.map((tour) => this.allows(tour));
  }

  /** The tour within all limits that has the least sum of losses. */
  get middle() {
    const sums = this.#front.map((tour) => (this.allows(tour) ? tour.losses.reduce((sum, loss) => sum + loss, 0) : Infinity));
    return sums.indexOf(Math.min(...sums));
  }

  /** The limits in words, or how to set one. */
  get said() {
    const left = this.within.filter(Boolean).length;
    const lifted = this.#lifted.map((axis) => `${this.#objectives[axis].name} at most ${this.#amount(axis, this.#wanted[axis])}`);
    const begun = lifted.length ? `Lifted, as nothing is within all limits: ${lifted.join(", ")}. ` : "";
    if (left < this.#front.length) return `${begun}${left} of ${this.#front.length} are within the limits.`;
    return begun || "No limits. Move a slider to say what an objective may be at most.";
  }

  /** The objectives whose limits no tour of the front is within. */
  get #lifted() {
    return this.#limits.flatMap((most, axis) => (this.#wanted[axis] < most ? [axis] : []));
  }

  /** Removes the limits that a chosen tour is beyond. */
  release(tour) {
    if (this.allows(tour)) return;
    this.#limits = this.#limits.map((most, axis) => (tour.lengths[axis] <= most ? most : Infinity));
    this.#wanted = [...this.#limits];
    this.#draw();
  }

  /** Whether a tour is within all limits, but that of one objective. */
  allows({ lengths }, but = -1) {
    return lengths.every((value, axis) => axis === but || value <= this.#limits[axis]);
  }

  /** The lengths under one objective of the tours within the limits of all others, ascending. */
  #left(axis) {
    const found = this.#front.filter((tour) => this.allows(tour, axis)).map(({ lengths }) => lengths[axis]);
    return found.sort((a, b) => a - b);
  }

  /** Removes limits in another front until it has a tour within them. */
  #loosen() {
    while (this.#front.length && !this.#front.some((tour) => this.allows(tour))) {
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
      const least = Object.assign(document.createElement("button"), { type: "button", textContent: wordsOf(objective).least });
      least.setAttribute("aria-label", `${capital(leastOf(objective))} within the limits`);
      least.addEventListener("click", () => this.#onLeast(this.#front.findIndex((tour) => this.allows(tour) && tour.lengths[axis] === this.#left(axis)[0])));
      const [marks, ends] = [ticks(), made("small", { ariaHidden: "true" }, made("span"), made("span"))];
      return { slider, said, least, marks, ends };
    });
    const parts = this.#rows.flatMap(({ slider, said, least, marks, ends }, axis) => {
      const label = Object.assign(document.createElement("label"), { htmlFor: slider.id, textContent: titled(objectives[axis]) });
      return [label, said, least, made("div", { className: "track" }, slider, marks, ends)];
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
    this.#wanted = [...this.#limits];
    this.#draw();
    this.#onLimits();
  }

  #ends(axis) {
    const all = this.#front.map(({ lengths }) => lengths[axis]);
    return [Math.min(...all), Math.max(...all)];
  }

  #draw() {
    this.#rows.forEach(({ slider, said, least: button, marks, ends }, axis) => {
      slider.disabled = button.disabled = this.#front.length < 2;
      if (!this.#front.length) return;
      const [least, most] = this.#ends(axis);
      const left = this.#left(axis);
      const limit = Math.min(this.#limits[axis], most);
      Object.assign(slider, { min: least, max: most });
      slider.value = limit;
      const share = (value) => (value - least) / (most - least || 1);
      slider.style.setProperty("--from", `${100 * share(left[0])}%`);
      slider.style.setProperty("--to", `${100 * share(left.at(-1))}%`);
      markAt(marks, this.#front.map(({ lengths }) => share(lengths[axis])));
      [least, most].forEach((value, end) => (ends.children[end].textContent = compared(value, this.#objectives[axis])));
      const atMost = Number.isFinite(this.#limits[axis]) ? `at most ${this.#amount(axis, limit)}` : "no limit";
      said.textContent = atMost;
      const range = `${this.#amount(axis, left[0])} to ${this.#amount(axis, left.at(-1))} within the other limits`;
      slider.setAttribute("aria-valuetext", `${atMost}; ${range}`);
    });
  }

  #amount(axis, value) {
    const objective = this.#objectives[axis];
    return isTime(objective) ? figure(value, objective) : amount(value, objective);
  }
}
