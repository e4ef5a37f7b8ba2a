/** One vehicle's lane over time: a line while it is under way, boxes of waiting and of visits. */

import { routeStyle } from "./route_styles.js";
import { svgElement } from "./svg.js";

export const LANE = 34; // pixels of height; the name takes the upper half
const [NAME, BAR] = [17, 12]; // pixels: where the bar begins, and its height
const [CASING, LINE, LEAST] = [5, 3, 2]; // pixels: the line's widths, and the least of a box

/**
 * The elements of the lane at this place from the top.
 *
 * @param {{ name: string, visits: { stop: string, arrival: number, begin: number, end: number }[] }} lane
 * @param {{ left: number, top: number, place: (time: number) => number, said: (time: number) => string }} axis
 */
export function laneElements({ name, visits }, at, { left, top, place, said }) {
  const y = top + LANE * at;
  const style = routeStyle(at);
  const line = { d: `M${place(visits[0].arrival)} ${y + NAME + BAR / 2}H${place(visits.at(-1).end)}`, "stroke-dasharray": style.dash.join(" ") };
  const box = (kind, from, to, what, fill) => {
    const width = Math.max(place(to) - place(from), LEAST);
    const made = svgElement("rect", { x: place(from), y: y + NAME, width, height: BAR, class: kind, fill });
    made.append(svgElement("title", {}, `${what}, ${said(from)} to ${said(to)}`));
    return made;
  };
  return [
    svgElement("text", { x: left, y: y + NAME - 5, class: "name" }, name),
    svgElement("path", { ...line, stroke: "var(--ink)", "stroke-width": CASING }),
    svgElement("path", { ...line, stroke: `var(--${style.colour})`, "stroke-width": LINE }),
    ...visits
      .filter(({ arrival, begin }) => begin > arrival)
      .map(({ stop, arrival, begin }) => box("wait", arrival, begin, `waits for ${stop}`, "var(--card)")),
    ...visits.map(({ stop, begin, end }) => box("visit", begin, end, stop, `var(--${style.colour})`)),
  ];
}
