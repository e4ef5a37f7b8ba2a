/** Say below the name of an objective what its number counts, where a reader could take it for something else. */

import { amount } from "../common/amounts.js";
import { MEASURES } from "../common/measures_table.js";
import { isLongest, isTime, shortUnit } from "../common/objectives.js";
import { knownFleet } from "../fleet/known_fleet.js";
import { namesOf } from "../fleet/routes_of_plan.js";
import { isOnTheWay, visitTimes } from "../fleet/visit_times.js";

const OWN = "added up from stop to stop, in the unit of your numbers";
const NEAR = 0.01; // the share by which the parts of a route may miss its length
const PARTS = [["driving", "driving"], ["service", "at stops"], ["waiting", "waiting"], ["breaks", "in breaks"]];

/**
 * The note on one objective of a tour or plan; "" if its name says enough.
 *
 * @param {{ movers: object | null, asked: object }} known what moves along the routes of a plan, and the request
 */
export function noteOn(objectives, axis, item, { movers, asked }) {
  if (!item) return ""; // units are known from the answer on
  const objective = objectives[axis];
  const of = movers && !objective.measure ? ofRoutes(objective, axis, item, { movers, asked }) : "";
  return [unitOf(objective), mostDays(objectives, axis, item, asked), of, item.routes?.some(isOnTheWay) && "of the rest of the day", axis === 0 && prizesIn(objectives, item)].filter(Boolean).join("; ");
}

/** What most days do not exceed: of a tour whose costs spread beside its mean; of plans, that the objective is of most days. */
function mostDays(objectives, axis, { means, p90 }, asked) {
  const said = (value) => amount(value, objectives[axis]);
  if (p90?.[axis] > means?.[axis]) return `${said(means[axis])} on average; nine days of ten within ${said(p90[axis])}`;
  const percent = asked?.objectives?.[axis]?.percentile;
  return percent && !means ? `at most, on ${percent} days of a hundred` : "";
}

/** How much of the first objective is the prizes of stops that are left out; "" if they are not added to it. */
function prizesIn(objectives, { measures }) {
  const isOwn = objectives.some(({ measure }) => measure === "unassigned");
  return measures?.unassigned && !isOwn ? `${amount(measures.unassigned, objectives[0])} of it for stops left out` : "";
}

/** A unit that is too long to stand beside a number, or what a number without one is. */
function unitOf(objective) {
  if (objective.measure) return MEASURES[objective.measure]?.note ?? "";
  if (objective.unit?.startsWith(`${objective.name} ×`)) return "what each metre costs, added up along the way";
  return shortUnit(objective) ? "" : objective.unit || OWN;
}

/** Which routes are counted: those of all movers, or the longest one, with its parts as far as they are known. */
function ofRoutes(objective, axis, item, { movers, asked }) {
  if (!isLongest(objective)) return [countedIn(item, axis, objective), item.routes.length > 1 && `all ${movers.words} together`].filter(Boolean).join(", ");
  const named = /longest/i.test(objective.name) ? "" : "the longest route";
  return [named, isTime(objective) && partsOf(item, axis, objective, { movers, asked })].filter(Boolean).join(", ");
}

/** Whether a total time has more than the driving; "" if that is plain from its name, or not known. */
function countedIn({ measures, lengths }, axis, objective) {
  if (!isTime(objective) || !measures || /driving/i.test(objective.name)) return "";
  const { driving, service = 0, waiting = 0 } = measures;
  if (!(service + waiting > 0)) return "";
  const isNear = (value) => Math.abs(value - lengths[axis]) <= NEAR * value;
  return isNear(driving) ? "driving only" : isNear(driving + service + waiting) ? "driving, stops and waiting" : "";
}

/** The longest route by name, and what its time is spent on; null if that is not known. */
function partsOf({ routes }, axis, objective, { movers, asked }) {
  const lengths = routes.map((route) => route.lengths[axis]);
  const longest = lengths.indexOf(Math.max(...lengths));
  if (!asked.stops || !routes[longest]?.arrivals) return null;
  const spent = spentOn(visitTimes(routes[longest], knownFleet(asked)));
  const all = spent.driving + spent.service + spent.waiting + spent.breaks;
  if (Math.abs(all - lengths[longest]) > NEAR * lengths[longest]) return null;
  const parts = PARTS.filter(([part]) => Math.round(spent[part]) > 0).map(([part, said]) => `${amount(spent[part], objective)} ${said}`);
  return `${namesOf(routes, movers, asked)[longest]}: ${parts.join(", ")}`;
}

/** What the time of a route is spent on, from the times of its visits. */
function spentOn(visits) {
  const spent = { driving: 0, service: 0, waiting: 0, breaks: 0 };
  visits.forEach(({ arrival, begin, end, leaves, rests }, at) => {
    const rested = rests.reduce((sum, [from, to]) => sum + to - from, 0);
    if (at) spent.driving += arrival - visits[at - 1].leaves;
    spent.service += end - begin;
    spent.breaks += rested;
    spent.waiting += leaves - arrival - (end - begin) - rested;
  });
  return spent;
}
