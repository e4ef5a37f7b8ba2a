/** A front and its tours, as they are looked at: chart, slider, figures and maps select together. */

import { FrontChart } from "./chart.js";
import { compare } from "./comparison.js";
import { showFigures } from "./figures.js";
import { length } from "./numbers.js";
import { UNNAMED, titled } from "./objectives.js";
import { Planes } from "./planes.js";
import { AngleSlider } from "./slider.js";
import { nearest } from "./tours.js";

const element = (id) => document.getElementById(id);

export class Result {
  #planes;
  #chart;
  #slider;
  #front = [];
  #angle = null; // wanted by the viewer, in degrees
  #selected = null;
  #pinned = null;
  #frame = 0;
  #objectives = UNNAMED;

  /** @param {(plane: number, place: number[]) => void} onClick told where a map was clicked */
  constructor(onClick) {
    const onSelect = (index) => this.#choose(index);
    this.#planes = new Planes([element("plane-1"), element("plane-2")], onClick);
    this.#chart = new FrontChart(element("front-chart"), onSelect);
    this.#slider = new AngleSlider(element("angle"), element("angle-shown"), onSelect);
    element("pin").addEventListener("click", () => this.#pin());
    this.clear([]);
  }

  /** What the two lengths are called from now on. */
  name(objectives) {
    this.#objectives = objectives;
    this.#chart.name(objectives);
    this.#slider.name(objectives);
    objectives.forEach((objective, plane) => {
      element(`plane-${plane + 1}-title`).textContent = titled(objective);
      element(`less-${plane + 1}`).textContent = `less ${objective.name}`;
    });
  }

  /** Cities without a front. */
  clear(rows, fit = true) {
    this.#planes.show(rows, fit);
    this.#front = [];
    this.#angle = null; // wanted by the viewer, in degrees
    this.#selected = this.#pinned = null;
    this.#chart.show([], []);
    this.#slider.show([]);
    this.#chart.mark("pinned", null);
    this.#drawPin();
    this.#draw();
    showFigures(element("figures"), null, null);
  }

  /** The fronts of the network alone and of the search, of the cities that are shown. */
  show(alone, answer) {
    this.#front = answer.front;
    this.#chart.show(alone.front, answer.front);
    this.#slider.show(answer.front);
    this.#select(nearest(this.#front, this.#angle ?? middle(this.#front)));
    showFigures(element("figures"), alone, answer);
  }

  #choose(index) {
    this.#angle = this.#front[index].angle;
    this.#select(index);
  }

  #select(index) {
    this.#selected = this.#front[index];
    this.#slider.select(index);
    // However often the slider moves between two frames, it is drawn once.
    cancelAnimationFrame(this.#frame);
    this.#frame = requestAnimationFrame(() => this.#draw());
  }

  #pin() {
    this.#pinned = this.#pinned ? null : this.#selected;
    this.#drawPin();
    this.#draw();
  }

  #drawPin() {
    element("pin").textContent = this.#pinned ? "Unpin" : "Pin to compare";
    element("pin").setAttribute("aria-pressed", String(this.#pinned !== null));
    this.#chart.mark("pinned", this.#pinned?.lengths ?? null);
    this.#planes.draw("pinned", this.#pinned?.tour ?? null);
  }

  #draw() {
    const selected = this.#selected;
    element("pin").disabled = !selected;
    this.#chart.mark("selected", selected?.lengths ?? null);
    this.#planes.draw("selected", selected?.tour ?? null);
    compare(element("comparison"), this.#objectives, selected, this.#pinned);
    for (const objective of [0, 1]) {
      const said = selected ? length(selected.lengths[objective]) : "";
      element(`length-${objective + 1}`).textContent = said;
    }
  }
}

const middle = (front) => (front[0].angle + front.at(-1).angle) / 2;
