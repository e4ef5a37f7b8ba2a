/** The chart of the front: the points of the network's tours under those of the improved ones. */

import uPlot from "./uplot.js";
import { colour, onSchemeChange } from "../common/colours.js";
import { axisOf, figure } from "../common/amounts.js";
import { counted } from "../common/numbers.js";
import { UNNAMED, withUnit } from "../common/objectives.js";
import { Budget } from "./budget.js";
import { Labels } from "./labels.js";
import { drawnNearest } from "../result/tours.js";

const FONT = "12px system-ui, sans-serif";
const REACH = 40; // pixels within which a click selects a point

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
    this.#chart = new uPlot({ ...options(element, (value, axis) => this.#said[axis](value)), hooks }, [[], [], []], element);
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
    this.#write(this.#front);
    this.#labels.show(this.#front, objectives);
    this.#budget.name(objectives);
    this.#place();
  }

  /** The best tour within the budget line, null if there is none; and the same in words. */
  get budget() {
    return { index: this.#budget.index, said: this.#budget.said };
  }

  /** Shows the network's front and the improved one, of what `noun` says, and lets the points of the latter be clicked. */
  show(alone, improved, noun) {
    this.#front = improved.length ? improved : alone;
    this.#labels.show(this.#front, this.#objectives);
    this.#write([...alone, ...improved]);
    this.#chart.setData(uPlot.join([columns(alone), columns(improved)]));
    this.#budget.show(this.#front);
    this.#element.classList.toggle("empty", !this.#front.length);
    this.#element.setAttribute("aria-label", described(this.#front, this.#objectives, noun));
    this.#place();
  }

  /** Chooses how the axes of a chart of these points are written. */
  #write(points) {
    this.#objectives.forEach((objective, axis) => {
      const { title, steps, said } = axisOf(objective, rangeOf(points, axis));
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
    this.#labels.place(this.#front, (lengths) => {
      const [x, y] = this.#position(lengths);
      return [x + offsetLeft, y + offsetTop];
    });
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
  }
}

const NONE = "No front yet: bring stops, then press Plan";

const size = (element) => ({ width: element.clientWidth, height: element.clientHeight });

function rangeOf(points, axis) {
  const lengths = points.map((item) => item.lengths[axis]);
  return points.length ? Math.max(...lengths) - Math.min(...lengths) : 0;
}

const columns = (front) => [
  front.map((item) => item.lengths[0]),
  front.map((item) => item.lengths[1]),
];

/** The chart's options; `said` returns a value of the first or second objective in words. */
function options(element, said) {
  return {
    ...size(element),
    legend: { show: false },
    cursor: { show: false },
    padding: [24, 28, 0, 0],
    scales: { x: { time: false, range: roomy }, y: { range: roomy } },
    axes: [axis(0, 28, apart(said), said), axis(1, 64, 40, said)],
    series: [{}, line("alone", 1, 4), line("improved", 1.5, 5)],
  };
}

/** Pixels from one label of the first axis to the next, so that long ones do not touch. */
const apart = (said) => (_chart, axis, _least, most) => 7 * Math.max(4, said(Math.trunc(most), axis).length) + 16;

/** A staircase from each point to the next, around the area that the front dominates. */
function line(name, width, points) {
  const stroke = () => colour(name);
  return {
    stroke,
    width,
    paths: uPlot.paths.stepped({ align: 1 }),
    points: { show: true, size: points, fill: stroke, width: 0 },
  };
}

function axis(at, room, space, said) {
  return {
    label: withUnit(UNNAMED[at]),
    size: room,
    space,
    labelSize: 18,
    font: FONT,
    labelFont: FONT,
    stroke: () => colour("quiet"),
    grid: { stroke: () => colour("line"), width: 1 },
    ticks: { show: false },
    values: (_, ticks) => ticks.map((tick) => said(tick, at)),
  };
}

function roomy(_, least, most) {
  if (least == null) return [0, 1];
  const room = 0.06 * (most - least || Math.abs(most) || 1);
  return [least - room, most + room];
}

function described(front, objectives, { one, many }) {
  if (!front.length) return NONE;
  const end = (axis, pick) => figure(pick(front[0].lengths[axis], front.at(-1).lengths[axis]), objectives[axis]);
  const ranges = objectives.map(({ name }, axis) => `${name} from ${end(axis, Math.min)} to ${end(axis, Math.max)}`);
  return `A front of ${counted(front.length, one, many)}: ${ranges.join(", ")}`;
}
