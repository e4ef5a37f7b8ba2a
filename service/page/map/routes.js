/** Draw the routes of a plan on one canvas, each in the colour and dash of its vehicle. */

import { colour } from "../common/colours.js";
import { drawArrows } from "./arrows.js";
import { CanvasLayer } from "./canvas_layer.js";

// Pixels of a line and of its darker edge: some of the colours alone are too pale on the map.
const CASING = 1.5;
const [LINE, THIN] = [3, 2];
const NARROW = 400; // of a map, as on a phone
const [START, END] = [6, 10]; // the radius of a disc, and the side of a square

export class Routes extends CanvasLayer {
  #styles = [];
  #marked = false;

  constructor(name = "routes") {
    super(name);
  }

  /**
   * Draws routes, each `{ latlngs, style }`, maybe `along` streets, maybe `marked` with a disc where each starts; open ones have a square
   * where they end, or a disc if their style has a `tip`, in that colour; null for none. No routes takes them away.
   */
  show(routes, marked = false) {
    this.#marked = marked;
    this.lines = routes.map(({ latlngs }) => latlngs);
    this.#styles = routes.map(({ style, along }) => ({ ...style, along }));
    this.redraw();
  }

  paint(context, lines) {
    context.lineJoin = "round";
    const width = this._map.getSize().x < NARROW ? THIN : LINE;
    lines.forEach((places, at) => draw(context, places, this.#styles[at], width));
    lines.forEach((places, at) => places.length && this.#mark(context, places, this.#styles[at]));
  }

  #mark(context, places, style) {
    const [start, end] = [places[0], places.at(-1)];
    if (this.#marked) fill(context, style, () => context.arc(start.x, start.y, START, 0, 2 * Math.PI));
    if (style.tip !== undefined) return style.tip && fill(context, { ...style, colour: style.tip }, () => context.arc(end.x, end.y, START, 0, 2 * Math.PI));
    if (start.x !== end.x || start.y !== end.y) fill(context, style, () => context.rect(end.x - END / 2, end.y - END / 2, END, END));
  }
}

function draw(context, places, style, width) {
  context.setLineDash(style.dash);
  context.beginPath();
  for (const { x, y } of places) context.lineTo(x, y);
  stroke(context, "ink", width + CASING);
  stroke(context, style.colour, width);
  context.fillStyle = colour("ink");
  drawArrows(context, places, style.along);
}

function fill(context, style, trace) {
  context.setLineDash([]);
  context.beginPath();
  trace();
  context.fillStyle = colour(style.colour);
  context.fill();
  stroke(context, "ink", CASING);
}

function stroke(context, name, width) {
  context.strokeStyle = colour(name);
  context.lineWidth = width;
  context.stroke();
}
