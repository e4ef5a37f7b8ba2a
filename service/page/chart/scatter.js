/** The plane of two of three or more objectives: a dot for each tour, coloured by another objective. */

import { amount, compared, figure } from "../common/amounts.js";
import { svgElement } from "../common/elements.js";
import { titled, withUnit } from "../common/objectives.js";

const MARGIN = { left: 76, right: 16, top: 28, bottom: 40 };
const REACH = 40; // pixels within which a click selects a dot
const SHADES = 5; // of the colour, from the least to the greatest
const CHOICES = [["across", "Across"], ["up", "Up"], ["shade", "Colour"]];

export class Scatter {
  #element;
  #svg = svgElement("svg", { "aria-hidden": true });
  #choices;
  #key = Object.assign(document.createElement("p"), { className: "shades" }); // what the colours mean
  #front = [];
  #within = [];
  #objectives = [];
  #ends = []; // the least and the greatest length under each objective
  #axes = [0, 1, 2]; // the objectives across, up, and of the colour
  #marks = {};

  /**
   * @param {HTMLElement} choices holds the lists from which the objectives are chosen
   * @param {(index: number) => void} onSelect called with the tour that was clicked
   * @param {(index: number | null) => void} onPreview called with the tour under the pointer
   */
  constructor(element, choices, { onSelect, onPreview }) {
    this.#element = element;
    this.#choices = choices;
    element.append(this.#svg);
    this.#svg.addEventListener("click", (event) => this.#at(event, onSelect));
    this.#svg.addEventListener("pointermove", (event) => this.#at(event, onPreview, () => onPreview(null)));
    this.#svg.addEventListener("pointerleave", () => onPreview(null));
    new ResizeObserver(() => this.#draw()).observe(element);
  }

  /** Shows a front under its objectives; `within` says of each tour whether it is within the limits. */
  show(front, objectives, within, noun) {
    this.#front = front;
    this.#within = within;
    this.#ends = objectives.map((_, axis) => {
      const all = [...front.map(({ lengths }) => lengths), ...(this.#marks.driven ? [this.#marks.driven] : [])].map((lengths) => lengths[axis]);
      return [Math.min(...all), Math.max(...all)];
    });
    if (objectives.some((each, at) => each.name !== this.#objectives[at]?.name) || objectives.length !== this.#objectives.length) {
      this.#axes = [0, 1, 2];
      this.#objectives = objectives;
      this.#choose();
    }
    this.#objectives = objectives;
    this.#element.setAttribute("aria-label", this.#described(noun));
    this.#draw();
  }

  /** Marks a tour as "selected", "pinned" or "previewed", or before the next front the plan that is "driven"; null removes the mark. */
  mark(name, lengths) {
    this.#marks[name] = lengths;
    for (const each of this.#svg.querySelectorAll(`.${name}`)) each.remove();
    if (lengths && this.#front.length) this.#svg.append(this.#dot(lengths, `mark ${name}`, name === "selected" ? 7 : 6));
  }

  /** Lists from which the objectives across, up and of the colour are chosen; two that are equal are exchanged. */
  #choose() {
    const parts = CHOICES.map(([name, title], at) => {
      const list = Object.assign(document.createElement("select"), { id: `scatter-${name}` });
      list.append(...this.#objectives.map((objective, axis) => new Option(titled(objective), axis)));
      list.value = this.#axes[at];
      list.setAttribute("aria-label", title); // the label's own text has those of the options in it
      list.addEventListener("change", () => this.#exchange(at, Number(list.value)));
      const label = document.createElement("label");
      label.append(title, list);
      return label;
    });
    this.#choices.replaceChildren(...parts, this.#key);
  }

  #exchange(at, axis) {
    const other = this.#axes.indexOf(axis);
    if (other >= 0) this.#axes[other] = this.#axes[at];
    this.#axes[at] = axis;
    this.#choices.querySelectorAll("select").forEach((list, each) => (list.value = this.#axes[each]));
    this.#draw();
  }

  #draw() {
    const { clientWidth: width, clientHeight: height } = this.#element;
    this.#element.classList.toggle("empty", !this.#front.length);
    this.#svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    if (!this.#front.length || !width) return this.#svg.replaceChildren();
    // Those beyond the limits first, so that the others lie over them.
    this.#sayShades();
    const order = this.#front.map((_, at) => at).sort((a, b) => this.#within[a] - this.#within[b]);
    const dots = order.map((at) => this.#dot(this.#front[at].lengths, this.#within[at] ? `shade-${this.#shade(at)}` : "beyond", 4));
    this.#svg.replaceChildren(...this.#frame(width, height), ...dots);
    for (const [name, lengths] of Object.entries(this.#marks)) this.mark(name, lengths);
  }

  /** Says beside the lists from which to which length the colours go. */
  #sayShades() {
    const axis = this.#axes[2];
    const [least, most] = this.#ends[axis].map((value) => amount(value, this.#objectives[axis]));
    const dots = Array.from({ length: SHADES }, (_, at) => Object.assign(document.createElement("i"), { className: `shade-${at}` }));
    this.#key.replaceChildren(least, ...dots, most);
  }

  #shade(at) {
    return Math.min(SHADES - 1, Math.floor(SHADES * this.#front[at].losses[this.#axes[2]]));
  }

  #frame(width, height) {
    const [across, up] = this.#axes;
    const bottom = height - MARGIN.bottom;
    const line = svgElement("path", { class: "axes", d: `M${MARGIN.left} ${MARGIN.top}V${bottom}H${width - MARGIN.right}` });
    const [[left, right], [low, high]] = [across, up].map((axis) => this.#ends[axis].map((value) => compared(value, this.#objectives[axis])));
    const said = (x, y, anchor, text) => svgElement("text", { x, y, "text-anchor": anchor }, text);
    return [
      line,
      said(MARGIN.left, bottom + 16, "start", left),
      said(width - MARGIN.right, bottom + 16, "end", right),
      said((MARGIN.left + width) / 2, bottom + 32, "middle", withUnit(this.#objectives[across])),
      said(MARGIN.left - 6, bottom, "end", low),
      said(MARGIN.left - 6, MARGIN.top + 10, "end", high),
      said(0, 12, "start", withUnit(this.#objectives[up])),
    ];
  }

  #place(lengths) {
    const { clientWidth: width, clientHeight: height } = this.#element;
    const share = (axis) => {
      const [least, most] = this.#ends[axis];
      return 0.04 + (0.92 * (lengths[axis] - least)) / (most - least || 1);
    };
    const [across, up] = this.#axes;
    const bottom = height - MARGIN.bottom;
    return [MARGIN.left + share(across) * (width - MARGIN.left - MARGIN.right), bottom - share(up) * (bottom - MARGIN.top)];
  }

  #dot(lengths, name, r) {
    const [cx, cy] = this.#place(lengths);
    return svgElement("circle", { class: name, cx, cy, r });
  }

  /** Reports the tour within reach of a pointer, those within the limits first, or none. */
  #at(event, onPoint, onNone = () => {}) {
    const box = this.#svg.getBoundingClientRect();
    const place = [event.clientX - box.left, event.clientY - box.top];
    const away = this.#front.map(({ lengths }, at) => {
      const [x, y] = this.#place(lengths);
      return Math.hypot(x - place[0], y - place[1]) + (this.#within[at] ? 0 : 4);
    });
    const index = away.indexOf(Math.min(...away));
    if (index >= 0 && away[index] <= REACH) onPoint(index);
    else onNone();
  }

  #described({ one, many }) {
    const count = this.#front.length;
    if (!count) return "No tours yet";
    const ranges = this.#objectives.map((objective, axis) => `${objective.name} from ${this.#ends[axis].map((value) => figure(value, objective)).join(" to ")}`);
    return `A choice of ${count} ${count === 1 ? one : many}: ${ranges.join(", ")}`;
  }
}
