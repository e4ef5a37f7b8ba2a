/** Say in a sentence what the selected tour gives up of one objective, and what it gains of the other. */

import { amount, compared, wordsOf } from "../common/amounts.js";
import { isBeaten, lastOf } from "./tours.js";
import { capital, isCounted, isLongest, namesThings, shortUnit } from "../common/objectives.js";

/** The sentence about the tour of a link whose front the service no longer keeps; `noun` is what the front called it. */
export const choiceKept = ({ one }) =>
  `The service no longer keeps this result. This is the ${one} that was chosen; a new plan may differ.`;

/** The sentence about a tour of a front, whose tours go from the least first length to the least second; `noun` is what it calls one. */
export function choiceOf(front, tour, objectives, noun) {
  const kept = tour.kept == null || tour.routes ? "" : ` ${Math.round(100 * tour.kept)} % of the stops still to visit come after the same stop as before.`;
  return `${sentence(front, tour, objectives, noun)}${kept}`;
}

function sentence(front, tour, objectives, { one, many }) {
  if (front.length < 2) return `This ${one} is the best found under ${objectives.length > 2 ? "all" : "both"} objectives.`;
  if (objectives.length > 2) return ofSeveral(front, tour, objectives);
  const [first, second] = objectives.map(wordsOf);
  const least = front[0];
  if (tour.lengths[0] === least.lengths[0]) {
    const dearer = isLongest(objectives[0]) ? `but ${has(objectives[0], first.more)}` : `for ${first.more} ${objectives[0].name}`;
    return `${capital(theLeast(objectives[0]))}. Every other ${one} ${has(objectives[1], second.less)}, ${dearer}.`;
  }
  if (isBeaten(front, tour)) return `Another ${one} is better under both objectives, but this one changes less of the plan before.`;
  const cost = capital(step(least, tour, 0, objectives, first.more));
  const gain = step(least, tour, 1, objectives, second.less);
  const joined = isLongest(objectives[1]) ? "and" : "for";
  return `${cost} than ${isLongest(objectives[0]) ? "at its" : "the"} ${first.least}, ${joined} ${gain}${reached(front, tour, objectives[1], many)}.`;
}

/** Says that a tour has the least second length of those found, or that a measure of plans is 0. */
function reached(front, tour, objective, many) {
  if (tour.lengths[1] !== front[lastOf(front)].lengths[1]) return "";
  if (objective.measure && tour.lengths[1] === 0) return ": none at all";
  return `: the ${wordsOf(objective).least} of all ${many} found`;
}

/** How much more than the least of the front a tour has of each of three or four objectives. */
function ofSeveral(front, tour, objectives) {
  const best = objectives.map((_, axis) => front.reduce((least, each) => (each.lengths[axis] < least.lengths[axis] ? each : least)));
  const isBest = (_, axis) => tour.lengths[axis] === best[axis].lengths[axis];
  const leasts = objectives.filter(isBest).map((objective) => (isLongest(objective) ? theLeast(objective) : `${theLeast(objective)} of all`));
  const others = objectives.flatMap((objective, axis) => (isBest(objective, axis) ? [] : [step(best[axis], tour, axis, objectives, wordsOf(objective).more)]));
  const more = others.length ? [`${listed(others)} than the best of each`] : [];
  return capital(`${[...(leasts.length ? [listed(leasts)] : []), ...more].join("; ")}.`);
}

const listed = (parts) => (parts.length > 1 ? `${parts.slice(0, -1).join(", ")} and ${parts.at(-1)}` : parts[0]);

/** What the best of all is under one objective, such as "the least driving". */
const theLeast = (objective) => `the ${isLongest(objective) ? `${objective.name} at its shortest` : `${wordsOf(objective).least} ${objective.name}`}`;

/** What other tours have, such as "has less driving". */
const has = (objective, word) => (isLongest(objective) ? `makes the ${objective.name} ${word}` : `has ${word} ${objective.name}`);

/** How much more or less of an objective one tour has than another: in per cent, and in its unit; of a measure of plans in its unit alone. */
function step(from, to, axis, objectives, word) {
  const objective = objectives[axis];
  const { name } = objective;
  const [before, after] = [from.lengths[axis], to.lengths[axis]];
  const by = Math.abs(after - before);
  if (isCounted(objective)) return `${Math.round(by)} ${word} ${Math.round(by) === 1 && name === "vehicles" ? "vehicle" : name}`;
  const said = amount(by, objective);
  const is = objectives.length > 2 ? "" : " is"; // several are listed
  if (isLongest(objective)) return `the ${name}${is} ${objective.measure || before === 0 ? `${said} ${word}` : `${percent((100 * by) / before)} ${word} (${said})`}`;
  if (objective.measure || before === 0) return `${namesThings(objective) ? compared(by, objective) : said} ${word} ${name}`;
  return `${percent((100 * by) / before)} ${word} ${name}${shortUnit(objective) && ` (${said})`}`;
}

const percent = (share) => `${share < 0.1 ? "under 0.1" : share.toFixed(share < 10 ? 1 : 0)} %`;
