/** The maps of an instance: two linked planes, stops, one grid, or none where there are only costs. */

import { GridMap } from "./gridmap.js";
import { kindOf } from "../inputs/instance.js";
import { Planes } from "./planes.js";

const element = (id) => document.getElementById(id);

/** Rows of cities for stops: how far east and north in degrees of latitude; none without locations. */
function rowsOfStops(stops) {
  if (!stops.every(({ location }) => location?.every(Number.isFinite))) return [];
  const middle = stops.reduce((sum, { location }) => sum + location[1], 0) / stops.length;
  const narrowing = Math.cos((middle * Math.PI) / 180);
  return stops.map(({ location: [longitude, latitude] }) => [longitude * narrowing, latitude, 0, 0]);
}

export class Maps {
  #planes;
  #grid;
  #kind = "coordinates";
  #drawn = 2; // of the planes

  /** @param {(plane: number, place: number[]) => void} onClick told where a plane was clicked */
  constructor(onClick) {
    this.#planes = new Planes([element("plane-1"), element("plane-2")], onClick);
    this.#grid = new GridMap(element("grid"));
  }

  /** Calls the stops by these ids, or by numbers where there are none. */
  name(ids) {
    this.#planes.name(ids);
  }

  /** Shows an instance without tours; `fit` says whether the view moves to hold all of it. */
  show(instance, fit) {
    this.#kind = kindOf(instance);
    const rows = this.#kind === "stops" ? rowsOfStops(instance.stops) : (instance.coordinates ?? []);
    // Stops lie in one plane, whatever their objectives.
    this.#drawn = this.#kind === "coordinates" ? 2 : Math.sign(rows.length);
    document.querySelectorAll(".plane").forEach((figure, plane) => (figure.hidden = plane >= this.#drawn));
    document.querySelector(".wide").hidden = this.#kind !== "grid";
    if (this.#kind === "grid") this.#grid.show(instance);
    else this.#planes.show(rows, fit);
  }

  /** Shows the places that the service laid out on the grid. */
  place(places) {
    if (this.#kind === "grid" && places) this.#grid.place(places);
  }

  /** Draws a tour as "selected" or "pinned", closed or open; null takes it away. */
  draw(name, item, closed = true) {
    if (this.#kind === "grid") this.#grid.draw(name, item);
    else if (this.#drawn) this.#planes.draw(name, item?.tour ?? null, closed);
  }
}
