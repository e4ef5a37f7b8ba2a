/** The maps of an instance: two linked planes, stops, one grid, or none where there are only costs. */

import { GridMap } from "./gridmap.js";
import { pictureOfRoutes, pictureOfTours, startsOf, styleOfTour } from "./map_pictures.js";
import { UNNAMED, titled } from "../common/objectives.js";
import { placesOf } from "../fleet/fleet_request.js";
import { kindOf } from "../inputs/instance.js";
import { stylesOf } from "../fleet/route_styles.js";
import { namesOf } from "../fleet/routes_of_plan.js";
import { isPlan } from "../common/nouns.js";
import { Planes } from "./planes.js";

const element = (id) => document.getElementById(id);

const SINGLE = ["stops", "fleet"]; // of which one map is drawn, of both objectives

/** The places that are drawn, as rows, and whether they are longitude and latitude. */
const placed = (instance, kind) =>
  kind === "fleet" ? placesOf(instance) : kind === "stops" ? placesOf({ stops: instance.stops }) : { places: instance.coordinates ?? [], onEarth: false };

export class Maps {
  #planes;
  #grid;
  #kind = "coordinates";
  #drawn = 2; // of the planes
  #tilesCredit = "";
  #streetsCredit = "";
  #onEarth = false;
  #objectives = UNNAMED;
  #ids = null; // of the stops
  #robots = []; // of the request

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
    this.#tilesCredit = credit;
    this.#planes.tile(url);
    this.#sayCredit();
  }

  /** Draws what lies around the stops: `streets` where there are no tiles, and `places` by name. */
  surround({ streets = null, places = [] }) {
    this.#streetsCredit = streets?.credit ?? "";
    this.#planes.surround({ streets, places });
    this.#sayCredit();
  }

  #sayCredit() {
    element("credit").textContent = this.#onEarth ? this.#tilesCredit || this.#streetsCredit : "";
  }

  /** Calls the maps by these objectives, and the stops by ids, or by numbers where there are none. */
  name(objectives, ids) {
    this.#objectives = objectives;
    this.#ids = ids;
    this.#planes.name(ids);
    this.#title();
  }

  #title() {
    const single = SINGLE.includes(this.#kind);
    this.#objectives.forEach((objective, plane) => {
      element(`plane-${plane + 1}-title`).textContent = single ? "Map" : titled(objective);
    });
    element("length-1").hidden = single;
  }

  /** Shows an instance without tours; `fit` says whether the view moves to hold all of it. */
  show(instance, fit) {
    this.#kind = kindOf(instance);
    this.#robots = instance.robots ?? [];
    this.#title();
    const { places: rows, onEarth } = placed(instance, this.#kind);
    // Stops lie in one plane, whatever their objectives.
    this.#drawn = this.#kind === "coordinates" ? 2 : Math.sign(rows.length);
    document.querySelectorAll(".plane").forEach((figure, plane) => (figure.hidden = plane >= this.#drawn));
    document.querySelector(".wide").hidden = this.#kind !== "grid";
    if (this.#kind === "grid") this.#grid.show(instance);
    else this.#planes.show(rows, fit, onEarth);
    this.#onEarth = onEarth && rows.length > 0;
    this.#sayCredit();
  }

  /** Shows the places that the service laid out on the grid. */
  place(places) {
    if (this.#kind === "grid" && places) this.#grid.place(places);
  }

  /**
   * The maps that are drawn, for a picture: with tours, each `{ item, cities, dashed }`, of which the
   * last is selected; or with the plan that is selected alone.
   */
  pictures(tours) {
    const { item } = tours.at(-1);
    if (this.#kind === "grid") return [{ title: "Map", ...this.#pictureOnGrid(tours, item) }];
    const routes = isPlan(item) ? this.#routes(item) : null;
    return this.#planes.drawn.slice(0, this.#drawn).map((places, plane) => ({
      title: element(`plane-${plane + 1}-title`).textContent,
      ...(routes ? pictureOfRoutes(places, routes) : pictureOfTours(places, tours)),
    }));
  }

  #pictureOnGrid(tours, item) {
    const paths = isPlan(item)
      ? this.#paths(item).map(({ style, ...others }) => ({ ...others, ...style, cased: true }))
      : tours.map((tour) => ({ path: tour.item.path, ...styleOfTour(tour.dashed) }));
    const drawn = this.#grid.pictureOf(paths);
    return { ...drawn, starts: startsOf(isPlan(item) ? drawn.lines : drawn.lines.slice(-1)) };
  }

  /** Draws a tour as "selected" or "pinned", closed or open; null takes it away. Of plans the selected one alone is drawn. */
  draw(name, item, closed = true) {
    if (this.#kind === "fleet") {
      if (name === "selected") this.#planes.drawRoutes(isPlan(item) ? this.#routes(item) : []);
    } else if (this.#kind === "grid") this.#drawOnGrid(name, item);
    else if (this.#drawn) this.#planes.draw(name, item?.tour ?? null, closed);
  }

  #drawOnGrid(name, item) {
    this.#grid.draw(name, isPlan(item) ? null : item);
    if (name === "selected") this.#grid.drawRoutes(isPlan(item) ? this.#paths(item) : []);
  }

  /** The paths of a plan's robots, each `{ name, path, style }`. */
  #paths({ routes }) {
    const styles = stylesOf(routes, this.#robots);
    return routes.map(({ robot, path }, at) => ({ name: robot, path, style: styles[at] }));
  }

  /** The routes of a plan, each `{ name, stops, style }`, whose stops are indexes. */
  #routes({ routes }) {
    const index = new Map(this.#ids?.map((id, at) => [id, at]));
    const names = namesOf(routes);
    const styles = stylesOf(routes);
    return routes.map(({ stops }, at) => ({
      name: names[at],
      stops: stops.map((id) => index.get(id)),
      style: styles[at],
    }));
  }
}
