/** Say in a sentence what the selected tour gives up of one objective, and what it gains of the other. */

import { amount, wordsOf } from "../common/amounts.js";
import { isCounted, isLongest, shortUnit } from "../common/objectives.js";

/** The sentence about the tour of a link whose front the service no longer keeps; `noun` is what the front called it. */
export const choiceKept = ({ one }) =>
  `The service no longer keeps this front. This is the ${one} that was chosen; a new plan may differ.`;

/** The sentence about a tour of a front, whose tours go from the least first length to the least second; `noun` is what it calls one. */
export function choiceOf(front, tour, objectives, { one }) {
  const kept = tour.kept == null ? "" : ` Keeps ${Math.round(100 * tour.kept)} % of the legs.`;
  return `${sentence(front, tour, objectives, one)}${kept}`;
}

function sentence(front, tour, objectives, one) {
  if (front.length < 2) return `This ${one} is the best under ${objectives.length > 2 ? "all" : "both"} objectives.`;
  if (objectives.length > 2) return ofSeveral(front, tour, objectives);
  const [first, second] = objectives.map(wordsOf);
  const least = front[0];
  if (tour.lengths[0] === least.lengths[0]) {
    return `The ${first.least} ${objectives[0].name}. Every other ${one} has ${some(objectives[1], second.less)}, for ${some(objectives[0], first.more)}.`;
  }
  const cost = capital(step(least, tour, 0, objectives, first.more));
  const gain = step(least, tour, 1, objectives, second.less);
  return `${cost} than the ${first.least}, for ${gain}${reached(front, tour, objectives[1])}.`;
}

/** Says that a tour has the least second length of all, or that a measure of plans is 0. */
function reached(front, tour, objective) {
  if (tour.lengths[1] !== front.at(-1).lengths[1]) return "";
  if (objective.measure && tour.lengths[1] === 0) return ": none is left";
  if (isLongest(objective)) return ": the shortest there is";
  return isCounted(objective) ? ": the fewest there are" : `: the least ${objective.name} there is`;
}

/** How much more than the least of the front a tour has of each of three or four objectives. */
function ofSeveral(front, tour, objectives) {
  const said = objectives.map(({ name }, axis) => {
    const least = front.reduce((best, each) => (each.lengths[axis] < best.lengths[axis] ? each : best));
    const { least: fewest, more } = wordsOf(objectives[axis]);
    return tour.lengths[axis] === least.lengths[axis] ? `the ${fewest} ${name} there is` : step(least, tour, axis, objectives, more);
  });
  const more = said.some((each) => !each.startsWith("the ")) ? " than the least of each" : "";
  return capital(`${said.slice(0, -1).join(", ")} and ${said.at(-1)}${more}.`);
}

const capital = (sentence) => sentence[0].toUpperCase() + sentence.slice(1);

/** More or less of an objective, such as "less driving" or "a shorter longest route". */
const some = (objective, word) => `${isLongest(objective) ? "a " : ""}${word} ${objective.name}`;

/** How much more or less of an objective one tour has than another: in per cent, and in its unit; of a measure of plans in its unit alone. */
function step(from, to, axis, objectives, word) {
  const objective = objectives[axis];
  const { name } = objective;
  const [before, after] = [from.lengths[axis], to.lengths[axis]];
  const by = Math.abs(after - before);
  if (isCounted(objective)) return `${Math.round(by)} ${word} ${Math.round(by) === 1 && name === "vehicles" ? "vehicle" : name}`;
  const said = amount(by, objective);
  if (isLongest(objective)) return objective.measure || before === 0 ? `a ${name} ${word} by ${said}` : `a ${name} ${percent((100 * by) / before)} ${word} (${said})`;
  if (objective.measure || before === 0) return `${said} ${word} ${name}`;
  return `${percent((100 * by) / before)} ${word} ${name}${shortUnit(objective) && ` (${said})`}`;
}

const percent = (share) => `${share < 0.1 ? "under 0.1" : share.toFixed(share < 10 ? 1 : 0)} %`;
