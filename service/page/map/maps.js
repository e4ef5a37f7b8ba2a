/** The maps of an instance: of the earth, of planes, both linked, of one grid, or none where there are only costs. */

import { GridMap } from "./gridmap.js";
import { pictureOfRoutes, pictureOfTours, startsOf, styleOfTour } from "./map_pictures.js";
import { wordsOf } from "../common/amounts.js";
import { made } from "../common/elements.js";
import { UNNAMED, titled } from "../common/objectives.js";
import { formOf, kindOf } from "../common/kinds.js";
import { EARTH, mapsOf } from "../inputs/places.js";
import { stylesOf } from "../fleet/route_styles.js";
import { namesOf } from "../fleet/routes_of_plan.js";
import { Planes, roundOf } from "./planes.js";
import { metresOf } from "./scale.js";
import { Ways } from "./ways/ways.js";
import { showRoutes } from "./key.js";

const element = (id) => document.getElementById(id);

const EDITED = ["stops", "coordinates"]; // kinds of instances whose stops can be moved and deleted on the map

const NOTHING = { driven: [], isCancelled: false };

/** The source of coasts and towns, and how to have streets in their place. */
const WORLD_CREDIT = () => ["A rough map by Natural Earth. ", made("a", { href: "guide/use-the-page#streets-under-your-stops", textContent: "Draw streets" })];

/** The maps to draw, as `mapsOf` returns them. */
const placed = (instance) => (instance.stops ? mapsOf(instance) : { drawn: instance.coordinates ? [0, 1] : [], rows: instance.coordinates ?? [] });

export class Maps {
  #planes;
  #ways = new Ways();
  #grid;
  #kind = kindOf({});
  #form = null; // of its request
  #drawn = [0, 1]; // the contents of the first map and of the second: see `mapsOf`
  #hasTiles;
  #tilesCredit = "";
  #streetsCredit = "";
  #isBare = true; // no streets are drawn, nor awaited
  #onEarth = false;
  #objectives = UNNAMED;
  #ids = null; // of the stops
  #asked = {}; // the request, as far as it is known
  #robots = []; // of the request
  #keyed = []; // the routes whose colours are named
  #passed = NOTHING; // what vehicles have driven, and whether stops are cancelled
  #flown = false; // whether both objectives are measured in straight lines

  /**
   * @param {(plane: number, place: number[], only: boolean) => void} onClick called with the place where a plane was
   *   clicked, in longitude and latitude if it is the only one
   * @param {(plane: number, city: number, place: number[]) => void} onMove called with the place where a stop was put
   * @param {(city: number) => void} onDelete called with the stop to delete
   * @param {(stop: string | null) => void} onChoose called with the id of a fleet's stop that is chosen
   * @param {(name: string) => string[]} more what is said of a stop: see Planes
   * @param {{ onMove: function, onRefused: function }} ofEnds called for ends on a robot's map: see GridEnds
   */
  constructor({ onClick, onMove, onDelete, onChoose, ofEnds, more }) {
    const clicked = (plane, place) => onClick(plane, place, this.#form === "stops" || Boolean(this.#kind.movers));
    this.#planes = new Planes([element("plane-1"), element("plane-2")], {
      onClick: clicked,
      onMove,
      onDelete,
      more,
      onChoose: (city) => this.#kind.movers && onChoose(city === null ? null : this.#ids?.[city] ?? null),
    });
    this.#planes.follow((cities) => this.#ways.along(cities));
    this.#grid = new GridMap(element("grid"), ofEnds);
  }

  /** Draws map tiles under stops, if there are any; the credit names their source. */
  tile({ url, credit }) {
    this.#hasTiles = Boolean(url);
    this.#tilesCredit = url ? credit : "";
    this.#planes.tile(url ?? null);
    this.#sayCredit();
  }

  /**
   * Draws what lies around the stops: `streets` on a map without tiles, or the coasts of the world unless streets are
   * `awaited`, and `places` by name; and tours along `legs`, which lie between the corners of an `extent`.
   */
  surround({ streets = null, places = [], legs = null, extent = [], awaited = false }) {
    this.#streetsCredit = streets?.credit ?? "";
    this.#isBare = !streets && !awaited;
    this.#planes.surround({ streets, places, extent, awaited });
    this.#ways.know(legs);
    this.#sayCredit();
  }

  /** The ways along streets that tours are drawn along. */
  get ways() {
    return this.#ways;
  }

  /** Whether tours are driven: on the earth, and not under straight lines alone. */
  get driven() {
    return this.#onEarth && !this.#flown;
  }

  #sayCredit() {
    const ofWorld = this.#onEarth && this.#hasTiles === false && this.#isBare;
    if (ofWorld) element("credit").replaceChildren(...WORLD_CREDIT());
    else element("credit").textContent = this.#onEarth ? this.#tilesCredit || this.#streetsCredit : "";
  }

  /** Names the maps after these objectives, and the stops by ids, or by numbers without ids. */
  name(objectives, ids) {
    this.#objectives = objectives;
    this.#ids = ids;
    this.#planes.name(ids);
    this.#title();
  }

  #title() {
    const single = this.#drawn.length < 2;
    this.#drawn.forEach((drawn, map) => {
      element(`plane-${map + 1}-title`).textContent = single || drawn === EARTH ? "Map" : titled(this.#objectives[drawn]);
    });
    this.#planes.measure(this.#drawn.map((drawn) => metresOf(this.#objectives[drawn])));
    const redrawn = single || this.#drawn[1] === EARTH ? null : this.#objectives[this.#drawn[1]];
    element("plane-2-note").textContent = redrawn ? `The same stops, drawn anew: the longer a line, the ${wordsOf(redrawn).more} ${redrawn.name}.` : "";
    element("length-1").hidden = single || this.#drawn[0] === EARTH;
  }

  /** Rings a clicked place that is not a stop yet; null removes the rings. */
  wait(plane, place) {
    this.#planes.wait(plane, place);
  }

  /**
   * Shows an instance without tours; `fit` says whether the view moves to hold all of it (see Plane), `editable`
   * whether its stops may be moved and deleted, where the page can.
   */
  show(instance, fit, editable) {
    this.#kind = kindOf(instance);
    this.#form = formOf(instance);
    this.#asked = instance;
    this.#robots = instance.robots ?? [];
    [this.#keyed, this.#passed] = [[], NOTHING];
    this.#flown = Boolean(instance.objectives?.every(({ from }) => from === "great_circle"));
    const { drawn, rows } = placed(instance);
    const onEarth = drawn[0] === EARTH;
    this.#drawn = drawn;
    this.#title();
    document.querySelectorAll(".plane").forEach((figure, map) => (figure.hidden = map >= drawn.length));
    document.querySelector(".wide").hidden = !this.#kind.onGrid;
    if (this.#kind.onGrid) this.#grid.show(instance, editable);
    else this.#planes.show(rows, fit, onEarth);
    const fleet = Boolean(this.#kind.movers && !this.#kind.onGrid);
    // In planes both objectives of a fleet may have the same places.
    const movable = editable && (EDITED.includes(this.#form) || (fleet && onEarth && drawn.length === 1));
    this.#planes.edit(movable, fit !== true, movable || fleet);
    this.#onEarth = onEarth && rows.length > 0;
    this.#ways.lead(this.#onEarth ? rows.map((row) => row.slice(0, 2)) : []);
    this.#sayLines(null);
    this.#sayCredit();
  }

  /** Shades a robot's map by the cost layer that the request names. */
  shade(request) {
    if (this.#kind.onGrid) this.#grid.shade(request);
  }

  /** Shows other ends of a request on a robot's map. */
  showEnds(request) {
    if (this.#kind.onGrid) this.#grid.showEnds(request);
  }

  /** Chooses a stop of a fleet by its id; null chooses none. */
  choose(stop) {
    const city = this.#ids?.indexOf(stop) ?? -1;
    this.#planes.choose(city < 0 ? null : city);
  }

  /** Shows the places that the service laid out on the grid, and what no path leads to. */
  place(places, uncovered) {
    if (this.#kind.onGrid && places) this.#grid.place(places, uncovered?.regions);
  }

  /**
   * The maps that are drawn, for a picture: with tours, each `{ item, cities, dashed }`, the last
   * one selected; or with the plan that is selected alone.
   */
  pictures(tours) {
    const { item } = tours.at(-1);
    if (this.#kind.onGrid) return [{ title: "Map", ...this.#pictureOnGrid(tours, item) }];
    const routes = this.#kind.movers ? this.#routes(item) : null;
    return this.#planes.drawn.slice(0, this.#drawn.length).map((places, plane) => ({
      title: element(`plane-${plane + 1}-title`).textContent,
      ...this.#pictureOn(plane, places, routes, tours),
    }));
  }

  #pictureOn(plane, places, routes, tours) {
    const lineOf = (cities) => this.#planes.drawnLine(plane, cities);
    return routes ? pictureOfRoutes(places, routes, lineOf) : pictureOfTours(places, tours, lineOf);
  }

  #pictureOnGrid(tours, item) {
    const { movers } = this.#kind;
    const paths = movers
      ? this.#paths(item).map(({ style, ...others }) => ({ ...others, ...style, cased: true }))
      : tours.map((tour) => ({ path: tour.item.path, ...styleOfTour(tour.dashed) }));
    const drawn = this.#grid.pictureOf(paths);
    return { ...drawn, starts: startsOf(movers ? drawn.lines : drawn.lines.slice(-1)) };
  }

  /** Draws a tour as "selected" or "pinned", closed or open; null takes it away. Of plans the selected one alone is drawn. */
  draw(name, item, closed = true) {
    if (name === "selected") {
      this.#sayLines(item, closed);
      this.#showKey(item);
    }
    if (this.#kind.onGrid) this.#drawOnGrid(name, item);
    else if (this.#kind.movers) {
      if (name === "selected") this.#planes.drawRoutes(item ? this.#routes(item) : []);
    } else if (this.#drawn.length) this.#planes.draw(name, item?.tour ?? null, closed);
  }

  /** Draws in grey what the vehicles of a fleet have driven: see Plane. */
  pass(driven, isCancelled = false) {
    if (!this.#drawn.length || this.#kind.onGrid) return;
    this.#planes.pass(driven);
    this.#passed = { driven, isCancelled };
    if (this.#kind.movers) showRoutes(element("vehicles-key"), this.#keyed, this.#passed);
  }

  /** The places of stops by their ids, and those along the `way` through them as it is drawn; null for stops that no map shows. */
  along(stops) {
    const cities = stops.map((stop) => this.#ids?.indexOf(stop) ?? -1);
    const places = this.#planes.placesOf(cities);
    return this.#drawn.length && !places.includes(undefined) ? { places, way: this.#ways.along(cities) ?? places } : null;
  }

  /** The stops along a tour as one way, or along each route of a plan. */
  waysOf(item, closed) {
    return this.#kind.movers ? this.#routes(item).map(({ stops }) => stops) : [roundOf(item.tour, closed)];
  }

  /** Says under the map's title whether the lines of what is drawn follow the streets. */
  #sayLines(item, closed) {
    const ways = this.#onEarth && item ? this.waysOf(item, closed) : [];
    const followed = ways.length > 0 && ways.every((cities) => this.#ways.along(cities));
    const said = followed ? "along the streets" : "in straight lines";
    element("lines").textContent = ways.length ? said : "";
  }

  /** Names the colours of a plan's routes beside the map that is shown. */
  #showKey(plan) {
    const { movers, onGrid } = this.#kind;
    for (const [id, there] of [["vehicles-key", !onGrid], ["robots-key", onGrid]]) element(id).hidden = !(movers && there);
    if (!movers) return;
    this.#keyed = plan ? (onGrid ? this.#paths(plan) : this.#routes(plan)) : [];
    showRoutes(element(onGrid ? "robots-key" : "vehicles-key"), this.#keyed, onGrid ? null : this.#passed);
  }

  #drawOnGrid(name, item) {
    const { movers } = this.#kind;
    this.#grid.draw(name, movers ? null : item);
    if (name === "selected") this.#grid.drawRoutes(movers && item ? this.#paths(item) : []);
  }

  /** The paths of a plan's robots, each `{ name, robot, stops, path, style }`, whose stops are places. */
  #paths({ routes }) {
    const styles = stylesOf(routes, { robots: this.#robots });
    const index = new Map(this.#robots.map(({ id }, at) => [id, at]));
    return routes.map(({ robot, tour, path }, at) => ({ name: robot, robot: index.get(robot), stops: tour, path, style: styles[at] }));
  }

  /** The routes of a plan, each `{ name, stops, style }`, whose stops are indexes. */
  #routes({ routes }) {
    const index = new Map(this.#ids?.map((id, at) => [id, at]));
    const names = namesOf(routes, this.#kind.movers, this.#asked);
    const styles = stylesOf(routes, this.#asked);
    return routes.map(({ stops }, at) => ({
      name: names[at],
      stops: stops.map((id) => index.get(id)),
      style: styles[at],
    }));
  }
}
