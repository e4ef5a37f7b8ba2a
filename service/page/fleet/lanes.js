/** A lane for each vehicle of a plan over one axis of time, as SVG. */

import { LANE, laneElements } from "./lane.js";
import { svgElement } from "./svg.js";

const [TOP, SIDE] = [20, 8]; // pixels of room for the axis, and beside the lanes
const APART = 64; // pixels from one mark of the axis to the next, at least

export class Lanes {
  #element;
  #lanes = [];
  #clock = null;

  constructor(element) {
    this.#element = element;
    new ResizeObserver(() => this.#draw()).observe(element);
  }

  /** Shows lanes, each `{ name, visits }`, by a clock; no lanes without a clock. */
  show(lanes, clock) {
    this.#lanes = clock ? lanes : [];
    this.#clock = clock;
    this.#element.hidden = !clock;
    this.#draw();
  }

  #draw() {
    const width = this.#element.clientWidth;
    if (!this.#lanes.length || !width) return this.#element.replaceChildren();
    const axis = axisOf(this.#clock, width);
    const height = TOP + LANE * this.#lanes.length;
    const size = { viewBox: `0 0 ${width} ${height}`, width, height };
    const svg = svgElement("svg", { ...size, role: "img", "aria-label": described(axis) });
    const lanes = this.#lanes.flatMap((lane, at) => laneElements(lane, at, axis));
    svg.append(...axis.marks.flatMap((time) => mark(time, axis, width, height)), ...lanes);
    this.#element.replaceChildren(svg);
  }
}

function axisOf(clock, width) {
  const { from, to, said } = clock;
  const place = (time) => SIDE + ((time - from) / (to - from || 1)) * (width - 2 * SIDE);
  return { from, to, said, place, left: SIDE, top: TOP, marks: clock.marks(Math.max(1, Math.floor(width / APART))) };
}

const described = ({ from, to, said }) =>
  `A lane for each vehicle, from ${said(from)} to ${said(to)}. The stops of each vehicle are listed below with their times.`;

/** A line through all lanes, under the time. */
function mark(time, { place, said }, width, height) {
  const x = place(time);
  const anchor = x < APART / 2 ? "start" : x > width - APART / 2 ? "end" : "middle";
  const text = svgElement("text", { x, y: 11, class: "mark", "text-anchor": anchor }, said(time));
  return [svgElement("path", { d: `M${x} ${TOP - 4}V${height}`, class: "grid" }), text];
}
