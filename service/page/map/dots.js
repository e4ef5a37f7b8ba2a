/** Draw stops as dots on one canvas, however many there are. */

import { colour } from "../common/colours.js";
import { CanvasLayer } from "./canvas_layer.js";

const [RADIUS, SIDE] = [3.5, 3]; // pixels: of a disc, and of the square that stands for one in a crowd

export class Dots extends CanvasLayer {
  #crowded = false;

  constructor() {
    super("dots", "stops");
  }

  /** Draws a dot at each place, a small one where they are crowded. */
  show(latlngs, crowded) {
    this.lines = [latlngs];
    this.#crowded = crowded;
    this.redraw();
  }

  /** Where the dots stand on the map, in pixels. */
  get points() {
    return this.placed[0] ?? [];
  }

  /** Draws one of them at another place. */
  move(at, latlng) {
    this.lines = [this.lines[0].with(at, latlng)];
    this.redraw();
  }

  paint(context, [places]) {
    context.fillStyle = colour("ink");
    for (const { x, y } of places) {
      if (this.#crowded) context.fillRect(x - SIDE / 2, y - SIDE / 2, SIDE, SIDE);
      else disc(context, x, y);
    }
  }
}

function disc(context, x, y) {
  context.beginPath();
  context.arc(x, y, RADIUS, 0, 2 * Math.PI);
  context.fill();
}
