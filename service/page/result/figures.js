/** Show a front's hypervolume and the times that it took. */

import { length, share } from "../common/numbers.js";

/** Fills two lists: what the front is worth, and what else is known of it. */
export function showFigures(list, more, alone, answer) {
  list.replaceChildren(...worth(alone, answer).flatMap(pair));
  more.replaceChildren(...(answer ? known(answer) : []).flatMap(pair));
}

const worth = (alone, answer) => [
  ["Front", answer ? share(answer.hypervolume) : "–"],
  ...(alone ? [["Network alone", share(alone.hypervolume)]] : []),
];

const known = (answer) => [
  ["Reference point", answer.reference_point.map(length).join(", ")],
  ["Tours", `${answer.front.length} of ${answer.points.toLocaleString("en")} found`],
  ["Time", answer.terminated ? took(answer) : "still searching"],
  ["Network", answer.actor?.name ?? "none"],
];

const took = ({ timings_ms, terminated }) =>
  `${((timings_ms.total ?? 0) / 1000).toFixed(2)} s, ${ENDS[terminated] ?? terminated}`;

const ENDS = {
  converged: "nothing more found",
  time_limit: "to the limit",
  cancelled: "stopped",
};

const pair = ([term, said]) => [
  Object.assign(document.createElement("dt"), { textContent: term }),
  Object.assign(document.createElement("dd"), { textContent: said }),
];
