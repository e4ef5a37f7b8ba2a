/** The parts of a picture's panels, in SVG; and a map as a panel: its ground, lines, places, and the names of routes. */

import { colour } from "../common/colours.js";

export const SIDE = 420; // units of each panel's width and height

const ROOM = 40; // units beside the map
const [NAMES, ACROSS, MOST_LETTERS] = [8, 4, 12]; // the list of names: how many, how many in a line, and their length

/** A map whose longer side fills its panel; north, or the larger y, is up. A grid's ground is a picture of its cells. */
export function mapPanel({ title, places, lines, starts, ground }) {
  const held = ground ? [[0, -ground.height], [ground.width, 0]] : [...places, ...lines.flatMap((line) => line.places)];
  const [left, low, right, top] = boundsOf(held);
  const unit = (SIDE - 2 * ROOM) / (Math.max(right - left, top - low) || 1);
  const put = ([x, y]) => [round(ROOM + (x - left) * unit), round(SIDE - ROOM - (y - low) * unit)];
  const image = ground ? imageOf(ground, put([left, top]), unit) : "";
  const dots = places.map((place) => dot(put(place), 2.5, "ink"));
  const discs = starts.map(({ place, colour: name }) => dot(put(place), 6, name));
  const drawn = lines.map((line) => lineOf(line, put));
  return `${text(ROOM, 22, title, { size: 12 })}${image}${drawn.join("")}${dots.join("")}${discs.join("")}${namesOf(lines)}`;
}

function boundsOf(places) {
  const [xs, ys] = [0, 1].map((axis) => places.map((place) => place[axis]));
  return [Math.min(...xs), Math.min(...ys), Math.max(...xs), Math.max(...ys)];
}

const imageOf = ({ href, width, height }, [x, y], unit) =>
  `<image href="${href}" x="${x}" y="${y}" width="${round(width * unit)}" height="${round(height * unit)}" preserveAspectRatio="none" style="image-rendering:pixelated"/>`;

/** A line, on a darker one if it is cased: some of the colours alone are too pale on the map. */
function lineOf({ places, colour: name, dash, cased }, put) {
  const through = `M${places.map((place) => put(place).join(" ")).join("L")}`;
  return `${cased ? stroke(through, "ink", 4, dash) : ""}${stroke(through, name, cased ? 2.5 : 2, dash)}`;
}

const stroke = (through, name, width, dash) =>
  `<path d="${through}" fill="none" stroke-width="${width}" stroke-linejoin="round" stroke="${colour(name)}"${dash.length ? ` stroke-dasharray="${dash.join(" ")}"` : ""}/>`;

/** The names of the first routes beside their colours, below the map. */
function namesOf(lines) {
  const named = lines.filter(({ name }) => name).slice(0, NAMES);
  return named.map((line, at) => {
    const x = ROOM + ((SIDE - 2 * ROOM) / ACROSS) * (at % ACROSS);
    const y = SIDE - ROOM + 20 + 14 * Math.floor(at / ACROSS);
    const said = line.name.length > MOST_LETTERS ? `${line.name.slice(0, MOST_LETTERS - 1)}…` : line.name;
    return `${lineOf({ ...line, places: [[x, y], [x + 14, y]] }, (place) => place)}${text(x + 18, y + 3, said, { size: 9 })}`;
  }).join("");
}

export const round = (value) => Number(value.toFixed(2));

export const dot = ([x, y], radius, name) => `<circle cx="${x}" cy="${y}" r="${radius}" fill="${colour(name)}"/>`;

export function text(x, y, said, { size, weight = 400, anchor = "start" }) {
  return `<text x="${x}" y="${y}" font-size="${size}" font-weight="${weight}" text-anchor="${anchor}" fill="${colour("ink")}">${escaped(said)}</text>`;
}

const escaped = (said) => said.replace(/[&<>]/g, (each) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;" })[each]);
