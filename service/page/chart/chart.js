/** The chart of the front: the points of the network's tours under those of the improved ones. */

import { figure } from "../common/amounts.js";
import { axisOf } from "../common/axes.js";
import { counted } from "../common/numbers.js";
import { UNNAMED } from "../common/objectives.js";
import { Budget } from "./budget.js";
import { Labels } from "./labels.js";
import { Plot } from "./plot.js";
import { drawnNearest, isBeaten, lastOf } from "../result/tours.js";

const REACH = 40; // pixels within which a click selects a point
const MARGINS = { top: 28, right: 30, bottom: 24, left: 64 }; // pixels beside the plot: for the handles and the ticks
const BELOW = 30; // pixels over and under the points, for the names of tours
const BESIDE = 0.06; // of the range: room beside the points
const WIDER = 1; // of the front's range: how far other points may lie beyond it and be seen

export class FrontChart {
  #element;
  #plot;
  #alone = [];
  #improved = [];
  #labels;
  #budget;
  #markers = {};
  #marked = {};
  #objectives = UNNAMED;
  #ranges = [null, null]; // the least and the greatest length that is seen

  /**
   * @param {HTMLElement} names holds the names of both ends and the knee, over the chart
   * @param {(index: number) => void} onSelect called with the point that was clicked
   * @param {(index: number | null) => void} onPreview called with the point under the pointer
   * @param {(index: number) => void} onBudget called with the best tour within a budget
   */
  constructor(element, names, { onSelect, onPreview, onBudget }) {
    this.#element = element;
    this.#labels = new Labels(names, onSelect, onPreview);
    this.#plot = new Plot(element, MARGINS, () => this.#place());
    const { over } = this.#plot;
    this.#budget = new Budget(this.#plot, onBudget);
    for (const name of ["driven", "pinned", "selected", "previewed"]) {
      const marker = document.createElement("i");
      marker.className = `marker ${name}`;
      marker.hidden = true;
      over.append(marker);
      this.#markers[name] = marker;
    }
    over.addEventListener("click", (event) => this.#at(event, onSelect));
    over.addEventListener("pointermove", (event) => this.#at(event, onPreview, () => onPreview(null)));
    over.addEventListener("pointerleave", () => onPreview(null));
  }

  name(objectives) {
    this.#objectives = objectives;
    this.#labels.show(this.#front, objectives);
    this.#budget.name(objectives);
    this.#draw();
  }

  /** The best tour within the budget line, null if there is none; the same in words; and the limit of each objective. */
  get budget() {
    return { index: this.#budget.index, said: this.#budget.said, limits: this.#budget.limits };
  }

  /** Sets the limits of the next front. */
  want(limits) {
    this.#budget.want(limits);
  }

  /**
   * Shows the network's front and the improved one, of what `noun` says, and lets the points of the latter be clicked; or that there is none, maybe
   * as there is nothing `toPlan`. `whole` says that all points are seen.
   */
  show(alone, improved, noun, toPlan = true, whole = false) {
    [this.#alone, this.#improved] = [alone, improved];
    this.#labels.show(this.#front, this.#objectives);
    this.#ranges = rangesOf(this.#front, alone, whole, this.#marked.driven);
    this.#budget.show(this.#front);
    this.#element.classList.toggle("empty", !this.#front.length);
    this.#element.setAttribute("aria-label", this.#front.length ? described(this.#front, this.#objectives, noun) : toPlan ? NONE : NO_STOPS);
    this.#draw();
  }

  /** Whether all of these points are in view, where the front takes half of the chart or more. */
  sees(points) {
    return points.every((item) => this.#ranges.every((range, axis) => item.lengths[axis] <= range[1]));
  }

  get #front() {
    return this.#improved.length ? this.#improved : this.#alone;
  }

  #draw() {
    const rooms = [() => BESIDE, roomUp];
    const axes = this.#objectives.map((objective, axis) => ({ ...axisOf(objective), range: (pixels) => roomy(this.#ranges[axis], rooms[axis](pixels)) }));
    const points = (front) => front.map(({ lengths }) => lengths);
    const [beside, online] = [true, false].map((each) => this.#improved.filter((item) => isBeaten(this.#improved, item) === each));
    // No line through the quick first result: it would seem to lead to the names of others.
    this.#plot.show(axes, [{ name: "alone", points: points(this.#alone) }, { name: "improved", points: points(online), line: stair }, { name: "improved", points: points(beside) }]);
  }

  /** Marks a point as "selected", "pinned" or "previewed", or before the next front that of the plan that is "driven"; null removes the mark. */
  mark(name, lengths) {
    this.#marked[name] = lengths;
    if (name === "selected" && lengths) this.#budget.release(lengths);
    this.#placeMarker(name);
  }

  #placeMarker(name) {
    const [marker, lengths] = [this.#markers[name], this.#marked[name]];
    marker.hidden = !lengths;
    if (!lengths) return;
    const [x, y] = this.#position(lengths);
    marker.style.transform = `translate(${x}px, ${y}px)`;
  }

  /** Placing by sizes waits for the layout, so it is not done at each step of the slider. */
  #place() {
    this.#budget?.place();
    for (const name of Object.keys(this.#markers)) this.#placeMarker(name);
    const { offsetLeft, offsetTop } = this.#plot.over;
    const place = (lengths) => {
      const [x, y] = this.#position(lengths);
      return [x + offsetLeft, y + offsetTop];
    };
    this.#labels.place(this.#front, place, offsetLeft);
  }

  #position([first, second]) {
    return [this.#plot.at(first, 0), this.#plot.at(second, 1)];
  }

  /** Reports the point within reach of a pointer, or null. */
  #at(event, onPoint, onNone = () => {}) {
    if (!this.#front.length) return;
    const box = this.#plot.over.getBoundingClientRect();
    const place = [event.clientX - box.left, event.clientY - box.top];
    const index = drawnNearest(this.#front, place, (lengths) => this.#position(lengths));
    const [x, y] = this.#position(this.#front[index].lengths);
    if (Math.hypot(x - place[0], y - place[1]) <= REACH) onPoint(index);
    else onNone();
  }
}

const [NONE, NO_STOPS] = ["Nothing planned yet. Press Plan.", "Nothing planned yet. Press Plan once there are stops."];

/** The least and the greatest of both lengths of a front, of the plan that is driven, if there is one, and of other points that do not lie far beyond the front, or of all; null of no front. */
function rangesOf(front, others, all, driven) {
  if (!front.length) return [null, null];
  const ranges = [0, 1].map((axis) => endsOf(front, axis));
  const near = all ? others : others.filter(({ lengths }) => ranges.every(([least, most], axis) => lengths[axis] <= most + WIDER * (most - least)));
  return [0, 1].map((axis) => endsOf([...front, ...near, ...(driven ? [{ lengths: driven }] : [])], axis));
}

function endsOf(points, axis) {
  const lengths = points.map((item) => item.lengths[axis]);
  return [Math.min(...lengths), Math.max(...lengths)];
}

/** A stair from a point to the next one, around the area that the front dominates. */
const stair = ([x, y]) => `H${x}V${y}`;

/** The share of the second lengths' range that is as high as a name. */
const roomUp = (pixels) => BELOW / Math.max(pixels - 2 * BELOW, BELOW);

/** A range with a share of it on either side; without a range, from 0 to 1. */
function roomy(range, share) {
  if (!range) return [0, 1];
  const [least, most] = range;
  const room = share * (most - least || Math.abs(most) || 1);
  return [least - room, most + room];
}

function described(front, objectives, { one, many }) {
  const end = (axis, pick) => figure(pick(...[front[0], front.at(-1), front[lastOf(front)]].map(({ lengths }) => lengths[axis])), objectives[axis]);
  const ranges = objectives.map(({ name }, axis) => `${name} from ${end(axis, Math.min)} to ${end(axis, Math.max)}`);
  return `A choice of ${counted(front.length, one, many)}: ${ranges.join(", ")}`;
}
