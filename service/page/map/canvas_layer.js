/** A layer of a map with its own canvas, so that redrawing it redraws nothing else. */

import "../vendor/leaflet/leaflet.js";
import { onSchemeChange } from "../common/colours.js";

const { L } = globalThis;

/** Classes that extend it have `lines`, rows of positions on the map, and `paint` them. */
export class CanvasLayer extends L.Layer {
  #canvas = document.createElement("canvas");
  #size = null;
  #ratio = 1; // the ratio of the screen's pixels to the map's

  /**
   * @param {string} name the canvas's class
   * @param {string} pane the pane of the map to draw in
   */
  constructor(name, pane = "tours") {
    super();
    L.setOptions(this, { pane });
    this.lines = [];
    this.#canvas.className = `tour ${name}`;
    onSchemeChange(() => this.redraw());
  }

  onAdd(map) {
    this.getPane().append(this.#canvas);
    map.on("move zoom viewreset resize", this.redraw, this);
    this.redraw();
  }

  redraw() {
    this.pixels = pointOn(this._map);
    this.#canvas.hidden = !this.lines.some((latlngs) => latlngs.length);
    if (this.#canvas.hidden) return;
    this.paint(this.#cleared(), this.placed);
  }

  /** The lines in the map's pixels. */
  get placed() {
    return this.lines.map((latlngs) => latlngs.map(this.pixels));
  }

  /** The canvas's context, empty and in the map's pixels. */
  #cleared() {
    const size = this._map.getSize();
    if (!this.#size?.equals(size) || this.#ratio !== devicePixelRatio) this.#resize(size);
    L.DomUtil.setPosition(this.#canvas, this._map.containerPointToLayerPoint([0, 0]));
    const context = this.#canvas.getContext("2d");
    context.setTransform(this.#ratio, 0, 0, this.#ratio, 0, 0);
    context.clearRect(0, 0, size.x, size.y);
    return context;
  }

  #resize(size) {
    this.#size = size;
    this.#ratio = devicePixelRatio;
    this.#canvas.width = size.x * this.#ratio;
    this.#canvas.height = size.y * this.#ratio;
    this.#canvas.style.width = `${size.x}px`;
    this.#canvas.style.height = `${size.y}px`;
  }
}

/** The pixels of a position on a map. Leaflet computes them too, but much more slowly for thousands. */
function pointOn(map) {
  const scale = map.options.crs.scale(map.getZoom());
  const corner = map.getPixelOrigin().subtract(map._getMapPanePos());
  return ([lat, lng]) => ({ x: scale * lng - corner.x, y: -scale * lat - corner.y });
}
