/** Two linked maps of the same cities: a city that is pointed at on one is marked on both. */

import { ChosenStop } from "./chosen_stop.js";
import { withCustomer } from "../inputs/details.js";
import { Plane } from "./plane.js";

export class Planes {
  #maps;
  #tour = null;
  #routes = []; // the routes of the plan that is drawn
  #ids = null;
  #chosen;
  #more;

  /**
   * @param {(plane: number, place: number[]) => void} onClick called with the place where a map was clicked
   * @param {(plane: number, city: number, place: number[]) => void} onMove called with the place where a stop was put
   * @param {(city: number) => void} onDelete called with the stop to delete
   * @param {(city: number | null) => void} onChoose called with the stop that is chosen on a map
   * @param {(name: string) => string[]} more what else is said of a stop that is pointed at: who is there, and when it is visited
   */
  constructor(elements, { onClick, onMove, onDelete, onChoose, more }) {
    this.#more = more;
    const chosen = (city) => {
      this.#highlight(city);
      onChoose(city);
    };
    this.#chosen = new ChosenStop(chosen, onDelete);
    this.#maps = elements.map((element, plane) => {
      const onHover = (city) => this.#highlight(city ?? this.#chosen.city);
      const moved = (city, place) => onMove(plane, city, place);
      return new Plane(element, { onHover, onClick: (place) => onClick(plane, place), onMove: moved }, this.#chosen);
    });
  }

  /** Rings a clicked place that is not a stop yet; null removes the rings. */
  wait(plane, place) {
    this.#maps.forEach((map, at) => map.wait(at === plane ? place : null));
  }

  /** Names the cities by these ids, or by numbers without ids. */
  name(ids) {
    this.#ids = ids;
    this.#chosen.name((city) => this.#nameOf(city));
  }

  /** Whether the cities that are shown can be moved and deleted, or only chosen, and are `kept`, so that the chosen one stays chosen. */
  edit(editable, kept, choosable) {
    this.#chosen.show(this.#maps[0].places.length, editable, kept, choosable);
  }

  /** Chooses a city; null chooses none. */
  choose(city) {
    if (this.#chosen.choosable && city !== this.#chosen.city) this.#chosen.choose(city);
  }

  /** Takes the metres of one in the plane of each map: see Plane. */
  measure(metres) {
    this.#maps.forEach((map, at) => map.measure(metres[at]));
  }

  /** Draws map tiles under the first map, while places on the earth are shown; null for none. */
  tile(url) {
    this.#maps[0].tile(url);
  }

  /** Draws streets and names of places on the first map, from now on. */
  surround(surroundings) {
    this.#maps[0].surround(surroundings);
  }

  /** Draws cities, rows of four numbers, or of two for one map; removes tours. */
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

  /** Draws a tour as "selected" or "pinned"; null removes it. */
  draw(name, tour, closed = true) {
    if (name === "selected") this.#tour = tour;
    const cities = roundOf(tour ?? [], closed);
    for (const map of this.#maps) if (map.places.length) map.draw(name, cities);
  }

  /** Draws ways on the first map along the streets from now on: see Plane. */
  follow(along) {
    this.#maps[0].follow(along);
  }

  /** Where a way through cities is drawn on a map, in x and y. */
  drawnLine(plane, cities) {
    return this.#maps[plane].drawnLine(cities);
  }

  /** Draws the routes of a plan, each `{ name, stops, style }`; without routes, removes them. */
  drawRoutes(routes) {
    this.#routes = routes;
    for (const map of this.#maps) if (map.places.length) map.drawRoutes(routes);
  }

  /** Draws on the first map what vehicles have driven: see Plane. */
  pass(driven) {
    this.#maps[0].pass(driven);
  }

  /** Where these cities lie on the first map. */
  placesOf(cities) {
    return cities.map((city) => this.#maps[0].places[city]);
  }

  #highlight(city) {
    const said = city === null ? "" : this.#said(city);
    this.#maps.forEach((map) => map.highlight(city, said));
  }

  #said(city) {
    const [customer, hour] = this.#more(this.#ids?.[city] ?? String(city + 1));
    const turn = turnOf(city, this.#tour, this.#routes);
    return `${withCustomer(this.#nameOf(city), customer)}${turn}${hour && `${turn ? "," : ":"} ${hour}`}`;
  }

  #nameOf(city) {
    return this.#ids?.[city] ?? `stop ${city + 1}`;
  }
}

/** Says the position of a stop on a tour, or, without depots, on the only one of these routes that visits it; "" for a depot. */
export function turnOf(city, tour, routes) {
  if (tour?.includes(city)) return `: ${ordinal(tour.indexOf(city) + 1)} on the tour`;
  const visiting = routes.filter(({ stops }) => stops.includes(city));
  if (visiting.length !== 1) return "";
  const [{ stops, name }] = visiting;
  const isDepot = (stop) => (stops.length > 1 && stop === stops[0] && stop === stops.at(-1)) || routes.some((route) => route !== visiting[0] && route.stops.includes(stop));
  const turn = stops.slice(0, stops.indexOf(city) + 1).filter((stop) => !isDepot(stop)).length;
  return turn ? `: ${ordinal(turn)} of ${name}` : "";
}

/** The cities of a tour, back to the first if it is closed. */
export const roundOf = (tour, closed) => (closed && tour.length ? [...tour, tour[0]] : tour);

const ENDINGS = { one: "st", two: "nd", few: "rd", other: "th" };
const RULES = new Intl.PluralRules("en", { type: "ordinal" });

const ordinal = (number) => `${number}${ENDINGS[RULES.select(number)]}`;
