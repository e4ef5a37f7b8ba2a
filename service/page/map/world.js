/** Draw coasts, lakes, borders and towns below the tours, where there is no other map. */

import "../vendor/leaflet/leaflet.js";
import { colour } from "../common/colours.js";
import { CanvasLayer } from "./canvas_layer.js";
import { readWorld } from "./world_file.js";

const { L } = globalThis;

const FILE = new URL("world.bin", import.meta.url);
const BESIDE = 0.1; // of the map's size, drawn beyond its edges, where the cuts of the coasts lie
const MOST_TOWNS = 40;
const TEXT = 12; // pixels
const DOT = 2;

let read = null; // the world, once it is asked for

const world = () => (read ??= fetch(FILE).then((file) => file.arrayBuffer()).then(readWorld));

export class World extends CanvasLayer {
  #layers = null; // once the file is read
  #towns = [];
  #shown = false;
  #widths = new Map();

  constructor() {
    super("world", "streets");
  }

  /** Draws the world at what `latlng` makes of its places, as soon as it is there; the map is good without. */
  async show(latlng) {
    this.#shown = true;
    const found = await world().catch(() => null);
    if (!found || !this.#shown) return;
    const placed = (lines) => lines.map((line) => boxed(line.map(latlng)));
    this.#layers ??= { land: placed(found.land), lakes: placed(found.lakes), borders: placed(found.borders) };
    this.#towns = found.towns.map(({ name, at }) => ({ name, at: latlng(at) }));
    this.lines = [[[0, 0]]];
    this.redraw();
  }

  hide() {
    this.#shown = false;
    this.lines = [];
    this.redraw();
  }

  paint(context) {
    const { x, y } = this._map.getSize();
    const view = this._map.getBounds().pad(BESIDE);
    const box = L.bounds([view.getWest(), view.getSouth()], [view.getEast(), view.getNorth()]);
    const area = (layer, fill) => {
      context.beginPath();
      for (const { points, bounds } of layer) if (bounds.intersects(box)) this.#trace(context, L.PolyUtil.clipPolygon(points, box));
      context.fillStyle = colour(fill);
      context.fill("evenodd");
      context.stroke();
    };
    context.fillStyle = colour("water");
    context.fillRect(0, 0, x, y);
    context.strokeStyle = colour("edge");
    context.lineWidth = 1;
    area(this.#layers.land, "ground");
    area(this.#layers.lakes, "water");
    context.beginPath();
    for (const { points, bounds } of this.#layers.borders) if (bounds.intersects(box)) this.#segments(context, points, box);
    context.setLineDash([6, 3]);
    context.strokeStyle = colour("alone");
    context.stroke();
    context.setLineDash([]);
    this.#name(context, x);
  }

  #trace(context, points) {
    points.forEach((point, at) => {
      const { x, y } = this.pixels([point.y, point.x]);
      if (at) context.lineTo(x, y);
      else context.moveTo(x, y);
    });
    context.closePath();
  }

  /** The parts of a line that are seen: far away parts have pixels that a canvas rounds. */
  #segments(context, points, box) {
    for (let at = 1; at < points.length; at++) {
      const seen = L.LineUtil.clipSegment(points[at - 1], points[at], box, false);
      if (!seen) continue;
      const [from, to] = seen.map(({ x, y }) => this.pixels([y, x]));
      context.moveTo(from.x, from.y);
      context.lineTo(to.x, to.y);
    }
  }

  /** Names the largest towns in view whose names have room. */
  #name(context, width) {
    const view = this._map.getBounds();
    const taken = [];
    context.font = `${TEXT}px system-ui, sans-serif`;
    context.textBaseline = "middle";
    context.lineWidth = 3;
    context.strokeStyle = colour("ground");
    context.fillStyle = colour("quiet");
    for (const { name, at } of this.#towns) {
      if (!view.contains(at)) continue;
      const { x, y } = this.pixels(at);
      const box = L.bounds([x - DOT, y - TEXT / 2], [x + 2 * TEXT + this.#widthOf(context, name), y + TEXT / 2]);
      if (box.max.x > width || taken.some((other) => other.intersects(box))) continue;
      context.beginPath();
      context.arc(x, y, DOT, 0, 2 * Math.PI);
      context.fill();
      context.strokeText(name, x + 3 * DOT, y);
      context.fillText(name, x + 3 * DOT, y);
      if (taken.push(box) === MOST_TOWNS) return;
    }
  }

  #widthOf(context, name) {
    if (!this.#widths.has(name)) this.#widths.set(name, context.measureText(name).width);
    return this.#widths.get(name);
  }
}

/** A line on the map, and the box that it lies in. */
function boxed(latlngs) {
  const points = latlngs.map(([lat, lng]) => L.point(lng, lat));
  return { points, bounds: L.bounds(points) };
}
