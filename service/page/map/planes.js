/** Two linked maps of the same cities: a city that is pointed at on one is marked on both. */

import { Plane } from "./plane.js";

export class Planes {
  #maps;
  #tour = null;
  #routes = []; // of the plan that is drawn
  #ids = null;

  /** @param {(plane: number, place: number[]) => void} onClick told where a map was clicked */
  constructor(elements, onClick) {
    this.#maps = elements.map((element, plane) => {
      const onHover = (city) => this.#highlight(city);
      return new Plane(element, { onHover, onClick: (place) => onClick(plane, place) });
    });
  }

  /** Calls the cities by these ids, or by numbers where there are none. */
  name(ids) {
    this.#ids = ids;
  }

  /** Draws map tiles under the first map, while places on the earth are shown. */
  tile(url) {
    this.#maps[0].tile(url);
  }

  /** Draws streets and names of places on the first map, from now on. */
  surround(surroundings) {
    this.#maps[0].surround(surroundings);
  }

  /** Draws cities, rows of four numbers, or of two where there is one map; tours are taken away. */
  show(rows, fit = true, onEarth = false) {
    this.#tour = null;
    this.#routes = [];
    this.#maps[0].show(rows.map((row) => row.slice(0, 2)), fit, onEarth);
    this.#maps[1].show(rows.map((row) => row.slice(2, 4)).filter((place) => place.length), fit);
  }

  /** Where the cities are drawn on both maps, in x and y. */
  get drawn() {
    return this.#maps.map(({ drawn }) => drawn);
  }

  /** Draws a tour as "selected" or "pinned"; null takes it away. */
  draw(name, tour, closed = true) {
    if (name === "selected") this.#tour = tour;
    for (const map of this.#maps) if (map.places.length) map.draw(name, tour, closed);
  }

  /** Draws the routes of a plan, each `{ name, stops, style }`; none takes them away. */
  drawRoutes(routes) {
    this.#routes = routes;
    for (const map of this.#maps) if (map.places.length) map.drawRoutes(routes);
  }

  /** Where a stop stands on the tour, or on the route that visits it; of a depot nothing. */
  #turn(city) {
    if (this.#tour?.includes(city)) return `: ${ordinal(this.#tour.indexOf(city) + 1)} on the tour`;
    const visiting = this.#routes.filter(({ stops }) => stops.includes(city));
    if (visiting.length !== 1) return "";
    return `: ${ordinal(visiting[0].stops.indexOf(city) + 1)} of ${visiting[0].name}`;
  }

  #highlight(city) {
    const name = this.#ids?.[city] ?? `stop ${city + 1}`;
    const said = name + this.#turn(city);
    this.#maps.forEach((map) => map.highlight(city, said));
  }
}

const ENDINGS = { one: "st", two: "nd", few: "rd", other: "th" };
const RULES = new Intl.PluralRules("en", { type: "ordinal" });

const ordinal = (number) => `${number}${ENDINGS[RULES.select(number)]}`;
