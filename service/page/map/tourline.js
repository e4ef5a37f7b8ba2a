/** Draw a tour on its own canvas, so that choosing another tour redraws nothing else. */

import { colour } from "../common/colours.js";
import { drawArrows } from "./arrows.js";
import { CanvasLayer } from "./canvas_layer.js";

// Without a graphics processor, filling wide lines takes most of a frame; and for hundreds of cities narrow lines are
// clearer anyway.
const MANY = 150;
const [WIDE, NARROW] = [2, 1]; // pixels

export class TourLine extends CanvasLayer {
  #name;
  #dash;
  #along = false;

  /**
   * @param {string} name the name of its colour and of its class
   * @param {number[]} dash as a canvas takes it; lines without one have arrowheads
   */
  constructor(name, dash = []) {
    super(name);
    this.#name = name;
    this.#dash = dash;
  }

  /** Draws a line through these positions, maybe along streets; without positions, removes it. */
  show(latlngs, along = false) {
    this.lines = [latlngs];
    this.#along = along;
    this.redraw();
  }

  paint(context, [places]) {
    context.strokeStyle = context.fillStyle = colour(this.#name);
    context.lineWidth = places.length > MANY && !this.#along ? NARROW : WIDE;
    context.lineJoin = "round";
    context.setLineDash(this.#dash);
    context.beginPath();
    for (const { x, y } of places) context.lineTo(x, y);
    context.stroke();
    if (!this.#dash.length) drawArrows(context, places, this.#along);
  }
}
