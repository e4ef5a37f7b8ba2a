/** The cities and tours on the map of one plane. */

import "../vendor/leaflet/leaflet.js";
import { colour, onSchemeChange } from "../common/colours.js";
import { fitting, flatMap } from "./flatmap.js";
import { Frame } from "./frame.js";
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
  #lines = { pinned: new TourLine("pinned", [5, 5]), selected: new TourLine("selected") };
  #routes = new Routes();
  #streets = new Streets();
  #names = L.layerGroup();
  #surroundings = { streets: null, places: [] };
  #places = [];
  #onEarth = false;
  #tiles = null;

  /** @param {{ onHover: (city: number | null) => void, onClick: (place: number[]) => void }} told */
  constructor(element, { onHover, onClick }) {
    this.#map = flatMap(element, { zoomDelta: 0.5, minZoom: -3, maxZoom: 20, doubleClickZoom: false });
    for (const line of [this.#streets, ...Object.values(this.#lines), this.#routes, this.#names]) line.addTo(this.#map);
    this.#cities = L.featureGroup().addTo(this.#map);
    this.#cities.on("mouseover", (event) => onHover(event.sourceTarget.city));
    this.#cities.on("mouseout", () => onHover(null));
    this.#map.on("click", (event) => onClick(this.#frame.place(event.latlng)));
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
    places.forEach((place, city) => this.#cities.addLayer(this.#dot(place, city, radius)));
    this.draw("selected", null);
    this.draw("pinned", null);
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

  /** Draws a tour as "selected" or "pinned", closed or open; null takes it away. */
  draw(name, tour, closed = true) {
    const stops = tour && closed ? [...tour, tour[0]] : (tour ?? []);
    this.#lines[name].show(stops.map((city) => this.#frame.latlng(this.#places[city])));
    if (name !== "selected") return;
    this.#mark(this.#start, tour?.[0]);
    this.#mark(this.#end, closed ? null : tour?.at(-1));
  }

  /** Draws the routes of a plan, `{ stops, style }` each, with a ring where all of them start; none takes them away. */
  drawRoutes(routes) {
    const latlngs = ({ stops }) => stops.map((city) => this.#frame.latlng(this.#places[city]));
    this.#routes.show(routes.map((route) => ({ latlngs: latlngs(route), style: route.style })));
    const starts = new Set(routes.map(({ stops }) => stops[0]));
    this.#mark(this.#start, starts.size === 1 ? [...starts][0] : null);
  }

  /** Rings a city, and says what it is; null takes the ring away. */
  highlight(city, said = "") {
    this.#mark(this.#highlight, city);
    if (city == null) this.#highlight.unbindTooltip();
    else this.#highlight.bindTooltip(said, { permanent: true, direction: "top" }).openTooltip();
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
