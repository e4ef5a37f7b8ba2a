/** Marks below a slider where the tours of a front are. */

import { svgElement } from "../common/elements.js";

const [WIDE, HIGH] = [1000, 6]; // of the drawing, which is stretched to the slider's width

/** A drawing of marks, to be put below a slider; `markAt` draws them. */
export function ticks() {
  const drawing = svgElement("svg", { class: "ticks", viewBox: `0 0 ${WIDE} ${HIGH}`, preserveAspectRatio: "none", "aria-hidden": true });
  drawing.append(svgElement("path"));
  return drawing;
}

/** Draws a mark at each of these shares of the slider's length, from 0 to 1. */
export function markAt(drawing, shares) {
  drawing.firstChild.setAttribute("d", [...new Set(shares.map((share) => Math.round(share * WIDE)))].map((x) => `M${x} 0v${HIGH}`).join(""));
}
