/** The measures of a plan, as rows of a table. */

import { titled, withUnit } from "../common/objectives.js";
import { PLAIN, clockUnit, loadUnit, unitOfRoutes } from "./units.js";

const NAMES = {
  vehicles: "Vehicles used",
  driving: "Driving in all",
  service: "At stops in all",
  waiting: "Waiting in all",
  lateness: "Late in all",
  earliness: "Early in all",
  weighted_arrival: "Customer wait",
  overtime: "Overtime in all",
  longest: "Longest route",
  shortest: "Shortest route",
  imbalance: "Longest minus shortest",
  unassigned: "Prizes left out",
  load_distance: "Load carried",
  overlap: "Overlap of routes",
  changes: "Stops changed",
  on_time: "Visits on time",
  duration: "Time in all, on average",
  duration_p90: "Nine days of ten within",
};

/**
 * The measures of a plan that do not stand there as objectives, each `{ name, objective, value }`, whose `value`
 * takes a plan; none if it has none.
 */
export function measuresOf({ measures = {}, lengths }, objectives, request) {
  const same = (each, axis, name) => NAMES[name].startsWith(titled(each)) && lengths[axis] === measures[name];
  const named = (name) => objectives.some((each, axis) => (each.measure === name && name !== "on_time") || same(each, axis, name));
  const shown = Object.keys(NAMES).filter((name) => name in measures && !named(name));
  return shown.map((measure) => {
    const unit = unitsOf(objectives, request)[measure] ?? "";
    const objective = { name: NAMES[measure], unit, measure };
    return { name: withUnit(objective), objective, value: (plan) => plan.measures[measure] };
  });
}

function unitsOf(objectives, request) {
  const time = clockUnit(request);
  const times = { driving: time, service: time, waiting: time, lateness: time, earliness: time, weighted_arrival: time, overtime: time, duration: time, duration_p90: time };
  const route = unitOfRoutes(request);
  return { ...times, longest: route, shortest: route, imbalance: route, unassigned: objectives[0].unit, load_distance: loadUnit(objectives), on_time: "%", ...PLAIN };
}
