/** The parts of a picture's panels: dots and texts in SVG, and the size of a panel. */

import { colour } from "../common/colours.js";

export const SIDE = 420; // units of each panel's width and height

export const round = (value) => Number(value.toFixed(2));

export const dot = ([x, y], radius, name) => `<circle cx="${x}" cy="${y}" r="${radius}" fill="${colour(name)}"/>`;

export function text(x, y, said, { size, weight = 400, anchor = "start" }) {
  return `<text x="${x}" y="${y}" font-size="${size}" font-weight="${weight}" text-anchor="${anchor}" fill="${colour("ink")}">${escaped(said)}</text>`;
}

const escaped = (said) => said.replace(/[&<>]/g, (each) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;" })[each]);
