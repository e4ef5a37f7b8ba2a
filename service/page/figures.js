/** How good a front is, and how long it took. */

import { length, share } from "./numbers.js";

export function showFigures(list, alone, answer) {
  list.replaceChildren(...(answer ? figures(alone, answer).flatMap(pair) : pair(["Front", "none yet"])));
}

function figures(alone, answer) {
  const seconds = (answer.timings_ms.total ?? 0) / 1000;
  return [
    ["Front", share(answer.hypervolume)],
    ["Network alone", share(alone.hypervolume)],
    ["Reference point", answer.reference_point.map(length).join(", ")],
    ["Tours", `${answer.front.length} of ${answer.points.toLocaleString("en")} found`],
    ["Time", `${seconds.toFixed(2)} s, ${ENDS[answer.terminated] ?? "still searching"}`],
    ["Network", answer.actor.name],
  ];
}

const ENDS = {
  converged: "converged",
  time_limit: "to the limit",
  cancelled: "stopped",
};

const pair = ([term, said]) => [
  Object.assign(document.createElement("dt"), { textContent: term }),
  Object.assign(document.createElement("dd"), { textContent: said }),
];
