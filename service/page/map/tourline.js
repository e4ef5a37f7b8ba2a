/** Draw a tour on a canvas of its own, so that choosing another tour redraws nothing else. */

import "../vendor/leaflet/leaflet.js";
import { colour, onSchemeChange } from "../common/colours.js";

const { L } = globalThis;

// To fill wide lines is most of a frame where there is no graphics processor, and of hundreds of
// cities narrow ones are clearer anyway.
const MANY = 150;
const [WIDE, NARROW] = [2, 1]; // pixels
const MOST_ARROWS = 60;
const [ARROW, ROOM] = [5, 22]; // pixels: an arrowhead's length, and the least of a leg that has one

export class TourLine extends L.Layer {
  #name;
  #dash;
  #canvas = document.createElement("canvas");
  #latlngs = [];
  #size = null;
  #ratio = 1; // of the screen's pixels to the map's

  /**
   * @param {string} name of its colour, and of its class
   * @param {number[]} dash as a canvas takes it; lines without one have arrowheads
   */
  constructor(name, dash = []) {
    super();
    L.setOptions(this, { pane: "tours" });
    this.#name = name;
    this.#dash = dash;
    this.#canvas.className = `tour ${name}`;
    onSchemeChange(() => this.#draw());
  }

  onAdd(map) {
    this.getPane().append(this.#canvas);
    map.on("move zoom viewreset resize", this.#draw, this);
    this.#draw();
  }

  /** Draws a line through these; none takes it away. */
  show(latlngs) {
    this.#latlngs = latlngs;
    this.#draw();
  }

  #draw() {
    this.#canvas.hidden = !this.#latlngs.length;
    if (this.#canvas.hidden) return;
    const context = this.#cleared();
    context.strokeStyle = colour(this.#name);
    context.lineWidth = this.#latlngs.length > MANY ? NARROW : WIDE;
    context.lineJoin = "round";
    context.setLineDash(this.#dash);
    context.beginPath();
    const places = this.#latlngs.map((latlng) => this._map.latLngToContainerPoint(latlng));
    for (const { x, y } of places) context.lineTo(x, y);
    context.stroke();
    if (!this.#dash.length) this.#point(context, places);
  }

  /** Draws arrowheads on legs that have room for one, on some of them where they are many. */
  #point(context, places) {
    context.fillStyle = context.strokeStyle;
    const apart = Math.ceil(places.length / MOST_ARROWS);
    for (let at = apart; at < places.length; at += apart) arrow(context, places[at - 1], places[at]);
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

/** An arrowhead in the middle of a leg. */
function arrow(context, from, to) {
  const [x, y] = [to.x - from.x, to.y - from.y];
  const long = Math.hypot(x, y);
  if (long < ROOM) return;
  const [east, south] = [(ARROW * x) / long, (ARROW * y) / long];
  const [middleX, middleY] = [(from.x + to.x) / 2, (from.y + to.y) / 2];
  context.beginPath();
  context.moveTo(middleX + east, middleY + south);
  context.lineTo(middleX - east - 0.7 * south, middleY - south + 0.7 * east);
  context.lineTo(middleX - east + 0.7 * south, middleY - south - 0.7 * east);
  context.fill();
}
