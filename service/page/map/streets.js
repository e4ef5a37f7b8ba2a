/** Draw streets on one canvas, below the tours. */

import { colour } from "../common/colours.js";
import { CanvasLayer } from "./canvas_layer.js";

// From small to large streets, so that large ones are on top. Widths are pixels, on a map this wide.
const KINDS = { path: ["line", 1], side: ["edge", 1.5], main: ["edge", 3.5] };
const WIDE = 600;

export class Streets extends CanvasLayer {
  #kinds = [];

  constructor() {
    super("streets", "streets");
  }

  /** Draws streets as `/examples` has them, at what `latlng` makes of their places; null takes them away. */
  show(streets, latlng) {
    const drawn = streets ? Object.keys(KINDS).flatMap((kind) => streets[kind].map((row) => [kind, row])) : [];
    this.#kinds = drawn.map(([kind]) => kind);
    this.lines = drawn.map(([, row]) => placesAlong(row, streets).map(latlng));
    this.redraw();
  }

  paint(context, lines) {
    const share = Math.min(1, this._map.getSize().x / WIDE);
    context.lineCap = context.lineJoin = "round";
    for (const [kind, [name, width]] of Object.entries(KINDS)) {
      context.strokeStyle = colour(name);
      context.lineWidth = width * share;
      context.beginPath();
      lines.forEach((places, at) => this.#kinds[at] === kind && trace(context, places));
      context.stroke();
    }
  }
}

/** Longitude and latitude of each place of a line; each place is stored relative to the one before. */
function placesAlong(row, { origin, step }) {
  const at = [0, 0];
  return Array.from({ length: row.length / 2 }, (_, place) => {
    for (const axis of [0, 1]) at[axis] += row[2 * place + axis];
    return at.map((steps, axis) => origin[axis] + step * steps);
  });
}

function trace(context, [first, ...others]) {
  context.moveTo(first.x, first.y);
  for (const { x, y } of others) context.lineTo(x, y);
}
