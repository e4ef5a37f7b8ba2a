/** The units of a fleet's times, and of objectives that are measures of plans. */

import { MEASURES } from "../common/measures_table.js";
import { LOAD_HOURS, LOAD_KM, isUnnamed, namesIn } from "../common/objectives.js";

/** The unit of the clock of a request: that of an objective, or of times that are not an objective; "" if it is not known. */
export function clockUnit({ clock, objectives }) {
  const source = typeof clock === "string" ? objectives?.find(({ name }) => name === clock) : clock;
  return source ? unitOf(source) : "";
}

/** The unit of the costs of an objective of a request, as the service answers it. */
export const unitOf = ({ unit, from, speed }) => unit ?? (from ? (speed != null || from === "road_time" ? "s" : "m") : "");

/** The unit by which routes are compared: that of the clock, or of the objective that is a maximum, or of the first. */
function unitOfRoutes(request) {
  const compared = request.objectives?.find(({ over }) => over === "max") ?? request.objectives?.[0];
  return request.clock || !compared ? clockUnit(request) : unitOf(compared);
}

/** The unit of a measure of plans, by that of its row in the table of measures. */
export function unitOfMeasure(unit, objectives, request) {
  const units = { clock: clockUnit(request), routes: unitOfRoutes(request), prizes: objectives[0].unit, load: loadUnit(objectives), "%": "%", stops: "stops", visits: "visits" };
  return units[unit] ?? "";
}

/** The unit of what is carried: the load times the first costs, which are how far or for how long. */
function loadUnit(objectives) {
  const { name, unit } = objectives.find(({ measure }) => !measure) ?? objectives[0];
  return { m: LOAD_KM, s: LOAD_HOURS }[unit] ?? `load × ${unit || name}`;
}

/** The names of the objectives of an answer; those `before` where the service had none, as when the rest of a tour is planned. */
export function namesShown({ objectives: named, scale }, before, instance) {
  if (!named && !(scale?.length > 2)) return before;
  const found = withUnits(namesIn({ objectives: named, scale }), instance);
  return isUnnamed(found) && found.length === before.length ? before : found;
}

/** These objectives with units for those that are measures of plans of a request, or cost layers of its map. */
export function withUnits(objectives, request) {
  const unit = ({ name, measure }) => (measure ? unitOfMeasure(MEASURES[measure]?.unit, objectives, request ?? {}) : request?.grid ? `${name} × m` : "");
  return objectives.map((each) => (each.unit ? each : { ...each, unit: unit(each) }));
}
