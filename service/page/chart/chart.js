/** The chart of the front: the points of the network's tours under those of the improved ones. */

import uPlot from "./uplot.js";
import { colour, onSchemeChange } from "../common/colours.js";
import { figure } from "../common/amounts.js";
import { axisOf } from "../common/axes.js";
import { counted } from "../common/numbers.js";
import { UNNAMED, withUnit } from "../common/objectives.js";
import { Budget } from "./budget.js";
import { Labels } from "./labels.js";
import { drawnNearest } from "../result/tours.js";

const FONT = "12px system-ui, sans-serif";
const REACH = 40; // pixels within which a click selects a point
const [TOP, RIGHT, ACROSS, UP, TITLE] = [28, 30, 24, 64, 18]; // pixels beside the plot: for the handles, the ticks and the titles
const BELOW = 30; // pixels over and under the points, for the names of tours
const BESIDE = 0.06; // of the range: room beside the points
const WIDER = 1; // of the front's range: how far other points may lie beyond it and be seen

export class FrontChart {
  #element;
  #chart;
  #front = [];
  #labels;
  #budget;
  #markers = {};
  #marked = {};
  #objectives = UNNAMED;
  #steps; // between the ticks of each axis, if any suit
  #said = [String, String]; // writes a tick of each axis
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
    const hooks = { draw: [() => this.#chart && this.#place()] }; // the scales are known from then on
    const told = { said: (value, axis, step) => this.#said[axis](value, step), range: (axis) => this.#ranges[axis] };
    this.#chart = new uPlot({ ...options(element, told), hooks }, [[], [], []], element);
    this.#steps = this.#chart.axes.map(({ incrs }) => incrs);
    this.#budget = new Budget(this.#chart, onBudget);
    for (const name of ["pinned", "selected", "previewed"]) {
      const marker = document.createElement("i");
      marker.className = `marker ${name}`;
      marker.hidden = true;
      this.#chart.over.append(marker);
      this.#markers[name] = marker;
    }
    this.#chart.over.addEventListener("click", (event) => this.#at(event, onSelect));
    this.#chart.over.addEventListener("pointermove", (event) => this.#at(event, onPreview, () => onPreview(null)));
    this.#chart.over.addEventListener("pointerleave", () => onPreview(null));
    new ResizeObserver(() => this.#resize()).observe(element);
    onSchemeChange(() => this.#chart.redraw(false, true));
  }

  name(objectives) {
    this.#objectives = objectives;
    this.#write();
    this.#labels.show(this.#front, objectives);
    this.#budget.name(objectives);
    this.#place();
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
    this.#front = improved.length ? improved : alone;
    this.#labels.show(this.#front, this.#objectives);
    this.#ranges = rangesOf(this.#front, alone, whole);
    this.#write();
    this.#chart.setData(uPlot.join([columns(alone), columns(improved)]));
    this.#budget.show(this.#front);
    this.#element.classList.toggle("empty", !this.#front.length);
    this.#element.setAttribute("aria-label", this.#front.length ? described(this.#front, this.#objectives, noun) : toPlan ? NONE : NO_STOPS);
    this.#place();
  }

  /** Whether all of these points are in view, where the front takes half of the chart or more. */
  sees(points) {
    return points.every((item) => this.#ranges.every((range, axis) => item.lengths[axis] <= range[1]));
  }

  /** Chooses how the axes are written. */
  #write() {
    this.#objectives.forEach((objective, axis) => {
      const { title, steps, said } = axisOf(objective);
      this.#said[axis] = said;
      Object.assign(this.#chart.axes[axis], { label: title, incrs: steps ? () => steps : this.#steps[axis] });
    });
  }

  /** Marks a point as "selected", "pinned" or "previewed"; null removes the mark. */
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
    const { offsetLeft, offsetTop } = this.#chart.over;
    const place = (lengths) => {
      const [x, y] = this.#position(lengths);
      return [x + offsetLeft, y + offsetTop];
    };
    this.#labels.place(this.#front, place, offsetLeft);
  }

  #position([first, second]) {
    return [this.#chart.valToPos(first, "x"), this.#chart.valToPos(second, "y")];
  }

  /** Reports the point within reach of a pointer, or null. */
  #at(event, onPoint, onNone = () => {}) {
    if (!this.#front.length) return;
    const box = this.#chart.over.getBoundingClientRect();
    const place = [event.clientX - box.left, event.clientY - box.top];
    const index = drawnNearest(this.#front, place, (lengths) => this.#position(lengths));
    const [x, y] = this.#position(this.#front[index].lengths);
    if (Math.hypot(x - place[0], y - place[1]) <= REACH) onPoint(index);
    else onNone();
  }

  #resize() {
    this.#chart.setSize(size(this.#element));
    this.#chart.setData(this.#chart.data); // the names need as many pixels as before
  }
}

const [NONE, NO_STOPS] = ["Nothing planned yet. Press Plan.", "Nothing planned yet. Press Plan once there are stops."];

const size = (element) => ({ width: element.clientWidth, height: element.clientHeight });

/** The least and the greatest of both lengths of a front, and of other points that do not lie far beyond it, or of all; null of no front. */
function rangesOf(front, others, all) {
  if (!front.length) return [null, null];
  const ranges = [0, 1].map((axis) => endsOf(front, axis));
  const near = all ? others : others.filter(({ lengths }) => ranges.every(([least, most], axis) => lengths[axis] <= most + WIDER * (most - least)));
  return [0, 1].map((axis) => endsOf([...front, ...near], axis));
}

function endsOf(points, axis) {
  const lengths = points.map((item) => item.lengths[axis]);
  return [Math.min(...lengths), Math.max(...lengths)];
}

const columns = (front) => [
  front.map((item) => item.lengths[0]),
  front.map((item) => item.lengths[1]),
];

/** The chart's options; `said` returns a value of the first or second objective in words, `range` what is seen of it. */
function options(element, { said, range }) {
  return {
    ...size(element),
    legend: { show: false },
    cursor: { show: false },
    padding: [TOP, RIGHT, 0, 0],
    scales: { x: { time: false, range: () => roomy(range(0), BESIDE) }, y: { range: (chart) => roomy(range(1), roomUp(chart)) } },
    axes: [axis(0, ACROSS, apart(said), said), axis(1, (_chart, ticks) => widthOf(ticks), 40, said)],
    series: [{}, dots("alone", 4), { ...dots("improved", 5), ...STAIRCASE }],
  };
}

/** Pixels from one label of the first axis to the next, so that long ones do not touch. */
const apart = (said) => (_chart, axis, least, most) => 7 * Math.max(4, said(most, axis, (most - least) / 5).length) + 16;

/** Pixels for the labels of the second axis. */
const widthOf = (ticks) => Math.max(UP, 7 * Math.max(...(ticks ?? []).map(({ length }) => length)) + 12);

/** A staircase from each point to the next, around the area that the front dominates. */
const STAIRCASE = { width: 1.5, paths: uPlot.paths.stepped({ align: 1 }) };

/** Points without a line: one through those of the first try would seem to lead to the names of others. */
function dots(name, size) {
  const stroke = () => colour(name);
  return { stroke, paths: () => null, points: { show: true, size, fill: stroke, width: 0 } };
}

function axis(at, room, space, said) {
  return {
    label: withUnit(UNNAMED[at]),
    size: room,
    space,
    labelSize: TITLE,
    font: FONT,
    labelFont: FONT,
    stroke: () => colour("quiet"),
    grid: { stroke: () => colour("line"), width: 1 },
    ticks: { show: false },
    values: (_chart, ticks, _axis, _space, step) => ticks.map((tick) => said(tick, at, step)),
  };
}

/** The share of the second lengths' range that is as high as a name. */
function roomUp({ height }) {
  const plot = height - TOP - ACROSS - TITLE;
  return BELOW / Math.max(plot - 2 * BELOW, BELOW);
}

/** A range with a share of it on either side; without a range, from 0 to 1. */
function roomy(range, share) {
  if (!range) return [0, 1];
  const [least, most] = range;
  const room = share * (most - least || Math.abs(most) || 1);
  return [least - room, most + room];
}

function described(front, objectives, { one, many }) {
  const end = (axis, pick) => figure(pick(front[0].lengths[axis], front.at(-1).lengths[axis]), objectives[axis]);
  const ranges = objectives.map(({ name }, axis) => `${name} from ${end(axis, Math.min)} to ${end(axis, Math.max)}`);
  return `A choice of ${counted(front.length, one, many)}: ${ranges.join(", ")}`;
}
