/** The measures of a plan, as rows of a table. */

import { MEASURES } from "../common/measures_table.js";
import { titled, withUnit } from "../common/objectives.js";
import { unitOfMeasure } from "./units.js";

/**
 * The measures of a plan that do not stand there as objectives, each `{ name, objective, value }`, whose `value`
 * takes a plan; none if it has none.
 */
export function measuresOf({ measures = {}, lengths }, objectives, request) {
  const same = (each, axis, name) => MEASURES[name].title.startsWith(titled(each)) && lengths[axis] === measures[name];
  const named = (name) => objectives.some((each, axis) => (each.measure === name && !MEASURES[name].ofPlan) || same(each, axis, name));
  const shown = Object.keys(MEASURES).filter((name) => name in measures && !named(name));
  return shown.map((measure) => {
    const { title, unit, ofPlan = unit } = MEASURES[measure];
    const objective = { name: title, unit: unitOfMeasure(ofPlan, objectives, request), measure };
    return { name: withUnit(objective), objective, value: (plan) => plan.measures[measure] };
  });
}
