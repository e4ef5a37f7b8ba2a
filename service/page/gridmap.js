/** An occupancy grid with its places, and the paths of tours on it. */

import "./vendor/leaflet/leaflet.js";
import { colour, onSchemeChange, rgb } from "./colours.js";

const { L } = globalThis;
const BY_FINGER = matchMedia("(pointer: coarse)").matches;
const TINT = 0.55; // how much of a cell's colour the dearest cost takes

export class GridMap {
  #map;
  #element;
  #grid = null;
  #image = null;
  #places = L.featureGroup();
  #renderer = L.canvas({ padding: 0.2 });
  #lines = {};

  constructor(element) {
    this.#element = element;
    this.#map = L.map(element, {
      crs: L.CRS.Simple,
      attributionControl: false,
      zoomControl: !BY_FINGER,
      zoomSnap: 0,
      minZoom: -5,
      maxZoom: 8,
      scrollWheelZoom: false,
      dragging: !BY_FINGER,
    });
    this.#map.setView([0, 0], 0);
    this.#lines.pinned = this.#line({ weight: 2, dashArray: "5 5" });
    this.#lines.selected = this.#line({ weight: 2.5 });
    this.#places.addTo(this.#map);
    new ResizeObserver(() => this.#fit()).observe(element);
    onSchemeChange(() => this.#grid && this.#colour());
  }

  /** Shows a grid, rows of 0 and 1, tinted by a layer of costs where there is one. */
  show({ grid, cost_layer, places }) {
    this.#grid = { grid, costs: cost_layer };
    for (const name of Object.keys(this.#lines)) this.draw(name, null);
    this.place(places ?? []);
    this.#colour();
    this.#fit();
  }

  /** Shows places, a row and a column each. */
  place(places) {
    this.#places.clearLayers();
    const style = { renderer: this.#renderer, radius: 3, weight: 0, fillOpacity: 1, interactive: false };
    for (const cell of places) this.#places.addLayer(L.circleMarker(middle(cell), style));
    this.#places.setStyle({ fillColor: colour("ink") });
  }

  /** Draws the path of a tour as "selected" or "pinned"; null takes it away. */
  draw(name, item) {
    this.#lines[name].setLatLngs((item?.path?.cells ?? []).map(middle));
  }

  #line(style) {
    return L.polyline([], { renderer: this.#renderer, interactive: false, ...style }).addTo(this.#map);
  }

  #colour() {
    this.#image?.remove();
    this.#image = L.imageOverlay(drawn(this.#grid), this.#bounds, { className: "cells" }).addTo(this.#map);
    this.#places.setStyle({ fillColor: colour("ink") });
    this.#lines.selected.setStyle({ color: colour("selected") });
    this.#lines.pinned.setStyle({ color: colour("pinned") });
  }

  #fit() {
    if (!this.#grid || !this.#element.clientWidth) return;
    this.#map.invalidateSize({ pan: false });
    this.#map.fitBounds(this.#bounds, { padding: [8, 8], animate: false });
  }

  get #bounds() {
    return [[-this.#grid.grid.length, 0], [0, this.#grid.grid[0].length]];
  }
}

/** Rows go down the map, columns to the right. */
const middle = ([row, column]) => [-row - 0.5, column + 0.5];

/** The address of an image with a pixel for each cell. */
function drawn({ grid, costs }) {
  const [height, width] = [grid.length, grid[0].length];
  const canvas = Object.assign(document.createElement("canvas"), { width, height });
  const context = canvas.getContext("2d");
  const image = context.createImageData(width, height);
  const [free, blocked, dear] = ["card", "blocked", "dear"].map(rgb);
  const dearest = costs ? Math.max(...costs.map((row) => Math.max(...row))) || 1 : 1;
  grid.forEach((cells, row) =>
    cells.forEach((cell, column) => {
      const share = costs ? (TINT * costs[row][column]) / dearest : 0;
      const shown = cell ? blocked : free.map((part, index) => part + share * (dear[index] - part));
      image.data.set([...shown, 255], 4 * (row * width + column));
    }),
  );
  context.putImageData(image, 0, 0);
  return canvas.toDataURL();
}
