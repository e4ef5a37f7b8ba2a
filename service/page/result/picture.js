/** One picture of what is on the screen, as SVG or PNG: the front, and the selected tour or plan on its maps. */

import { colour } from "../common/colours.js";
import { axisOf, ticksOf } from "../common/axes.js";
import { mapPanel } from "./picture_map.js";
import { SIDE, dot, round, text } from "./picture_parts.js";

const MARGIN = { left: 70, right: 20, top: 40, bottom: 50 };
const TICKS = 4;
const WIDTH = 0.62; // the width of a bold letter, relative to its size
const FONT = "system-ui, sans-serif";

/**
 * The picture as the text of an SVG. `maps` are `{ title, places, lines, starts, ground }`: places are
 * pairs of x and y, each line is `{ places, colour, dash, cased, name }`, and each start `{ place, colour }`.
 */
export function svgOf({ front, selected, choice, objectives, maps }) {
  const panels = [chart(front, selected, objectives), ...maps.filter(({ places }) => places.length).map(mapPanel)];
  const width = SIDE * panels.length;
  const placed = panels.map((panel, at) => `<g transform="translate(${at * SIDE} 30)">${panel}</g>`);
  const title = text(MARGIN.left, 24, choice, { size: Math.min(15, (width - MARGIN.left - MARGIN.right) / (WIDTH * choice.length)), weight: 600 });
  return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${SIDE + 30}" width="${width}" height="${SIDE + 30}" font-family="${FONT}"><rect width="100%" height="100%" fill="${colour("card")}"/>${title}${placed.join("")}</svg>`;
}

/** The same as a PNG, with two pixels per unit. */
export async function pngOf(svg) {
  const image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(svg)}`;
  await image.decode();
  const canvas = Object.assign(document.createElement("canvas"), { width: 2 * image.width, height: 2 * image.height });
  canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
  return new Promise((done) => canvas.toBlob(done, "image/png"));
}

function chart(front, selected, objectives) {
  const scales = [0, 1].map((axis) => scaleOf(front.map(({ lengths }) => lengths[axis]), axis));
  const place = ({ lengths }) => scales.map((scale, axis) => scale.at(lengths[axis]));
  const places = front.map(place);
  // The plane of the first two of several objectives has no staircase: tours above it may be better under the others.
  const steps = objectives.length > 2 ? "" : places.map(([x, y], at) => (at ? `H${x}V${y}` : `M${x} ${y}`)).join("");
  const axes = scales.map((scale, axis) => drawnAxis(scale, axis, objectives[axis])).join("");
  const dots = places.map((at) => dot(at, 2.5, "improved")).join("");
  return `${axes}<path d="${steps}" fill="none" stroke="${colour("improved")}" stroke-width="1.5"/>${dots}${dot(place(selected), 6, "selected")}`;
}

function scaleOf(values, axis) {
  const [least, most] = [Math.min(...values), Math.max(...values)];
  const from = axis ? SIDE - MARGIN.bottom : MARGIN.left;
  const to = axis ? MARGIN.top : SIDE - MARGIN.right;
  return { least, most, at: (value) => round(from + ((value - least) / (most - least || 1)) * (to - from)) };
}

function drawnAxis({ least, most, at }, axis, objective) {
  const { title, said, ...suited } = axisOf(objective);
  const { values, step } = ticksOf(suited, least, most, TICKS);
  if (axis) {
    const ticks = values.map((value) => text(MARGIN.left - 8, at(value) + 4, said(value, step), { size: 11, anchor: "end" }));
    return ticks.join("") + text(MARGIN.left, MARGIN.top - 18, title, { size: 12 });
  }
  const ticks = values.map((value) => text(at(value), SIDE - MARGIN.bottom + 18, said(value, step), { size: 11, anchor: "middle" }));
  return ticks.join("") + text(SIDE / 2, SIDE - 10, title, { size: 12, anchor: "middle" });
}
