/** Say in a sentence what the selected tour gives up of one objective, and what it gains of the other. */

import { length } from "../common/numbers.js";
import { shortUnit } from "../common/objectives.js";

/** The sentence about a tour of a front, whose tours go from the least first length to the least second; `noun` is what it calls one. */
export function choiceOf(front, tour, objectives, { one }) {
  const kept = tour.kept == null ? "" : ` Keeps ${Math.round(100 * tour.kept)} % of the legs.`;
  return `${sentence(front, tour, objectives, one)}${kept}`;
}

function sentence(front, tour, objectives, one) {
  if (front.length < 2) return `This ${one} is the best under ${objectives.length > 2 ? "all" : "both"} objectives.`;
  if (objectives.length > 2) return ofSeveral(front, tour, objectives);
  const [first, second] = objectives.map(({ name }) => name);
  const least = front[0];
  const gain = step(least, tour, 1, objectives, "less");
  if (tour.lengths[0] === least.lengths[0]) return `The least ${first}. Every other ${one} has less ${second}, for more ${first}.`;
  const cost = step(least, tour, 0, objectives, "more");
  const most = tour.lengths[1] === front.at(-1).lengths[1] ? `: the least ${second} there is` : "";
  return `${cost} than the least, for ${gain}${most}.`;
}

/** How much more than the least of the front a tour has of each of three or four objectives. */
function ofSeveral(front, tour, objectives) {
  const said = objectives.map(({ name }, axis) => {
    const least = front.reduce((best, each) => (each.lengths[axis] < best.lengths[axis] ? each : best));
    return tour.lengths[axis] === least.lengths[axis] ? `the least ${name} there is` : step(least, tour, axis, objectives, "more");
  });
  const more = said.some((each) => !each.startsWith("the least")) ? " than the least of each" : "";
  const sentence = `${said.slice(0, -1).join(", ")} and ${said.at(-1)}${more}.`;
  return sentence[0].toUpperCase() + sentence.slice(1);
}

/** How much more or less of an objective one tour has than another: in per cent, and in its unit. */
function step(from, to, axis, objectives, word) {
  const { name } = objectives[axis];
  const unit = shortUnit(objectives[axis]);
  const [before, after] = [from.lengths[axis], to.lengths[axis]];
  const amount = `${length(Number(Math.abs(after - before).toPrecision(3)))}${unit ? ` ${unit}` : ""}`;
  const share = Math.abs(before) > 0 ? (100 * Math.abs(after - before)) / before : null;
  return share === null ? `${amount} ${word} ${name}` : `${percent(share)} ${word} ${name}${unit && ` (${amount})`}`;
}

const percent = (share) => `${share < 0.1 ? "under 0.1" : share.toFixed(share < 10 ? 1 : 0)} %`;
