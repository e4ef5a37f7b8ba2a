/** The request of a fleet or of robots: in a few words, and as JSON in a part of the form that unfolds. */

import { counted } from "../common/numbers.js";

/** How many vehicles there are of all types. */
export const vehiclesIn = ({ vehicles }) => vehicles.reduce((all, each) => all + (Number(each?.count ?? 1) || 0), 0);

export function describedFleet({ vehicles, stops }) {
  const count = vehiclesIn({ vehicles });
  const fleet = `${counted(count, "vehicle", "vehicles")} and ${counted(stops?.length ?? 0, "stop", "stops")}`;
  return `A fleet: ${fleet}.`;
}

/** Robots that share a map, which is described. */
export const describedRobots = ({ robots }, map) =>
  `${counted(robots.length, "robot", "robots")} on ${map} Their starts and ends are moved on the map; for anything else change the request’s JSON, and open it again.`;

// Members that are long lists of rows.
const ROWS = ["matrix", "coordinates", "grid", "cost_layer", "layer", "second_matrix", "second_coordinates"];

/** The request as JSON; costs, planes and maps in a few words. */
function jsonOf(asked) {
  const short = (name, value) =>
    ROWS.includes(name) && Array.isArray(value)
      ? `${value.length} rows of ${value[0]?.length ?? 0} numbers`
      : value;
  return JSON.stringify(asked, short, 1);
}

export class RequestText {
  #details;
  #asked = null;

  constructor(details) {
    this.#details = details;
    details.addEventListener("toggle", () => this.#write());
  }

  /** Shows a request; hides itself if there is none. */
  show(asked) {
    this.#asked = asked;
    this.#details.hidden = !asked;
    this.#write();
  }

  /** Writes nothing while it is folded: requests may be long. */
  #write() {
    const text = this.#asked && this.#details.open ? jsonOf(this.#asked) : "";
    this.#details.querySelector("pre").textContent = text;
  }
}
