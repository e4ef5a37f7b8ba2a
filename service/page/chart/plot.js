/** Draw values of two quantities as SVG: the grid with its ticks and titles, dots, and lines through them. */

import { ticksOf } from "../common/axes.js";
import { made, svgElement } from "../common/elements.js";

const TITLE = 18; // pixels for the title of an axis
const LETTER = 7; // pixels of a letter of a tick, at most
const [BETWEEN, HIGH] = [16, 40]; // pixels between the ticks of the first axis, and from one to the next of the second
const SHORTEST = 4; // letters of a tick, at least

export class Plot {
  /** The part within the axes, for what lies on it. */
  over = made("div", { className: "within" });
  #svg = svgElement("svg", { "aria-hidden": true });
  #element;
  #margins;
  #onDrawn;
  #axes = [];
  #series = [];
  #sides = [1, 1]; // of the part within the axes, in pixels
  #ranges = [[0, 1], [0, 1]];

  /**
   * @param {{ top: number, right: number, bottom: number, left: number }} margins pixels beside the plot, without titles
   * @param {() => void} onDrawn called when all has its place
   */
  constructor(element, margins, onDrawn = () => {}) {
    this.#element = element;
    this.#margins = margins;
    this.#onDrawn = onDrawn;
    element.append(this.#svg, this.over);
    new ResizeObserver(() => this.#draw()).observe(element);
  }

  /**
   * Draws values.
   *
   * @param {object[]} axes both, each `{ range, title, steps, said }`: `range` returns the least and the greatest value, given the pixels that there
   *   are; the others are as of `axisOf`, and there may be no title
   * @param {object[]} series each `{ name, points, line }`: its class, pairs of values, and the path from one point to the next as `line` writes it,
   *   if there is one
   */
  show(axes, series) {
    this.#axes = axes;
    this.#series = series;
    this.#draw();
  }

  /** Pixels from the left of the plot to a value, or from its top to one of the second axis. */
  at(value, axis) {
    const [least, most] = this.#ranges[axis];
    const share = (value - least) / (most - least);
    return this.#sides[axis] * (axis ? 1 - share : share);
  }

  /** The value at so many pixels: the reverse of `at`. */
  valueAt(pixels, axis) {
    const [least, most] = this.#ranges[axis];
    const share = pixels / this.#sides[axis];
    return least + (axis ? 1 - share : share) * (most - least);
  }

  #draw() {
    const { clientWidth, clientHeight } = this.#element;
    if (!clientWidth || !this.#axes.length) return;
    const { top, right } = this.#margins;
    const [below, beside] = this.#axes.map(({ title }) => (title ? TITLE : 0));
    const bottom = clientHeight - this.#margins.bottom - below;
    const up = this.#ticks(1, bottom - top, () => HIGH);
    const left = beside + Math.max(this.#margins.left, widthOf(up) + 12);
    const across = this.#ticks(0, clientWidth - right - left, (wide) => wide + BETWEEN);
    Object.assign(this.over.style, { left: `${left}px`, top: `${top}px`, width: `${this.#sides[0]}px`, height: `${this.#sides[1]}px` });
    const grid = [...across.map(({ at }) => `M${left + at} ${top}V${bottom}`), ...up.map(({ at }) => `M${left} ${top + at}h${this.#sides[0]}`)];
    const text = (said, x, y, anchor, more) => svgElement("text", { x, y, "text-anchor": anchor, ...more }, said);
    this.#svg.replaceChildren(
      svgElement("path", { class: "grid", d: grid.join("") }),
      ...across.map(({ at, said }) => text(said, left + at, bottom + 16, "middle")),
      ...up.map(({ at, said }) => text(said, left - 8, top + at + 4, "end")),
      ...this.#titles(left, bottom, clientHeight, text),
      ...this.#series.flatMap((each) => this.#drawn(each, left, top)),
    );
    this.#onDrawn();
  }

  #titles(left, bottom, height, text) {
    const [wide, high] = this.#sides;
    const [x, y] = [12, bottom - high / 2];
    const placed = [
      [left + wide / 2, height - 5, "middle"],
      [x, y, "middle", { transform: `rotate(-90 ${x} ${y})` }],
    ];
    return this.#axes.flatMap(({ title }, axis) => (title ? [text(title, ...placed[axis])] : []));
  }

  /** Takes the pixels of an axis; returns its ticks, each where it is and as it is `said`. `room` returns the pixels of one, given those of its text. */
  #ticks(axis, pixels, room) {
    const { range, steps, said } = this.#axes[axis];
    const [least, greatest] = range(pixels);
    const most = greatest > least ? greatest : least + 1;
    this.#ranges[axis] = [least, most];
    this.#sides[axis] = pixels;
    const wide = widthOf([{ said: said(most, (most - least) / 5) }]);
    const { values, step } = ticksOf({ steps }, least, most, Math.max(1, pixels / room(wide)));
    return values.map((value) => ({ at: this.at(value, axis), said: said(value, step) }));
  }

  /** The line and the dots of those points that are in view. */
  #drawn({ name, points, line }, left, top) {
    const isSeen = (point) => point.every((value, axis) => value >= this.#ranges[axis][0] && value <= this.#ranges[axis][1]);
    const places = points.filter(isSeen).map(([x, y]) => [left + this.at(x, 0), top + this.at(y, 1)]);
    const lines = line ? [svgElement("path", { class: `line ${name}`, d: places.map((at, index) => (index ? line(at) : `M${at}`)).join("") })] : [];
    return [...lines, svgElement("path", { class: `dots ${name}`, d: places.map((at) => `M${at}h0`).join("") })];
  }
}

const widthOf = (ticks) => LETTER * Math.max(SHORTEST, ...ticks.map(({ said }) => said.length));
