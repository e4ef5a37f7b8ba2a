/** An occupancy grid with its places, and the paths on it: of tours, or of the robots of a plan. */

import "../vendor/leaflet/leaflet.js";
import { colour, onSchemeChange, rgb } from "../common/colours.js";
import { made } from "../common/elements.js";
import { fitting, flatMap, ring, sayAt } from "./flatmap.js";
import { GridEnds } from "./grid_ends.js";
import { turnOf } from "./planes.js";
import { Routes } from "./routes.js";
import { TourLine } from "./tourline.js";

const { L } = globalThis;
const TINT = 0.55; // the share of a cell's colour at the highest cost
const POINTED = 9; // pixels from a place within which it is pointed at

export class GridMap {
  #map;
  #element;
  #grid = null;
  #image = null;
  #cells = []; // the places
  #places = L.featureGroup();
  #unreached = L.featureGroup();
  #renderer = L.canvas({ padding: 0.2 });
  #outlines = L.svg({ padding: 0.2 });
  #ends;
  #highlight = ring("highlight", 16);
  #tour = null; // the selected tour
  #lines = { pinned: new TourLine("pinned", [5, 5]), selected: new TourLine("selected") };
  #routes = new Routes();
  #visits = []; // the routes that are drawn, each `{ name, stops }`

  /** @param {object} told callbacks for ends that are moved: see GridEnds */
  constructor(element, told) {
    this.#element = element;
    this.#map = flatMap(element, { name: "Show the whole map", fit: () => this.#fit() }, { minZoom: -5, maxZoom: 8 });
    this.#map.setView([0, 0], 0);
    for (const line of [...Object.values(this.#lines), this.#routes]) line.addTo(this.#map);
    for (const group of [this.#places, this.#unreached]) group.addTo(this.#map);
    this.#ends = new GridEnds(this.#map, told);
    this.#map.on("mousemove", ({ containerPoint }) => this.#point(this.#near(containerPoint)));
    element.addEventListener("mouseleave", () => this.#point(null)); // Leaflet's canvas keeps it from the map
    new ResizeObserver(() => this.#fit()).observe(element);
    onSchemeChange(() => this.#grid && this.#colour());
  }

  /** Shows the map of a request, rows of 0 and 1, tinted by a layer of costs if there is one; `unknownCells` are rows of 0 and 1 too. `editable` says whether its ends can be moved. */
  show(request, editable) {
    const { grid, places, unknownCells: unknown } = request;
    const shown = { grid, unknown, costs: shadeOf(request) };
    const same = Object.keys(shown).every((part) => shown[part] === this.#grid?.[part]);
    this.#grid = shown;
    for (const name of Object.keys(this.#lines)) this.draw(name, null);
    this.drawRoutes([]);
    this.#element.style.aspectRatio = `${grid[0].length} / ${grid.length}`;
    this.place(places ?? []);
    this.#ends.show(request, editable, same);
    if (same) return; // else a large map would be drawn again for each end that moves
    this.#colour();
    this.#fit();
  }

  /** Shades the map by the cost layer that the request names. */
  shade(request) {
    this.#grid.costs = shadeOf(request);
    this.#colour();
  }

  /** Shows other ends of the request. */
  showEnds(request) {
    this.#ends.show(request, true, true);
  }

  /** Shows places, a row and a column each, and the boxes of regions out of reach. */
  place(places, regions = []) {
    this.#cells = places;
    this.#point(null);
    this.#places.clearLayers();
    const style = { renderer: this.#renderer, radius: 3, weight: 0, fillOpacity: 1, interactive: false };
    for (const cell of places) this.#places.addLayer(L.circleMarker(middle(cell), style));
    this.#places.setStyle({ fillColor: colour("ink") });
    this.#unreached.clearLayers();
    const outlined = { renderer: this.#outlines, className: "unreached", interactive: false };
    regions.forEach(({ box }, at) => this.#unreached.addLayer(L.rectangle(corners(box), outlined)).addLayer(nameAt(box, letterOf(at))));
    document.querySelector("#grid-legend .unreached").hidden = !regions.length;
  }

  /** Draws the path of a tour as "selected" or "pinned"; null removes it. */
  draw(name, item) {
    const path = lineOf(item?.path);
    this.#lines[name].show(path);
    if (name !== "selected") return;
    this.#tour = item?.tour ?? null;
    this.#ends.follow([[null, item?.path?.cells ?? []]]);
  }

  #mark(ring, place) {
    if (place) ring.setLatLng(place).addTo(this.#map);
    else ring.remove();
  }

  /** The place that is drawn nearest to a point, if it is pointed at; null otherwise. */
  #near(point) {
    const far = this.#cells.map((cell) => this.#map.latLngToContainerPoint(middle(cell)).distanceTo(point));
    const least = Math.min(...far);
    return least <= POINTED ? far.indexOf(least) : null;
  }

  /** Rings a place, and says what it is; null removes the ring. */
  #point(place) {
    this.#highlight.unbindTooltip();
    this.#mark(this.#highlight, place === null ? undefined : middle(this.#cells[place]));
    if (place === null) return;
    const said = `place ${place + 1}${turnOf(place, this.#tour, this.#visits)}`;
    sayAt(this.#highlight, said);
  }

  /** Draws the paths of a plan's robots, `{ name, robot, stops, path, style }` each with the robot's index, and where they start; none takes them away. */
  drawRoutes(routes) {
    this.#visits = routes;
    if (routes.length) this.#ends.follow(routes.map(({ robot, path }) => [robot, path?.cells ?? []]));
    this.#routes.show(routes.map(({ path, style }) => ({ latlngs: lineOf(path), style })), true);
  }

  /** The map as a part of a picture, with the lines of these paths, each `{ path, ... }`. */
  pictureOf(paths) {
    const { grid } = this.#grid;
    const ground = { href: drawn(this.#grid), width: grid[0].length, height: grid.length };
    const lines = paths.map(({ path, ...style }) => ({ ...style, places: lineOf(path).map(flat) }));
    return { ground, places: this.#cells.map(middle).map(flat), lines: lines.filter(({ places }) => places.length) };
  }

  #colour() {
    this.#image?.remove();
    const style = { className: "cells", pane: "tilePane" };
    this.#image = L.imageOverlay(drawn(this.#grid), this.#bounds, style).addTo(this.#map);
    this.#places.setStyle({ fillColor: colour("ink") });
  }

  #fit() {
    if (!this.#grid || !this.#element.clientWidth) return;
    this.#map.invalidateSize({ pan: false });
    this.#map.fitBounds(this.#bounds, fitting(8));
  }

  get #bounds() {
    return [[-this.#grid.grid.length, 0], [0, this.#grid.grid[0].length]];
  }
}

/** The costs that a request's map is tinted by; undefined without a layer. */
export const shadeOf = ({ cost_layer: layer, cost_layers: layers, shaded = 0 }) => layer ?? layers?.[shaded]?.layer;

/** Rows go down the map, columns to the right. */
const middle = ([row, column]) => [-row - 0.5, column + 0.5];

/** Two corners of a box, given the first and the last cell in it. */
const corners = ([[top, left], [bottom, right]]) => [[-top, left], [-bottom - 1, right + 1]];

/** The name of a region that cannot be reached: numbers would be taken for the order of places. */
export const letterOf = (at) => String.fromCharCode("A".charCodeAt(0) + at);

/** The name of a box, in its middle. */
function nameAt(box, name) {
  const html = made("span", {}, name);
  const icon = L.divIcon({ className: "unreached-name", iconSize: [0, 0], html });
  return L.marker(L.latLngBounds(corners(box)).getCenter(), { icon, interactive: false, keyboard: false });
}

/** The line of a path on the map; empty without a path, as while a front is searched. */
const lineOf = (path) => turns(path?.cells ?? []).map(middle);

/** x and y of a position on the map. */
const flat = ([lat, lng]) => [lng, lat];

/** The cells of a path at its ends and where it turns. */
const turns = (cells) =>
  cells.filter(([row, column], at) => {
    const [before, after] = [cells[at - 1], cells[at + 1]];
    return !before || !after || 2 * row !== before[0] + after[0] || 2 * column !== before[1] + after[1];
  });

/** The address of an image with a pixel for each cell. */
function drawn({ grid, unknown, costs }) {
  const [height, width] = [grid.length, grid[0].length];
  const canvas = Object.assign(document.createElement("canvas"), { width, height });
  const context = canvas.getContext("2d");
  const image = context.createImageData(width, height);
  const [free, blocked, unexplored, dear] = ["card", "blocked", "unknown", "dear"].map(rgb);
  const dearest = costs ? Math.max(...costs.map((row) => Math.max(...row))) || 1 : 1;
  grid.forEach((cells, row) =>
    cells.forEach((cell, column) => {
      const share = costs ? (TINT * costs[row][column]) / dearest : 0;
      const ground = unknown?.[row][column] ? unexplored : cell ? blocked : free;
      const shown = cell ? ground : ground.map((part, index) => part + share * (dear[index] - part));
      image.data.set([...shown, 255], 4 * (row * width + column));
    }),
  );
  context.putImageData(image, 0, 0);
  return canvas.toDataURL();
}
