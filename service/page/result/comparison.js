/** Compare the figures of the selected tour with those of the pinned one. */

import { difference, length } from "../common/numbers.js";
import { withUnit } from "../common/objectives.js";

export function compare(table, objectives, selected, pinned) {
  const rows = objectives.map((objective, axis) => [withUnit(objective), (item) => item.lengths[axis]]);
  table.classList.toggle("alone", !pinned);
  table.tBodies[0].replaceChildren(
    ...rows.map(([name, value]) => {
      const said = (item) => (item ? length(value(item)) : "–");
      const beside = selected && pinned ? difference(value(selected), value(pinned)) : "";
      return row(name, [said(selected), said(pinned), beside]);
    }),
  );
}

function row(name, cells) {
  const made = document.createElement("tr");
  const head = Object.assign(document.createElement("th"), { scope: "row", textContent: name });
  made.append(head, ...cells.map((textContent) => Object.assign(document.createElement("td"), { textContent })));
  return made;
}
