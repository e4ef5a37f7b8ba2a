/** Choose among tours under three or four objectives: by limits, or on the plane of two of them. */

import { Caps } from "../chart/caps.js";
import { Scatter } from "../chart/scatter.js";

const element = (id) => document.getElementById(id);
const OF_TWO = [".plot", "#budget", ".slider"]; // what fronts of two objectives are chosen from by

export class SeveralObjectives {
  #caps;
  #scatter;
  #front = [];
  #objectives = [];
  #noun = null;
  #selected = null; // the lengths of the selected tour
  #chosen = false; // by a person: then limits leave it selected where it is within them

  /**
   * @param {(index: number) => void} onSelect called with the tour to select
   * @param {(index: number | null) => void} onPreview called with the tour under the pointer
   */
  constructor({ onSelect, onPreview }) {
    const chosen = (index) => {
      this.#chosen = true;
      this.#caps.release(this.#front[index]);
      onSelect(index);
      this.#draw();
    };
    const limited = () => {
      this.#chosen &&= this.#selected !== null && this.#caps.allows({ lengths: this.#selected });
      if (!this.#chosen) onSelect(this.#caps.middle);
      this.#draw();
    };
    this.#caps = new Caps(element("caps"), limited, chosen);
    this.#scatter = new Scatter(element("scatter"), element("scatter-choices"), { onSelect: chosen, onPreview });
  }

  /** Shows a front under its objectives, in place of the chart of two. */
  show(front, objectives, noun) {
    [this.#front, this.#objectives, this.#noun] = [front, objectives, noun];
    this.#turn(true);
    this.#caps.show(front, objectives);
    this.#draw();
  }

  /** Makes room for the chart of two objectives. */
  hide() {
    this.#caps.forget();
    this.#chosen = false;
    this.#turn(false);
  }

  /** The tour in the middle of those within the limits. */
  get middle() {
    return this.#caps.middle;
  }

  /** The limits, as of Caps. */
  get limits() {
    return this.#caps.limits;
  }

  /** The limits that are shown, as of Caps. */
  get limitsShown() {
    return this.#caps.shown;
  }

  /** Sets the limits of the next front, in which a person chose the tour that is selected. */
  want(limits) {
    this.#caps.want(limits);
    this.#chosen = true;
  }

  /** Marks a tour as "selected", "pinned" or "previewed"; null removes the mark. */
  mark(name, lengths) {
    if (name === "selected") this.#selected = lengths;
    this.#scatter.mark(name, lengths);
  }

  #draw() {
    this.#scatter.show(this.#front, this.#objectives, this.#caps.within, this.#noun);
    element("caps-said").textContent = this.#caps.said;
  }

  #turn(shown) {
    element("several").hidden = element("how-of-several").hidden = !shown;
    element("how-of-two").hidden = shown;
    for (const name of OF_TWO) document.querySelector(`.front ${name}`).hidden = shown;
  }
}
