/** Compare the selected tour or plan with the pinned one: when it leaves, its lengths, and the measures of a plan. */

import { change, compared } from "../common/amounts.js";
import { made } from "../common/elements.js";
import { withUnit } from "../common/objectives.js";
import { noteOn } from "./notes.js";
import { hoursOf } from "../fleet/times.js";

const HOURS = [["Leaves at", 0], ["Ends at", -1]];

/**
 * Fills a table with lengths, hours and measures.
 *
 * @param {object[]} measures each `{ name, objective, value }`, whose `value` takes a plan
 * @param {{ movers: object | null, asked: object }} known what moves along the routes of a plan, and the request
 */
export function compare(table, objectives, selected, pinned, measures, known) {
  const lengths = objectives.map((objective, axis) => ({
    name: withUnit(objective),
    note: noteOn(objectives, axis, selected, known),
    objective,
    value: (item) => item.lengths[axis],
  }));
  table.classList.toggle("alone", !pinned);
  const filled = ({ name, note, objective, value }) => {
    const said = (item) => (item ? compared(value(item), objective) : "–");
    const beside = selected && pinned ? change(value(selected), value(pinned), objective) : "";
    return row(name, note, [said(selected), said(pinned), beside]);
  };
  const [first, second] = table.tBodies;
  first.replaceChildren(...lengths.map(filled), ...hours(selected, pinned));
  second.replaceChildren(...measures.map(filled));
}

/** When the selected tour leaves and ends, if it leaves at a time of day. */
function hours(selected, pinned) {
  const [said, beside] = [selected, pinned].map(hoursOf);
  return said.length ? HOURS.map(([name, at]) => row(name, "", [said.at(at), beside.at(at) ?? "–", ""])) : [];
}

function row(name, note, cells) {
  const head = made("th", { scope: "row" }, name, ...(note ? [made("small", {}, note)] : []));
  return made("tr", {}, head, ...cells.map((said) => made("td", {}, said)));
}
