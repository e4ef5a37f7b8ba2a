/** Say which stops a plan leaves out, and why. */

import { withCustomer } from "../inputs/details.js";
import { counted, length } from "../common/numbers.js";
import { shortUnit } from "../common/objectives.js";

/** Says why stops are left out, if any are. The service only says which; robots leave none out. */
export function reason({ unassigned }, objectives) {
  if (!unassigned) return "";
  if (!unassigned.length) return "No stop is left out.";
  const stops = counted(unassigned.length, "stop is", "stops are");
  return `${stops} left out: stops with a prize may be. Their prizes are added to ${paying(objectives).name}:`;
}

/** The objective to which prizes are added. */
const paying = (objectives) => objectives.find(({ measure }) => measure === "unassigned") ?? objectives[0];

/**
 * Each stop that is left out, with its prize if it is known.
 *
 * @param {Map<string, object>} asked the stops of the request by id
 * @param {(stop: string) => string} customerOf as of `customersIn`
 */
export function leftOut({ unassigned = [] }, asked, customerOf, objectives) {
  const unit = shortUnit(paying(objectives));
  return unassigned.map((stop) => {
    const [prize, name] = [asked.get(stop)?.prize, withCustomer(stop, customerOf(stop))];
    return prize == null ? name : `${name}: prize ${length(prize)}${unit && ` ${unit}`}`;
  });
}
