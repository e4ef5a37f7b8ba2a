/** One picture of what is on the screen, as SVG or PNG: the front, and the selected tour on its maps. */

import { colour } from "../common/colours.js";
import { length } from "../common/numbers.js";
import { withUnit } from "../common/objectives.js";

const SIDE = 420; // units of each panel's width and height
const MARGIN = { left: 70, right: 20, top: 40, bottom: 50 };
const TICKS = 4;
const FONT = "system-ui, sans-serif";

/**
 * The picture as the text of an SVG. `maps` are `{ title, places, tours }`: places are pairs or null,
 * and each of the tours is `{ cities, dashed }`.
 */
export function svgOf({ front, selected, choice, objectives, maps }) {
  const panels = [chart(front, selected, objectives), ...maps.filter(({ places }) => places.length).map(mapOf)];
  const width = SIDE * panels.length;
  const placed = panels.map((panel, at) => `<g transform="translate(${at * SIDE} 30)">${panel}</g>`);
  const title = text(MARGIN.left, 24, choice, { size: 15, weight: 600 });
  return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${SIDE + 30}" width="${width}" height="${SIDE + 30}" font-family="${FONT}"><rect width="100%" height="100%" fill="${colour("card")}"/>${title}${placed.join("")}</svg>`;
}

/** The same as a PNG, with two of its pixels to each unit. */
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
  const place = ({ lengths }) => lengths.map((value, axis) => scales[axis].at(value));
  const places = front.map(place);
  const steps = places.map(([x, y], at) => (at ? `H${x}V${y}` : `M${x} ${y}`)).join("");
  const axes = objectives.map((objective, axis) => axisOf(scales[axis], axis, withUnit(objective))).join("");
  const dots = places.map((at) => dot(at, 2.5, "improved")).join("");
  return `${axes}<path d="${steps}" fill="none" stroke="${colour("improved")}" stroke-width="1.5"/>${dots}${dot(place(selected), 6, "selected")}`;
}

function scaleOf(values, axis) {
  const [least, most] = [Math.min(...values), Math.max(...values)];
  const from = axis ? SIDE - MARGIN.bottom : MARGIN.left;
  const to = axis ? MARGIN.top : SIDE - MARGIN.right;
  return { least, most, at: (value) => round(from + ((value - least) / (most - least || 1)) * (to - from)) };
}

function axisOf({ least, most, at }, axis, title) {
  const values = Array.from({ length: TICKS + 1 }, (_, tick) => least + ((most - least) * tick) / TICKS);
  const said = (value) => length(Number(value.toPrecision(4)));
  if (axis) {
    const ticks = values.map((value) => text(MARGIN.left - 8, at(value) + 4, said(value), { size: 11, anchor: "end" }));
    return ticks.join("") + text(MARGIN.left, MARGIN.top - 18, title, { size: 12 });
  }
  const ticks = values.map((value) => text(at(value), SIDE - MARGIN.bottom + 18, said(value), { size: 11, anchor: "middle" }));
  return ticks.join("") + text(SIDE / 2, SIDE - 10, title, { size: 12, anchor: "middle" });
}

/** A map whose longer side fills its panel; north, or the larger y, is up. */
function mapOf({ title, places, tours }) {
  const there = places.filter(Boolean);
  const [xs, ys] = [0, 1].map((axis) => there.map((place) => place[axis]));
  const [left, low] = [Math.min(...xs), Math.min(...ys)];
  const unit = (SIDE - 80) / (Math.max(Math.max(...xs) - left, Math.max(...ys) - low) || 1);
  const put = ([x, y]) => [round(40 + (x - left) * unit), round(SIDE - 40 - (y - low) * unit)];
  const lines = tours.map(({ cities, dashed }) => {
    const through = cities.map((city) => put(places[city]).join(" ")).join("L");
    const style = dashed ? `stroke="${colour("pinned")}" stroke-dasharray="5 5"` : `stroke="${colour("selected")}"`;
    return `<path d="M${through}" fill="none" stroke-width="2" ${style}/>`;
  });
  const dots = there.map((place) => dot(put(place), 2.5, "ink"));
  const start = tours.at(-1)?.cities[0];
  const ring = start === undefined ? "" : dot(put(places[start]), 6, "selected");
  return `${text(40, 22, title, { size: 12 })}${lines.join("")}${dots.join("")}${ring}`;
}

const round = (value) => Number(value.toFixed(2));
const dot = ([x, y], radius, name) => `<circle cx="${x}" cy="${y}" r="${radius}" fill="${colour(name)}"/>`;
const escaped = (said) => said.replace(/[&<>]/g, (each) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;" })[each]);

function text(x, y, said, { size, weight = 400, anchor = "start" }) {
  return `<text x="${x}" y="${y}" font-size="${size}" font-weight="${weight}" text-anchor="${anchor}" fill="${colour("ink")}">${escaped(said)}</text>`;
}
