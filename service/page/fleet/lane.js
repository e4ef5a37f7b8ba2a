/** One vehicle's lane over time: a line while it is under way, and what it does at each stop. */

import { svgElement } from "../common/elements.js";
import { withCustomer } from "../inputs/details.js";
import { departureNote, limitsOf } from "./visit_sentence.js";

export const LANE = 42; // pixels of height; the name takes the upper half
const [NAME, BAR] = [17, 12]; // pixels: where the bar begins, and its height
const [CASING, LINE, LEAST] = [5, 3, 2]; // pixels: the line's widths, and the least of a box
const [DELAY, OPEN] = [5, 9]; // pixels below the bar: the line of a delay, and of windows
export const LATE = "late-stripes"; // the pattern of what is late

/**
 * The elements of the lane at this place from the top. Each stop is a button, `g.stop`.
 *
 * @param {{ name: string, style: object, visits: object[] }} lane what its vehicle does at each stop, by `visitTimes`
 * @param {{ left: number, top: number, place: (time: number) => number, said: (time: number) => string, lasting: (time: number) => string }} axis
 */
export function laneElements({ name, style, visits }, at, { left, top, place, said, lasting }) {
  const y = top + LANE * at;
  const note = departureNote(visits, said);
  const line = { d: `M${place(visits[0].arrival)} ${y + NAME + BAR / 2}H${place(visits.at(-1).leaves)}`, "stroke-dasharray": style.dash.join(" ") };
  const box = (kind, from, to, fill) => {
    const width = Math.max(place(to) - place(from), LEAST);
    return svgElement("rect", { x: place(from), y: y + NAME, width, height: BAR, class: kind, fill });
  };
  const stopOf = (visit, order) => {
    const { stop, customer, kind, arrival, begin, end, waiting, due, late, closing } = visit;
    const times = [`${said(begin)}${end > begin ? ` to ${said(end)}` : ""}`, ...(late ? [`${lasting(late)} late`] : []), ...limitsOf(visit, said), ...(closing ? [closing] : [])];
    const label = `${name}, ${withCustomer(stop, customer)}${DOES[kind]}, ${times.join(", ")}`;
    const made = svgElement("g", { class: "stop", role: "button", tabindex: -1, "aria-label": label, "aria-pressed": false, "data-lane": at, "data-at": order });
    const x = place(begin);
    if (waiting) made.append(box("wait", arrival, begin, "var(--card)"));
    if (kind === "loading") made.append(svgElement("path", { d: diamond(x, y + NAME + BAR / 2), class: "visit loading" }));
    else made.append(box("visit", begin, end, `var(--${style.colour})`));
    if (late) made.append(...delay(place(due), Math.max(x, place(due) + LEAST), y + NAME + BAR));
    if (closing) made.append(svgElement("path", { d: hourglass(x, y + NAME + BAR + 1), class: "tight" }));
    made.append(svgElement("title", {}, note && !order ? `${label}. ${note}` : label));
    return made;
  };
  const named = svgElement("g");
  named.append(svgElement("text", { x: left, y: y + NAME - 5, class: "name" }, name));
  if (note) named.append(svgElement("title", {}, note));
  return [
    named,
    svgElement("path", { ...line, stroke: "var(--ink)", "stroke-width": CASING }),
    svgElement("path", { ...line, stroke: `var(--${style.colour})`, "stroke-width": LINE }),
    ...visits.map(stopOf),
  ];
}

const DOES = { start: ": sets off", loading: ": loads again", end: ": is back", visit: "" };

/** The windows of a visit in the lane at this place, as brackets below its bar. */
export function windowElements({ windows }, at, { top, place, from, to }) {
  const y = top + LANE * at + NAME + BAR + OPEN;
  const seen = windows.filter(([opens, closes]) => closes >= from && opens <= to);
  return seen.map(([opens, closes]) => {
    const sides = [opens < from ? "" : "v-4", closes > to ? "" : "v-4"];
    const [left, right] = [place(Math.max(opens, from)), place(Math.min(closes, to))];
    return svgElement("path", { class: "window", d: `M${left} ${y}${sides[0]}M${left} ${y}H${right}${sides[1]}` });
  });
}

const diamond = (x, y) => `M${x} ${y - 8}l6 8l-6 8l-6 -8z`;
const hourglass = (x, y) => `M${x - 3} ${y}h7l-7 8h7z`;

/** A striped line below the bar, from when a visit was due to when it begins. */
function delay(from, to, y) {
  return [
    svgElement("rect", { x: from, y: y + 2, width: to - from, height: DELAY, class: "late", fill: `url(#${LATE})` }),
    svgElement("path", { d: `M${from} ${y - 3}v${DELAY + 6}`, class: "due" }),
  ];
}

/** The stripes of what is late. */
export function stripes() {
  const made = svgElement("pattern", { id: LATE, width: 5, height: 5, patternUnits: "userSpaceOnUse" });
  made.append(svgElement("path", { d: "M-1 6L6 -1M-1 1L1 -1M4 6L6 4", class: "stripe" }));
  return made;
}
