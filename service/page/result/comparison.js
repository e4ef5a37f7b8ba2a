/** Compare the lengths of the selected tour, and the measures of a plan, with those of the pinned one. */

import { change, compared } from "../common/amounts.js";
import { withUnit } from "../common/objectives.js";

/** Fills a table with the lengths, and with measures, each `{ name, objective, value }`, whose `value` takes a plan. */
export function compare(table, objectives, selected, pinned, measures = []) {
  const lengths = objectives.map((objective, axis) => ({ name: withUnit(objective), objective, value: (item) => item.lengths[axis] }));
  table.classList.toggle("alone", !pinned);
  const filled = ({ name, objective, value }) => {
    const said = (item) => (item ? compared(value(item), objective) : "–");
    const beside = selected && pinned ? change(value(selected), value(pinned), objective) : "";
    return row(name, [said(selected), said(pinned), beside]);
  };
  [lengths, measures].forEach((rows, at) => table.tBodies[at].replaceChildren(...rows.map(filled)));
}

function row(name, cells) {
  const made = document.createElement("tr");
  const head = Object.assign(document.createElement("th"), { scope: "row", textContent: name });
  made.append(head, ...cells.map((textContent) => Object.assign(document.createElement("td"), { textContent })));
  return made;
}
