/** The maps of an instance: two linked planes, one grid, or none where there are only costs. */

import { GridMap } from "./gridmap.js";
import { kindOf } from "../inputs/instance.js";
import { Planes } from "./planes.js";

const element = (id) => document.getElementById(id);

export class Maps {
  #planes;
  #grid;
  #kind = "coordinates";

  /** @param {(plane: number, place: number[]) => void} onClick told where a plane was clicked */
  constructor(onClick) {
    this.#planes = new Planes([element("plane-1"), element("plane-2")], onClick);
    this.#grid = new GridMap(element("grid"));
  }

  /** Shows an instance without tours; `fit` says whether the view moves to hold all of it. */
  show(instance, fit) {
    this.#kind = kindOf(instance);
    for (const figure of document.querySelectorAll(".plane")) {
      figure.hidden = this.#kind !== "coordinates";
    }
    document.querySelector(".wide").hidden = this.#kind !== "grid";
    if (this.#kind === "grid") this.#grid.show(instance);
    else this.#planes.show(instance.coordinates ?? [], fit);
  }

  /** Shows the places that the service laid out on the grid. */
  place(places) {
    if (this.#kind === "grid" && places) this.#grid.place(places);
  }

  /** Draws a tour as "selected" or "pinned"; null takes it away. */
  draw(name, item) {
    if (this.#kind === "grid") this.#grid.draw(name, item);
    else if (this.#kind === "coordinates") this.#planes.draw(name, item?.tour ?? null);
  }
}
