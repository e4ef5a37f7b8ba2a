/** The cities and tours on the map of one plane. */

import "../vendor/leaflet/leaflet.js";
import { colour, onSchemeChange } from "../common/colours.js";
import { fitting, flatMap } from "./flatmap.js";
import { Frame } from "./frame.js";
import { Handling } from "./handling.js";
import { Mercator } from "./mercator.js";
import { Routes } from "./routes.js";
import { Streets } from "./streets.js";
import { TourLine } from "./tourline.js";

const { L } = globalThis;
const NARROW = 240; // pixels, as a map on a phone

export class Plane {
  #map;
  #frame = Frame.around([]);
  #cities;
  #renderer = L.canvas({ padding: 0.2 });
  #start = ring("start", 18);
  #end = ring("end", 18);
  #highlight = ring("highlight", 16);
  #waiting = ring("waiting", 12);
  #lines = { pinned: new TourLine("pinned", [5, 5]), selected: new TourLine("selected") };
  #routes = new Routes();
  #streets = new Streets();
  #names = L.layerGroup();
  #surroundings = { streets: null, places: [] };
  #places = [];
  #dots = []; // of the cities
  #along = () => null; // of a way through cities the places along the streets
  #onEarth = false;
  #tiles = null;

  /**
   * @param {{ onHover: (city: number | null) => void, onClick: (place: number[]) => void }} told
   * @param {ChosenStop} chosen the stop that is chosen on this map and on the other
   */
  constructor(element, { onHover, onClick, onMove }, chosen) {
    this.#map = flatMap(element, { zoomDelta: 0.5, minZoom: -3, maxZoom: 20, doubleClickZoom: false });
    for (const line of [this.#streets, ...Object.values(this.#lines), this.#routes, this.#names]) line.addTo(this.#map);
    this.#cities = L.featureGroup().addTo(this.#map);
    this.#cities.on("mouseover", (event) => onHover(event.sourceTarget.city));
    this.#cities.on("mouseout", () => onHover(null));
    this.#map.on("click", (event) => onClick(this.#frame.place(event.latlng)));
    element.role = "application";
    element.setAttribute("aria-labelledby", `${element.id}-title`);
    element.setAttribute("aria-describedby", "stop-help");
    new Handling(this.#map, this.#handled(onMove), chosen);
    new ResizeObserver(() => this.#resize()).observe(element);
    onSchemeChange(() => this.#colour());
    this.#fit();
    this.#colour();
  }

  /** Draws cities at these places; `fit` says whether the view moves to hold them all. */
  show(places, fit = true, onEarth = false) {
    this.#places = places;
    if (fit || onEarth !== this.#onEarth) this.#frame = (onEarth ? Mercator : Frame).around(places);
    this.#onEarth = onEarth;
    this.#showTiles();
    this.#showSurroundings();
    this.#cities.clearLayers();
    const crowded = places.length > 300 || this.#map.getContainer().clientWidth < NARROW;
    const radius = crowded ? 2 : 3.5;
    this.#dots = places.map((place, city) => this.#dot(place, city, radius));
    for (const dot of this.#dots) this.#cities.addLayer(dot);
    this.wait(null);
    this.draw("selected", []);
    this.draw("pinned", []);
    this.drawRoutes([]);
    this.highlight(null);
    if (fit) this.#fit();
    this.#colour();
  }

  get places() {
    return this.#places;
  }

  /** Where the cities are drawn, in x and y. */
  get drawn() {
    return this.#places.map((place) => this.#frame.latlng(place).reverse());
  }

  /** Draws map tiles, while places on the earth are shown. */
  tile(url) {
    this.#tiles = L.tileLayer(url, { maxNativeZoom: 19, maxZoom: 22, className: "tile", zIndex: 0 });
    this.#showTiles();
    this.#showSurroundings();
  }

  /** Draws places by name, and streets where there are no tiles, from now on. */
  surround(surroundings) {
    this.#surroundings = surroundings;
    this.#showSurroundings();
  }

  #showSurroundings() {
    const { streets, places } = this.#surroundings;
    this.#streets.show(this.#tiles ? null : streets, (place) => this.#frame.latlng(place));
    this.#names.clearLayers();
    for (const { name, at } of places) this.#names.addLayer(nameAt(name, this.#frame.latlng(at)));
  }

  #showTiles() {
    if (!this.#tiles) return;
    if (this.#onEarth && this.#places.length) this.#tiles.addTo(this.#map);
    else this.#tiles.remove();
  }

  /** Draws a way through cities as "selected" or "pinned", back to the first where it is closed; of none nothing. */
  draw(name, cities) {
    const along = this.#along(cities);
    this.#lines[name].show(this.#latlngs(cities, along), along !== null);
    if (name !== "selected") return;
    this.#mark(this.#start, cities[0]);
    this.#mark(this.#end, cities[0] === cities.at(-1) ? null : cities.at(-1));
  }

  /** Draws ways along the streets from now on: `along` gives the places of a way through cities, or null where it does not know. */
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

  /** Draws the routes of a plan, `{ stops, style }` each, with a ring where all of them start; none takes them away. */
  drawRoutes(routes) {
    const drawn = routes.map(({ stops, style }) => [stops, this.#along(stops), style]);
    this.#routes.show(drawn.map(([stops, along, style]) => ({ latlngs: this.#latlngs(stops, along), along: along !== null, style })));
    const starts = new Set(routes.map(({ stops }) => stops[0]));
    this.#mark(this.#start, starts.size === 1 ? [...starts][0] : null);
  }

  /** Rings a city, and says what it is; null takes the ring away. */
  highlight(city, said = "") {
    this.#mark(this.#highlight, city);
    if (city == null) this.#highlight.unbindTooltip();
    else this.#highlight.bindTooltip(said, { permanent: true, direction: "top" }).openTooltip();
  }

  /** Rings a place that is clicked, but no stop yet; null takes the ring away. */
  wait(place) {
    if (place) this.#waiting.setLatLng(this.#frame.latlng(place)).addTo(this.#map);
    else this.#waiting.remove();
  }

  /** What Handling is to know of the cities, and to do with them. */
  #handled(onMove) {
    const placeAt = (point) => this.#frame.place(this.#map.containerPointToLatLng(point));
    return {
      near: (point, reach) => this.#near(point, reach),
      pointOf: (city) => this.#pointOf(this.#places[city]),
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
    this.#places.forEach((place, city) => {
      const far = this.#pointOf(place).distanceTo(point);
      if (far <= least) [nearest, least] = [city, far];
    });
    return nearest;
  }

  #drag(city, place) {
    const latlng = this.#frame.latlng(place);
    this.#dots[city].setLatLng(latlng);
    this.#highlight.setLatLng(latlng).addTo(this.#map);
  }

  #mark(ring, city) {
    const place = city == null ? undefined : this.#places[city];
    if (place) ring.setLatLng(this.#frame.latlng(place)).addTo(this.#map);
    else ring.remove();
  }

  #dot(place, city, radius) {
    const style = { renderer: this.#renderer, radius, weight: 0 };
    const dot = L.circleMarker(this.#frame.latlng(place), style);
    dot.city = city;
    return dot;
  }

  #resize() {
    this.#map.invalidateSize({ pan: false });
    this.#fit();
  }

  #fit() {
    this.#map.fitBounds(this.#frame.bounds, fitting(this.#map, 20));
  }

  #colour() {
    this.#cities.setStyle({ fillColor: colour("ink"), fillOpacity: 1 });
  }
}

function nameAt(name, latlng) {
  const html = Object.assign(document.createElement("span"), { textContent: name });
  const icon = L.divIcon({ className: "place-name", iconSize: [0, 0], html });
  return L.marker(latlng, { icon, pane: "names", interactive: false, keyboard: false });
}

function ring(name, side) {
  const icon = L.divIcon({ className: `ring ${name}`, iconSize: [side, side], tooltipAnchor: [0, -side / 2] });
  return L.marker([0, 0], { icon, interactive: false, keyboard: false });
}
