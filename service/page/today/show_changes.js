/** Show what a proposed plan of what is left changes, beside the plan that is driven. */

import { made } from "../common/elements.js";
import { counted } from "../common/numbers.js";

const element = (id) => document.getElementById(id);

/**
 * @param {{ kept?: number }} plan the proposed plan
 * @param {{ said: string[], same: number, last: string, vehicles: object[] }} changes by `changesOf`
 */
export function showChanges({ kept }, { said, same, last, vehicles }) {
  const share = kept === undefined ? "" : `${Math.round(100 * kept)} % of the stops left stay with their vehicle, in the same order. `;
  element("changes-said").textContent = `${share}${last}`;
  const timed = vehicles.some(({ before, after }) => (before ?? after)?.back);
  const titles = ["Vehicle", "Stops left", ...(timed ? ["Back at"] : [])].map((title) => made("th", { scope: "col" }, title));
  element("changes-vehicles").tHead.replaceChildren(made("tr", {}, ...titles));
  element("changes-vehicles").tBodies[0].replaceChildren(...vehicles.map((each) => row(each, timed)));
  element("changes-list").replaceChildren(...said.map((each) => made("li", {}, each)));
  element("changes-same").textContent = same ? `${counted(same, "stop stays as it was", "stops stay as they were")}, within 5 min.` : "";
}

function row({ name, before, after, isOut }, timed) {
  const left = ([from, to]) => (from === to ? from : `${from} → ${to}`);
  const stops = left([before?.stops ?? 0, after?.stops ?? 0].map(String));
  const back = left([before?.back ?? "–", isOut ? "out of service" : (after?.back ?? "–")]);
  const cells = [stops, ...(timed ? [back] : [])].map((each) => made("td", {}, each));
  return made("tr", {}, made("th", { scope: "row" }, name), ...cells);
}
