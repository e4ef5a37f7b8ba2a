/** Budget lines across the chart: a limit on one objective, whose labelled handle is dragged or moved by keys. */

import { amount, wordsOf } from "../common/amounts.js";
import { lastOf } from "../result/tours.js";
import { UNNAMED, isCounted, isLongest, namesThings } from "../common/objectives.js";

const STEPS = [
  { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 10, PageDown: -10 },
  // The second length falls along the front.
  { ArrowRight: -1, ArrowUp: -1, ArrowLeft: 1, ArrowDown: 1, PageUp: -10, PageDown: 10 },
];

export class Budget {
  #lines;
  #plot;
  #onBudget;
  #front = [];
  #objectives = UNNAMED;
  #grasped = 0; // pixels from the pointer to the line that it drags
  #limit = null; // { axis, most }; there is at most one budget

  /**
   * @param {Plot} plot the chart on which the lines lie
   * @param {(index: number) => void} onBudget called with the best tour within a budget
   */
  constructor(plot, onBudget) {
    this.#plot = plot;
    this.#onBudget = onBudget;
    this.#lines = [0, 1].map((axis) => this.#made(axis));
    plot.over.append(...this.#lines);
  }

  name(objectives) {
    this.#objectives = objectives;
    this.#lines.forEach((line, axis) => line.setAttribute("aria-label", mostOf(objectives[axis])));
    this.place();
  }

  /** Moves to another front, whose tours go from the least first length to the least second. */
  show(front) {
    if (!front.length) this.#limit = null;
    this.#front = front;
    this.place();
  }

  /** Sets the budget of the next front, given the most of each objective, null where there is none. */
  want(limits) {
    const axis = limits.findIndex(Number.isFinite);
    if (axis >= 0) this.#limit = { axis, most: limits[axis] };
  }

  /** The best tour within the budget, null without a budget. */
  get index() {
    if (!this.#limit) return null;
    const { axis, most } = this.#limit;
    if (axis === 1) return Math.max(0, this.#front.findIndex(({ lengths }) => lengths[1] <= most));
    return Math.max(0, this.#front.findLastIndex(({ lengths }) => lengths[0] <= most));
  }

  /** The budget of each objective, null where none is set. */
  get limits() {
    return [0, 1].map((axis) => (this.#limit?.axis === axis ? this.#limit.most : null));
  }

  /** The budget in words, or how to set one. */
  get said() {
    if (this.#front.length < 2) return "";
    if (!this.#limit) return "To set a limit, drag a handle on the edge of the chart.";
    const { axis, most } = this.#limit;
    const objective = this.#objectives[axis];
    return `Budget: ${amount(most, objective)}${forWhat(objective)}.`;
  }

  /** Removes the budget if a tour beyond it was chosen. */
  release(lengths) {
    if (!this.#limit || lengths[this.#limit.axis] <= this.#limit.most) return;
    this.#limit = null;
    this.place();
  }

  /** Moves the lines to their places on the chart. */
  place() {
    this.#lines.forEach((line, axis) => {
      line.hidden = this.#front.length < 2;
      if (!line.hidden) this.#put(line, axis);
    });
  }

  #put(line, axis) {
    const limited = this.#limit?.axis === axis;
    const most = limited ? this.#limit.most : this.#ends(axis)[1];
    const objective = this.#objectives[axis];
    line.firstChild.textContent = limited ? `${objective.name} ≤ ${amount(most, objective)}` : `limit ${objective.name}`;
    line.classList.toggle("limited", limited);
    this.#move(line, axis, this.#plot.at(most, axis));
    const [least, all] = this.#ends(axis);
    for (const [name, value] of Object.entries({ valuemin: least, valuemax: all, valuenow: most })) line.setAttribute(`aria-${name}`, value);
    line.setAttribute("aria-valuetext", limited ? `at most ${amount(most, this.#objectives[axis])}` : "no limit");
  }

  /** Puts a handle in the middle of its line, or as near as the chart has room. */
  #move(line, axis, at) {
    const { clientWidth, clientHeight } = this.#plot.over;
    const [along, across] = axis ? [clientHeight, clientWidth] : [clientWidth, clientHeight];
    const half = (axis ? line.offsetHeight : line.offsetWidth) / 2;
    const middle = Math.max(half, Math.min(at, along - half));
    line.style.translate = axis ? `0 ${middle - half}px` : `${middle - half}px 0`;
    line.style.setProperty("--at", `${at - middle + half}px`);
    line.style.setProperty("--reach", `${across}px`);
  }

  #made(axis) {
    const line = Object.assign(document.createElement("div"), { className: `budget ${axis ? "second" : "first"}`, tabIndex: 0, title: "Drag it to set a limit" });
    line.append(document.createElement("span"));
    line.setAttribute("role", "slider");
    line.setAttribute("aria-orientation", axis ? "vertical" : "horizontal");
    line.addEventListener("pointerdown", (event) => this.#grasp(line, axis, event));
    line.addEventListener("pointermove", (event) => line.hasPointerCapture(event.pointerId) && this.#drag(axis, event));
    line.addEventListener("click", (event) => event.stopPropagation());
    line.addEventListener("keydown", (event) => this.#step(axis, event));
    return line;
  }

  #grasp(line, axis, event) {
    line.setPointerCapture(event.pointerId);
    this.#grasped = this.#plot.at(Number(line.getAttribute("aria-valuenow")), axis) - this.#placeOf(axis, event);
  }

  /** Moves a line as far as the pointer moved since it grasped the handle. */
  #drag(axis, event) {
    this.#set(axis, this.#plot.valueAt(this.#placeOf(axis, event) + this.#grasped, axis));
  }

  #placeOf(axis, { clientX, clientY }) {
    const box = this.#plot.over.getBoundingClientRect();
    return axis ? clientY - box.top : clientX - box.left;
  }

  /** From tour to tour; Home is the tightest budget, End and Escape none. */
  #step(axis, event) {
    const [least, most] = this.#ends(axis);
    const jumps = { Home: least, End: most, Escape: most };
    const steps = STEPS[axis][event.key];
    if (steps === undefined && !(event.key in jumps)) return;
    event.preventDefault();
    if (steps === undefined) return this.#set(axis, jumps[event.key]);
    const from = this.#limit?.axis === axis ? this.index : axis ? 0 : this.#front.length - 1;
    const to = Math.min(Math.max(from + steps, 0), this.#front.length - 1);
    this.#set(axis, this.#front[to].lengths[axis]);
  }

  #set(axis, wanted) {
    const [least, most] = this.#ends(axis);
    const whole = isCounted(this.#objectives[axis]) ? Math.floor(wanted) : wanted;
    this.#limit = wanted >= most ? null : { axis, most: Math.max(whole, least) };
    this.place();
    this.#onBudget(this.index ?? (axis ? 0 : this.#front.length - 1));
  }

  #ends(axis) {
    const ends = [this.#front[0], this.#front[axis ? lastOf(this.#front) : this.#front.length - 1]].map(({ lengths }) => lengths[axis]);
    return [Math.min(...ends), Math.max(...ends)];
  }
}

/** What a handle limits, such as "At most this much time". */
const mostOf = (objective) =>
  isLongest(objective) ? `${objective.name}, at most this long` : `At most this ${wordsOf(objective).much} ${objective.name}`;

/** What a budget is for, where its amount does not say it. */
function forWhat(objective) {
  if (isCounted(objective) || namesThings(objective)) return "";
  return isLongest(objective) ? ` for the ${objective.name}` : ` of ${objective.name}`;
}
