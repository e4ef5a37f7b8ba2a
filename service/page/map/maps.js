/** The maps of an instance: two linked planes, stops, one grid, or none where there are only costs. */

import { GridMap } from "./gridmap.js";
import { UNNAMED, titled } from "../common/objectives.js";
import { kindOf } from "../inputs/instance.js";
import { Planes } from "./planes.js";

const element = (id) => document.getElementById(id);

/** Longitude and latitude of stops, as rows; none where any has no location. */
const rowsOfStops = (stops) =>
  stops.every(({ location }) => location?.every(Number.isFinite)) ? stops.map(({ location }) => location) : [];

export class Maps {
  #planes;
  #grid;
  #kind = "coordinates";
  #drawn = 2; // of the planes
  #credit = "";
  #objectives = UNNAMED;

  /**
   * @param {(plane: number, place: number[], only: boolean) => void} onClick told where a plane was
   *   clicked, in longitude and latitude where it is the only one
   */
  constructor(onClick) {
    const clicked = (plane, place) => onClick(plane, place, this.#kind === "stops");
    this.#planes = new Planes([element("plane-1"), element("plane-2")], clicked);
    this.#grid = new GridMap(element("grid"));
  }

  /** Draws map tiles under stops, where there are any; the credit says whom they are by. */
  tile({ url, credit }) {
    if (!url) return;
    this.#credit = credit;
    this.#planes.tile(url);
  }

  /** Calls the maps by these objectives, and the stops by ids, or by numbers where there are none. */
  name(objectives, ids) {
    this.#objectives = objectives;
    this.#planes.name(ids);
    this.#title();
  }

  #title() {
    const onEarth = this.#kind === "stops"; // where one map is drawn, of both objectives
    this.#objectives.forEach((objective, plane) => {
      element(`plane-${plane + 1}-title`).textContent = onEarth ? "Map" : titled(objective);
    });
    element("length-1").hidden = onEarth;
  }

  /** Shows an instance without tours; `fit` says whether the view moves to hold all of it. */
  show(instance, fit) {
    this.#kind = kindOf(instance);
    const onEarth = this.#kind === "stops";
    this.#title();
    const rows = onEarth ? rowsOfStops(instance.stops) : (instance.coordinates ?? []);
    // Stops lie in one plane, whatever their objectives.
    this.#drawn = this.#kind === "coordinates" ? 2 : Math.sign(rows.length);
    document.querySelectorAll(".plane").forEach((figure, plane) => (figure.hidden = plane >= this.#drawn));
    document.querySelector(".wide").hidden = this.#kind !== "grid";
    if (this.#kind === "grid") this.#grid.show(instance);
    else this.#planes.show(rows, fit, onEarth);
    element("credit").textContent = onEarth && rows.length ? this.#credit : "";
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
