/** Name both ends of a front and its knee on the chart: buttons that preview and select their tours. */

import { leastOf } from "../common/amounts.js";
import { lastOf } from "../result/tours.js";

const KNEE = "compromise"; // the knee, as people call it
const LAST = 2; // of the three
const BESIDE = 6; // pixels from a point to its name

export class Labels {
  #element;
  #buttons;
  #indices = [];

  /**
   * @param {(index: number) => void} onSelect called with the tour to select
   * @param {(index: number | null) => void} onPreview called with the tour to preview
   */
  constructor(element, onSelect, onPreview) {
    this.#element = element;
    this.#buttons = ["first", "knee", "last"].map((name, which) => {
      const button = Object.assign(document.createElement("button"), { type: "button", className: `label ${name}` });
      button.addEventListener("click", () => onSelect(this.#indices[which]));
      for (const kind of ["focus", "pointerenter"]) button.addEventListener(kind, () => onPreview(this.#indices[which]));
      for (const kind of ["blur", "pointerleave"]) button.addEventListener(kind, () => onPreview(null));
      element.append(button);
      return button;
    });
  }

  /** Names the tours of a front: fewer names if it has fewer than three tours, or its knee is an end. */
  show(front, objectives) {
    this.#indices = front.length > 1 ? [0, kneeOf(front), lastOf(front)] : [];
    const [first, last] = objectives.map(leastOf);
    const said = [first, KNEE, last];
    this.#buttons.forEach((button, which) => (button.textContent = said[which]));
  }

  /** Puts the names beside their points; `place` returns the pixels of a tour's point, `axis` are those of the plot's left side. */
  place(front, place, axis) {
    const places = this.#indices.map((index) => place(front[index].lengths));
    this.#buttons.forEach((button) => (button.hidden = !places.length));
    if (!places.length) return;
    const boxes = this.#buttons.map((button, which) => this.#boxOf(button, which, places[which], axis));
    const [first, knee, last] = boxes;
    this.#buttons[1].classList.toggle("above", knee.top < places[1][1]);
    this.#buttons[1].hidden = this.#isEnd || touch(knee, first) || touch(knee, last);
    this.#buttons.forEach((button, which) => (button.style.translate = `${boxes[which].left}px ${boxes[which].top}px`));
  }

  get #isEnd() {
    const [first, knee, last] = this.#indices;
    return knee === first || knee === last;
  }

  /**
   * The name of the first tour is above it, the others are below and to the left, where no tour of a front can be. Where
   * that is beyond the axis, that of the last tour begins there, and the other is above and to the right, where the
   * front has no line.
   */
  #boxOf({ offsetWidth: width, offsetHeight: height }, which, [x, y], axis) {
    const below = which === LAST || (which > 0 && x - width >= axis);
    const left = below ? Math.max(axis, x - width) : Math.min(which ? x + BESIDE : x - BESIDE, this.#element.clientWidth - width);
    const top = below ? y + BESIDE : Math.max(0, y - height - BESIDE);
    return { left, top, right: left + width, bottom: top + height };
  }
}

const touch = (one, other) => one.left < other.right && other.left < one.right && one.top < other.bottom && other.top < one.bottom;

/** The tour with the least sum of both lengths, each scaled to 0 to 1 over the front. */
export function kneeOf(front) {
  const ends = [front[0], front[lastOf(front)]].map(({ lengths }) => lengths);
  const [low, high] = [Math.min, Math.max].map((pick) => [0, 1].map((axis) => pick(ends[0][axis], ends[1][axis])));
  const sum = ({ lengths }) => lengths.reduce((all, at, axis) => all + (at - low[axis]) / (high[axis] - low[axis] || 1), 0);
  const sums = front.map(sum);
  return sums.indexOf(Math.min(...sums));
}
