/** Compare the selected tour's figures with those of the pinned one. */

import { degrees, difference, length } from "../common/numbers.js";
import { withUnit } from "../common/objectives.js";

export function compare(table, objectives, selected, pinned) {
  const rows = [
    [withUnit(objectives[0]), (item) => item.lengths[0], length],
    [withUnit(objectives[1]), (item) => item.lengths[1], length],
    ["Angle", (item) => item.angle, degrees],
  ];
  table.classList.toggle("alone", !pinned);
  table.tBodies[0].replaceChildren(
    ...rows.map(([name, value, shown]) => {
      const said = (item) => (item ? shown(value(item)) : "–");
      const beside = selected && pinned && shown === length ? difference(value(selected), value(pinned)) : "";
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
