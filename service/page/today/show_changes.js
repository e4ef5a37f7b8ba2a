/** Show what a proposed plan of what is left changes, beside the plan that is driven. */

import { made } from "../common/elements.js";

const element = (id) => document.getElementById(id);

/**
 * @param {{ said: string[], many: string, last: string, vehicles: object[] }} changes by `changesOf`
 */
export function showChanges({ said, many, last, vehicles }) {
  element("changes-said").textContent = [many, last].filter(Boolean).join(" ");
  const timed = vehicles.some(({ before, after }) => (before ?? after)?.back);
  const titles = ["Vehicle", "Stops still to visit", ...(timed ? ["Back at"] : [])].map((title) => made("th", { scope: "col" }, title));
  element("changes-vehicles").tHead.replaceChildren(made("tr", {}, ...titles));
  element("changes-vehicles").tBodies[0].replaceChildren(...vehicles.map((each) => row(each, timed)));
  element("changes-list").replaceChildren(...said.map((each) => made("li", {}, each)));
}

function row({ name, before, after, isOut }, timed) {
  const change = ([from, to]) => (from === to ? from : `${from} → ${to}`);
  const stops = change([before?.stops ?? 0, after?.stops ?? 0].map(String));
  const back = change([before?.back ?? "–", isOut ? "out of service" : (after?.back ?? "–")]);
  const cells = [stops, ...(timed ? [back] : [])].map((each) => made("td", {}, each));
  return made("tr", {}, made("th", { scope: "row" }, name), ...cells);
}
