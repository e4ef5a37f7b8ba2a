/** Ask for plans of the rest of the day in which few stops change: another objective of what is replanned. */

import { SECONDS } from "../common/durations.js";
import { hintOf, withText } from "../fleet/cells.js";
import { clockUnit } from "../fleet/units.js";
import { Problem } from "../planning/service.js";

const element = (id) => document.getElementById(id);
const MOST = 4; // objectives
const LATER = { member: "tolerance", type: "lasting" };

/** Shows the choice, where the service has it for a request: without it at first. */
export function showFew({ objectives, vehicles, clock }) {
  const isCounted = objectives.some(({ measure }) => measure === "changes");
  element("today-changes").hidden = isCounted || objectives.length >= MOST || objectives[0].over === "max" || vehicles.some(({ breaks }) => breaks?.length);
  element("today-few").checked = false;
  element("today-later").hidden = !clock;
}

/** How stops that change are counted, as a member of the body; null if nobody asks for that. Throws a Problem where the time is not understood. */
export function changesAsked(asked) {
  if (element("today-changes").hidden || !element("today-few").checked) return null;
  if (!asked.clock) return { name: "stops changed" };
  const text = element("today-tolerance").value.trim() || "0";
  const { tolerance } = withText({}, LATER, text, SECONDS.get(clockUnit(asked)));
  if (typeof tolerance !== "number") throw new Problem({ code: "invalid-request", detail: `later than planned cannot be “${text}”: write ${hintOf(LATER, 1)}` });
  return { name: "stops changed", tolerance };
}
