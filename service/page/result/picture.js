/** One picture of what is on the screen, as SVG or PNG: the front, and the selected tour or plan on its maps. */

import { colour } from "../common/colours.js";
import { amount } from "../common/amounts.js";
import { axisOf, ticksOf } from "../common/axes.js";
import { SIDE, dot, mapPanel, round, text } from "./picture_map.js";

const MARGIN = { left: 70, right: 20, top: 40, bottom: 50 };
const TICKS = 4;
const WIDTH = 0.62; // the width of a bold letter, relative to its size
const FONT = "system-ui, sans-serif";

/**
 * The picture as the text of an SVG. `limits` are the most of each objective, null where there is none. `maps` are `{ title, places, lines, starts, ground }`: places are
 * pairs of x and y, each line is `{ places, colour, dash, cased, name }`, and each start `{ place, colour }`.
 */
export function svgOf({ front, selected, choice, objectives, limits, maps }) {
  const panels = [chart(front, selected, objectives, limits), ...maps.filter(({ places }) => places.length).map(mapPanel)];
  const width = SIDE * panels.length;
  const placed = panels.map((panel, at) => `<g transform="translate(${at * SIDE} 30)">${panel}</g>`);
  const title = text(MARGIN.left, 24, choice, { size: sizeOf(choice, 15, width), weight: 600 });
  return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${SIDE + 30}" width="${width}" height="${SIDE + 30}" font-family="${FONT}"><rect width="100%" height="100%" fill="${colour("card")}"/>${title}${placed.join("")}</svg>`;
}

/** The size of letters with which a text fits, at most that. */
const sizeOf = (said, most, width) => Math.min(most, (width - MARGIN.left - MARGIN.right) / (WIDTH * said.length));

/** The same as a PNG, with two pixels per unit. */
export async function pngOf(svg) {
  const image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(svg)}`;
  await image.decode();
  const canvas = Object.assign(document.createElement("canvas"), { width: 2 * image.width, height: 2 * image.height });
  canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
  return new Promise((done) => canvas.toBlob(done, "image/png"));
}

function chart(front, selected, objectives, limits) {
  const scales = [0, 1].map((axis) => scaleOf(front.map(({ lengths }) => lengths[axis]), axis));
  const place = ({ lengths }) => scales.map((scale, axis) => scale.at(lengths[axis]));
  const places = front.map(place);
  const drawnLimits = limits.slice(0, 2).map((most, axis) => (most === null ? "" : limitAt(scales[axis].at(most), axis)));
  // The plane of the first two of several objectives has no staircase: tours above it may be better under the others.
  const steps = objectives.length > 2 ? "" : places.map(([x, y], at) => (at ? `H${x}V${y}` : `M${x} ${y}`)).join("");
  const axes = scales.map((scale, axis) => drawnAxis(scale, axis, objectives[axis])).join("");
  const isBeyond = ({ lengths }) => objectives.length > 2 && limits.some((most, axis) => most !== null && lengths[axis] > most);
  const dots = places.map((at, index) => dot(at, 2.5, isBeyond(front[index]) ? "edge" : "improved")).join("");
  return `${axes}<path d="${steps}" fill="none" stroke="${colour("improved")}" stroke-width="1.5"/>${drawnLimits.join("")}${saidOf(limits, objectives)}${dots}${dot(place(selected), 6, "selected")}`;
}

/** A dashed line across the chart. */
function limitAt(at, axis) {
  const [x1, y1, x2, y2] = axis ? [MARGIN.left, at, SIDE - MARGIN.right, at] : [at, MARGIN.top, at, SIDE - MARGIN.bottom];
  return `<line x1="${x1}" y1="${y1}" x2="${x2}" y2="${y2}" stroke="${colour("accent")}" stroke-width="1.5" stroke-dasharray="5 4"/>`;
}

/** The limits in words, above the chart. */
function saidOf(limits, objectives) {
  const said = limits.flatMap((most, axis) => (most === null ? [] : [`${objectives[axis].name} ≤ ${amount(most, objectives[axis])}`])).join(", ");
  return said && text(SIDE - MARGIN.right, MARGIN.top - 4, said, { size: sizeOf(said, 11, SIDE), anchor: "end" });
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
