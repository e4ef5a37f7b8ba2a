/** The maps of an instance: two linked planes, stops, one grid, or none where there are only costs. */

import { GridMap } from "./gridmap.js";
import { kindOf } from "../inputs/instance.js";
import { Planes } from "./planes.js";

const element = (id) => document.getElementById(id);

/** How much shorter a degree of longitude is than one of latitude, in the middle of the stops. */
function narrowingOf(stops) {
  const middle = stops.reduce((sum, { location }) => sum + location[1], 0) / (stops.length || 1);
  return Math.cos((middle * Math.PI) / 180);
}

export class Maps {
  #planes;
  #grid;
  #kind = "coordinates";
  #drawn = 2; // of the planes
  #narrowing = 1; // of degrees of longitude

  /**
   * @param {(plane: number, place: number[], only: boolean) => void} onClick told where a plane was
   *   clicked, in longitude and latitude where it is the only one
   */
  constructor(onClick) {
    const clicked = (plane, [x, y]) => onClick(plane, [x / this.#narrowing, y], this.#kind === "stops");
    this.#planes = new Planes([element("plane-1"), element("plane-2")], clicked);
    this.#grid = new GridMap(element("grid"));
  }

  /** Calls the stops by these ids, or by numbers where there are none. */
  name(ids) {
    this.#planes.name(ids);
  }

  /** Shows an instance without tours; `fit` says whether the view moves to hold all of it. */
  show(instance, fit) {
    this.#kind = kindOf(instance);
    const rows = this.#kind === "stops" ? this.#rowsOfStops(instance.stops) : (instance.coordinates ?? []);
    if (this.#kind !== "stops") this.#narrowing = 1;
    // Stops lie in one plane, whatever their objectives.
    this.#drawn = this.#kind === "coordinates" ? 2 : Math.sign(rows.length);
    document.querySelectorAll(".plane").forEach((figure, plane) => (figure.hidden = plane >= this.#drawn));
    document.querySelector(".wide").hidden = this.#kind !== "grid";
    if (this.#kind === "grid") this.#grid.show(instance);
    else this.#planes.show(rows, fit);
  }

  /** How far east and north stops are in degrees of latitude, as rows; none without locations. */
  #rowsOfStops(stops) {
    if (!stops.every(({ location }) => location?.every(Number.isFinite))) return [];
    this.#narrowing = narrowingOf(stops);
    return stops.map(({ location: [longitude, latitude] }) => [longitude * this.#narrowing, latitude, 0, 0]);
  }

  /** Shows the places that the service laid out on the grid. */
  place(places) {
    if (this.#kind === "grid" && places) this.#grid.place(places);
  }

  /** The places of the stops on each map that is drawn, for a picture; none of a grid. */
  get places() {
    return this.#kind === "grid" ? [] : this.#planes.places.slice(0, this.#drawn);
  }

  /** Draws a tour as "selected" or "pinned", closed or open; null takes it away. */
  draw(name, item, closed = true) {
    if (this.#kind === "grid") this.#grid.draw(name, item);
    else if (this.#drawn) this.#planes.draw(name, item?.tour ?? null, closed);
  }
}
