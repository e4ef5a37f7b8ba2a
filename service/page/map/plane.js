/** The cities and tours on the map of one plane. */

import "../vendor/leaflet/leaflet.js";
import { Dots } from "./dots.js";
import { IF_LOST } from "../inputs/places.js";
import { fitting, flatMap, ring, sayAt } from "./flatmap.js";
import { Frame } from "./frame.js";
import { Handling } from "./handling.js";
import { Mercator } from "./mercator.js";
import { Routes } from "./routes.js";
import { ScaleBar, metresAt } from "./scale.js";
import { Streets } from "./streets.js";
import { TourLine } from "./tourline.js";
import { World } from "./world.js";

const { L } = globalThis;

const PAST = { colour: "alone", dash: [] };
const NARROW = 240; // pixels, as a map on a phone
const CROWD = 300; // stops
const ROOM = 20; // pixels beside the cities
const MOVED = 3; // pixels from the centre of a map to where it was, of a map that somebody moved
const STEP = 10; // pixels that an arrow key moves a stop, with Shift one
const POINTED = 6; // pixels from a stop within which it is pointed at
const [MOVING, STILL] = [1500, 150]; // stops drawn of a way that changes, and milliseconds until all are

export class Plane {
  #map;
  #frame = Frame.around([]);
  #view; // to which the map was fitted: its box, zoom and centre
  #stops = new Dots();
  #pointed = null; // the city under the pointer
  #rests = {}; // timers until the whole way is drawn, by its name
  #start = ring("start", 18);
  #end = ring("end", 18);
  #highlight = ring("highlight", 16);
  #waiting = ring("waiting", 12);
  #lines = { pinned: new TourLine("pinned", [5, 5]), selected: new TourLine("selected") };
  #routes = new Routes();
  #past = new Routes("past");
  #world = new World();
  #scale;
  #metres; // of one in the plane, if that is known
  #streets = new Streets();
  #names = L.layerGroup();
  #surroundings = { streets: null, places: [], extent: [], awaited: false };
  #places = [];
  #along = () => null; // the places along the streets of a way through cities
  #onEarth = false;
  #tiles; // null where the service names none

  /**
   * @param {{ onHover: (city: number | null) => void, onClick: (place: number[]) => void }} told
   * @param {ChosenStop} chosen the stop that is chosen on this map and on the other
   */
  constructor(element, { onHover, onClick, onMove }, chosen) {
    this.#map = flatMap(element, { name: "Show all stops", fit: () => this.#fit(this.#boxOf(this.#places)) }, { zoomDelta: 0.5, minZoom: -3, maxZoom: 20, doubleClickZoom: false });
    const layers = [this.#world, this.#streets, ...Object.values(this.#lines), this.#routes, this.#past, this.#stops, this.#names];
    for (const layer of layers) layer.addTo(this.#map);
    this.#map.on("mousemove", (event) => this.#point(this.#near(event.containerPoint, POINTED), onHover));
    this.#map.on("mouseout", () => this.#point(null, onHover));
    this.#map.on("click", (event) => onClick(this.#frame.place(event.latlng)));
    element.role = "application";
    element.setAttribute("aria-labelledby", `${element.id}-title`);
    element.setAttribute("aria-describedby", "stop-help");
    this.#scale = new ScaleBar(this.#map);
    new Handling(this.#map, this.#handled(onMove), chosen);
    new ResizeObserver(() => this.#resize()).observe(element);
    this.#fit(this.#frame.bounds);
  }

  /** Draws cities at these places; `fit` says whether the view moves to hold them all: true, false, or IF_LOST, when it has lost them. */
  show(places, fit = true, onEarth = false) {
    const isFitted = fit === IF_LOST ? onEarth !== this.#onEarth || this.#hasLost(places) : fit;
    this.#places = places;
    if (isFitted || onEarth !== this.#onEarth) this.#frame = frameOf(places, onEarth, this.#surroundings);
    this.#onEarth = onEarth;
    this.#showTiles();
    this.#showSurroundings();
    const crowded = places.length > CROWD || this.#map.getContainer().clientWidth < NARROW;
    this.#stops.show(places.map((place) => this.#frame.latlng(place)), crowded);
    this.#pointed = null;
    this.wait(null);
    this.draw("selected", []);
    this.draw("pinned", []);
    this.drawRoutes([]);
    this.pass([]);
    this.highlight(null);
    if (isFitted) this.#fit(this.#frame.bounds);
  }

  get places() {
    return this.#places;
  }

  /** Where the cities are drawn, in x and y. */
  get drawn() {
    return this.#places.map((place) => this.#frame.latlng(place).reverse());
  }

  /** Draws map tiles, while places on the earth are shown; null for none. */
  tile(url) {
    this.#tiles = url && L.tileLayer(url, { maxNativeZoom: 19, maxZoom: 22, className: "tile", zIndex: 0 });
    this.#showTiles();
    this.#showSurroundings();
  }

  /** Draws named places, and streets without tiles, from now on; the next stops are shown with a whole `extent`. */
  surround(surroundings) {
    this.#surroundings = surroundings;
    this.#showSurroundings();
  }

  #showSurroundings() {
    const { streets, places } = this.#surroundings;
    this.#streets.show(this.#tiles ? null : streets, (place) => this.#frame.latlng(place));
    this.#names.clearLayers();
    for (const { name, at } of places) this.#names.addLayer(nameAt(name, this.#frame.latlng(at)));
    if (this.#isBare) this.#world.show((place) => this.#frame.latlng(place));
    else this.#world.hide();
    this.#showScale();
  }

  /** Takes the metres of one in the plane; undefined if that is not known. */
  measure(metres) {
    this.#metres = metres;
    this.#showScale();
  }

  #showScale() {
    const onEarth = (latlng) => metresAt(this.#frame.place(latlng)[1]);
    const inPlane = this.#metres && (() => this.#metres * this.#frame.unit);
    this.#scale.show((this.#places.length && (this.#onEarth ? onEarth : inPlane)) || null);
  }

  /** Whether there are places on the earth, and neither tiles nor streets under them. */
  get #isBare() {
    const { streets, awaited } = this.#surroundings;
    return this.#onEarth && this.#places.length > 0 && this.#tiles === null && !streets && !awaited;
  }

  #showTiles() {
    if (!this.#tiles) return;
    if (this.#onEarth && this.#places.length) this.#tiles.addTo(this.#map);
    else this.#tiles.remove();
  }

  /** Draws a way through cities as "selected" or "pinned", back to the first if it is closed; nothing without a way. */
  draw(name, cities) {
    this.#line(name, cities);
    if (name !== "selected") return;
    this.#mark(this.#start, cities[0]);
    this.#mark(this.#end, cities[0] === cities.at(-1) ? null : cities.at(-1));
  }

  /** Draws the line of a way. During changes, one of thousands of stops is drawn through some of them. */
  #line(name, cities) {
    const along = this.#along(cities);
    const apart = along ? 1 : Math.ceil(cities.length / MOVING);
    const drawn = apart > 1 ? cities.filter((_, at) => at % apart === 0 || at === cities.length - 1) : cities;
    this.#lines[name].show(this.#latlngs(drawn, along), along !== null);
    clearTimeout(this.#rests[name]);
    if (apart > 1) this.#rests[name] = setTimeout(() => this.#lines[name].show(this.#latlngs(cities, along)), STILL);
  }

  /** Draws ways along the streets from now on: `along` returns the places of a way through cities, or null. */
  follow(along) {
    this.#along = along;
  }

  /** Where a way through cities is drawn, in x and y. */
  drawnLine(cities) {
    return this.#latlngs(cities, this.#along(cities)).map(([lat, lng]) => [lng, lat]);
  }

  #latlngs(cities, along) {
    return (along ?? cities.map((city) => this.#places[city])).map((place) => this.#frame.latlng(place));
  }

  /** Draws the routes of a plan, `{ stops, style }` each, with a ring where all of them start, or a disc for each; none takes them away. */
  drawRoutes(routes) {
    const drawn = routes.map(({ stops, style }) => [stops, this.#along(stops), style]);
    const starts = new Set(routes.map(({ stops }) => stops[0]));
    this.#routes.show(drawn.map(([stops, along, style]) => ({ latlngs: this.#latlngs(stops, along), along: along !== null, style })), starts.size > 1);
    this.#mark(this.#start, starts.size === 1 ? [...starts][0] : null);
  }

  /** Draws in grey what vehicles have driven, each `{ places, tip }`, over their routes, with a disc in the colour of a tip where the vehicle is. */
  pass(driven) {
    this.#past.show(driven.map(({ places, tip }) => ({ latlngs: places.map((place) => this.#frame.latlng(place)), style: { ...PAST, tip } })));
  }

  /** Rings a city, and says what it is; null removes the ring. */
  highlight(city, said = "") {
    this.#highlight.unbindTooltip();
    this.#mark(this.#highlight, city);
    if (city == null || !this.#places[city]) return;
    sayAt(this.#highlight, said);
  }

  /** Rings a clicked place that is not a stop yet; null removes the ring. */
  wait(place) {
    if (place) this.#waiting.setLatLng(this.#frame.latlng(place)).addTo(this.#map);
    else this.#waiting.remove();
  }

  /** The interface of the cities for Handling. */
  #handled(onMove) {
    const placeAt = (point) => this.#frame.place(this.#map.containerPointToLatLng(point));
    return {
      near: (point, reach) => this.#near(point, reach),
      pointOf: (city) => this.#pointOf(this.#places[city]),
      stride: (fine) => (fine ? 1 : STEP),
      drag: (city, point) => this.#drag(city, placeAt(point)),
      drop: (city, point) => onMove(city, placeAt(point)),
    };
  }

  #pointOf(place) {
    return this.#map.latLngToContainerPoint(this.#frame.latlng(place));
  }

  /** The city that is drawn nearest to a point, if it lies within reach; null otherwise. */
  #near(point, reach) {
    let [nearest, least] = [null, reach];
    this.#stops.points.forEach(({ x, y }, city) => {
      const far = Math.hypot(x - point.x, y - point.y);
      if (far <= least) [nearest, least] = [city, far];
    });
    return nearest;
  }

  #drag(city, place) {
    const latlng = this.#frame.latlng(place);
    this.#stops.move(city, latlng);
    this.#highlight.setLatLng(latlng).addTo(this.#map);
  }

  #mark(ring, city) {
    const place = city == null ? undefined : this.#places[city];
    if (place) ring.setLatLng(this.#frame.latlng(place)).addTo(this.#map);
    else ring.remove();
  }

  #point(city, onHover) {
    if (city === this.#pointed) return;
    this.#pointed = city;
    this.#map.getContainer().style.cursor = city === null ? "" : "pointer";
    onHover(city);
  }

  /** Fits the map to another size, unless somebody looks at a part of it. */
  #resize() {
    const { zoom, center } = this.#view;
    const whole = zoom === this.#map.getZoom() && this.#map.latLngToContainerPoint(center).distanceTo(this.#map.getSize().divideBy(2)) < MOVED;
    this.#map.invalidateSize({ pan: false });
    if (whole) this.#fit();
  }

  #fit(box = this.#view.box) {
    this.#map.fitBounds(box, fitting(ROOM));
    this.#view = { box, zoom: this.#map.getZoom(), center: this.#map.getCenter() };
  }

  /** Whether other places lie out of view, where all of those before were in view, or fill less than half of it. */
  #hasLost(places) {
    const [before, box] = [this.#places, places].map((each) => this.#boxOf(each));
    if (box.equals(before)) return false;
    const view = this.#map.getBounds();
    const zoom = this.#map.getBoundsZoom(box, false, L.point(2 * ROOM, 2 * ROOM));
    return zoom > this.#map.getZoom() + 1 || !view.intersects(box) || (view.contains(before) && !view.contains(box));
  }

  /** The box of places on the map as it is drawn now. */
  #boxOf(places) {
    const frame = frameOf(places, this.#onEarth, this.#surroundings);
    return L.latLngBounds(frame.bounds.map(([lat, lng]) => this.#frame.latlng(frame.place({ lat, lng }))));
  }
}

const frameOf = (places, onEarth, { extent }) => (onEarth ? Mercator.around([...places, ...extent]) : Frame.around(places));

function nameAt(name, latlng) {
  const html = Object.assign(document.createElement("span"), { textContent: name });
  const icon = L.divIcon({ className: "place-name", iconSize: [0, 0], html });
  return L.marker(latlng, { icon, pane: "names", interactive: false, keyboard: false });
}
