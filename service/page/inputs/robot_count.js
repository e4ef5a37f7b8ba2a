/** The field for how many robots share a map. */

import { isRead } from "../planning/faults.js";
import { say } from "../planning/status.js";
import { withRobots } from "./robots.js";

const MOST = 100;
const DROPPED = "Costs on the map are for one robot: several plan by distance.";

const element = (id) => document.getElementById(id);

export class RobotCount {
  #asked;

  /**
   * @param {() => object} asked the request that is shown
   * @param {(request: object) => void} open called with the request for another number of robots
   */
  constructor(asked, open) {
    this.#asked = asked;
    element("robots").addEventListener("change", ({ target }) => {
      const count = Number(target.value);
      if (!isRead(target, Number.isInteger(count) && count >= 1 && count <= MOST, `Robots must be a whole number from 1 to ${MOST}, got “${target.value}”`)) return;
      const request = this.#asked();
      open(withRobots(request, count));
      if (count > 1 && request.cost_layers) say(DROPPED);
    });
  }

  /** Shows how many robots a request has; hides the field where there is no map. */
  show({ grid, robots }) {
    element("robots-field").hidden = !grid;
    isRead(element("robots"), true, "");
    element("robots").value = Array.isArray(robots) ? robots.length : 1;
  }
}
