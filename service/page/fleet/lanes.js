/** A lane for each vehicle of a plan over one axis of time, as SVG, in which a stop can be chosen. */

import { LANE, laneElements, stripes, windowElements } from "./lane.js";
import { svgElement } from "../common/elements.js";

const [TOP, SIDE] = [20, 8]; // pixels of room for the axis, and beside the lanes
const [APART, OF_DAYS] = [64, 92]; // pixels from one mark of the axis to the next, at least; where days are said
const REACH = 12; // pixels beside a stop within which a click chooses it
const STEPS = { ArrowRight: [0, 1], ArrowLeft: [0, -1], ArrowDown: [1, 0], ArrowUp: [-1, 0] };

export class Lanes {
  #element;
  #onChoose;
  #lanes = [];
  #clock = null;
  #axis = null;
  #chosen = null; // { lane, at }: the place of the stop that is chosen
  #current = { lane: 0, at: 0 }; // the place of the stop that takes the focus

  /** @param {(lane: number, at: number) => void} onChoose called with the place of the stop to choose */
  constructor(element, onChoose) {
    this.#element = element;
    this.#onChoose = onChoose;
    element.addEventListener("click", (event) => this.#click(event));
    element.addEventListener("keydown", (event) => this.#key(event));
    new ResizeObserver(() => this.#draw()).observe(element);
  }

  /** Shows lanes, each `{ name, visits }`, by a clock; no lanes without a clock. */
  show(lanes, clock) {
    this.#lanes = clock ? lanes : [];
    this.#clock = clock;
    this.#chosen = null;
    this.#current = { lane: 0, at: 0 };
    this.#element.hidden = !clock;
    this.#draw();
  }

  /** Marks the stop at this place, `{ lane, at }`, and its windows; null removes the mark. */
  choose(place) {
    this.#chosen = place;
    if (place) this.#current = place;
    this.#mark();
  }

  #draw() {
    const width = this.#element.clientWidth;
    if (!this.#lanes.length || !width) return this.#element.replaceChildren();
    const focused = this.#element.contains(document.activeElement);
    this.#axis = axisOf(this.#clock, width);
    const height = TOP + LANE * this.#lanes.length;
    const size = { viewBox: `0 0 ${width} ${height}`, width, height };
    const svg = svgElement("svg", { ...size, role: "group", "aria-label": described(this.#axis) });
    const lanes = this.#lanes.flatMap((lane, at) => laneElements(lane, at, this.#axis));
    svg.append(stripes(), ...this.#axis.marks.flatMap((time) => mark(time, this.#axis, width, height)), ...lanes);
    this.#element.replaceChildren(svg);
    this.#mark();
    if (focused) this.#stopAt(this.#current)?.focus();
  }

  #mark() {
    const svg = this.#element.firstElementChild;
    if (!svg) return;
    for (const each of svg.querySelectorAll(".window")) each.remove();
    for (const each of svg.querySelectorAll(".stop")) {
      each.setAttribute("aria-pressed", "false");
      each.setAttribute("tabindex", "-1");
    }
    this.#stopAt(this.#current)?.setAttribute("tabindex", "0");
    if (!this.#chosen) return;
    const { lane, at } = this.#chosen;
    this.#stopAt(this.#chosen)?.setAttribute("aria-pressed", "true");
    svg.append(...windowElements(this.#lanes[lane].visits[at], lane, this.#axis));
  }

  #stopAt({ lane, at }) {
    return this.#element.querySelector(`[data-lane="${lane}"][data-at="${at}"]`);
  }

  /** Chooses the stop that was clicked, or the nearest one of its lane that is in reach. */
  #click(event) {
    const clicked = event.target.closest(".stop")?.dataset;
    const place = clicked ? { lane: Number(clicked.lane), at: Number(clicked.at) } : this.#near(event);
    if (!place) return;
    this.#onChoose(place.lane, place.at);
    this.#stopAt(place).focus();
  }

  #near(event) {
    const box = this.#element.getBoundingClientRect();
    const lane = Math.floor((event.clientY - box.top - TOP) / LANE);
    const { visits } = this.#lanes[lane] ?? { visits: [] };
    const x = event.clientX - box.left;
    const away = visits.map(({ arrival, end }) => Math.max(this.#axis.place(arrival) - x, x - this.#axis.place(end), 0));
    const at = away.indexOf(Math.min(...away));
    return at >= 0 && away[at] <= REACH ? { lane, at } : null;
  }

  /** Arrow keys go along a lane and from lane to lane, Home and End to its ends; Enter and the space bar choose a stop. */
  #key(event) {
    const { lane, at } = this.#current;
    const visits = this.#lanes[lane]?.visits ?? [];
    if (event.key === "Enter" || event.key === " ") this.#onChoose(lane, at);
    else if (event.key === "Home") this.#focus(lane, 0);
    else if (event.key === "End") this.#focus(lane, visits.length - 1);
    else if (event.key in STEPS) this.#step(STEPS[event.key]);
    else return;
    event.preventDefault();
  }

  #step([down, right]) {
    const { lane, at } = this.#current;
    const other = Math.min(Math.max(lane + down, 0), this.#lanes.length - 1);
    this.#focus(other, Math.min(Math.max(at + right, 0), this.#lanes[other].visits.length - 1));
  }

  #focus(lane, at) {
    this.#current = { lane, at };
    this.#mark();
    this.#stopAt(this.#current).focus();
  }
}

function axisOf(clock, width) {
  const { from, to, said, lasting } = clock;
  const place = (time) => SIDE + ((time - from) / (to - from || 1)) * (width - 2 * SIDE);
  const apart = Math.max(said(from).length, said(to).length) > 7 ? OF_DAYS : APART;
  return { from, to, said, lasting, place: (time) => place(Math.min(Math.max(time, from), to)), apart, left: SIDE, top: TOP, marks: clock.marks(Math.max(1, Math.floor(width / apart))) };
}

const described = ({ from, to, said }) =>
  `A lane for each vehicle, from ${said(from)} to ${said(to)}. Arrow keys go from stop to stop, Enter says when it is visited.`;

/** A line through all lanes, under the time. */
function mark(time, { place, said, apart }, width, height) {
  const x = place(time);
  const anchor = x < apart / 2 ? "start" : x > width - apart / 2 ? "end" : "middle";
  const text = svgElement("text", { x, y: 11, class: "mark", "text-anchor": anchor }, said(time));
  return [svgElement("path", { d: `M${x} ${TOP - 4}V${height}`, class: "grid" }), text];
}
