/** Show a front's hypervolume, the angle of a tour, and the time that the front took. */

import { made } from "../common/elements.js";
import { kindNamed } from "../common/kinds.js";
import { titled } from "../common/objectives.js";
import { degrees, length, share } from "../common/numbers.js";

/** Fills a list with what is known of a front, if there is one. */
export const showFigures = (list, alone, answer) =>
  list.replaceChildren(...(answer ? [...worth(alone, answer), ...known(answer)] : []).flatMap(pair));

/** Fills a list with what else is known of a tour, if there is one. */
export const showTourFigures = (list, tour) =>
  list.replaceChildren(...(tour ? [...angle(tour), ...kept(tour)] : []).flatMap(pair));

const angle = (tour) => (tour.angle == null ? [] : [["Angle of the tour", degrees(tour.angle)]]);
const kept = (tour) => (tour.kept == null ? [] : [["Legs kept of the driven tour", `${Math.round(100 * tour.kept)} %`]]);

const worth = (alone, answer) => [
  ["Hypervolume", share(answer.hypervolume)],
  ...(alone ? [["Network alone", share(alone.hypervolume)]] : []),
  ...(answer.hypervolume_bound == null ? [] : shortOf(answer)),
];

/** The most hypervolume that any front can have, and how much of that is missing here. */
const shortOf = ({ hypervolume, hypervolume_bound: bound }) => [
  ["Nothing can have more than", share(bound)],
  ["Short of optimal by at most", share(bound > 0 ? 1 - hypervolume / bound : 0)],
];

const known = (answer) => [
  ["Reference point", answer.reference_point.map(length).join(", ")],
  [titled({ name: kindNamed(answer).noun.many }), `${answer.front.length} of ${answer.points.toLocaleString("en")} found`],
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

const pair = ([term, said]) => [made("dt", {}, term), made("dd", {}, said)];
