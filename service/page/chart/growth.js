/** A chart of the hypervolume's growth during a search. */

import { share, tick } from "../common/numbers.js";
import { Plot } from "./plot.js";

const MARGINS = { top: 8, right: 18, bottom: 22, left: 52 }; // pixels
const ROOM = 0.1; // of the range, over and under the line

export class Growth {
  #element;
  #unknown;
  #plot;

  /** @param {HTMLElement} unknown is shown in place of the chart if the search reported nothing */
  constructor(element, unknown) {
    this.#element = element;
    this.#unknown = unknown;
    this.#plot = new Plot(element, MARGINS);
  }

  /** Shows rows of seconds and hypervolume. */
  show(growth) {
    const drawn = growth.length > 1; // one row does not make a line
    this.#element.hidden = !drawn;
    this.#unknown.hidden = drawn;
    if (!drawn) return;
    const [[begin, least], [end, most]] = [growth[0], growth.at(-1)];
    const room = ROOM * (most - least || 1);
    const axis = (ends, unit) => ({ range: () => ends, said: (value, step) => `${tick(value, step)} ${unit}` });
    const points = growth.map(([seconds, grown]) => [seconds, 100 * grown]);
    this.#plot.show([axis([begin, end], "s"), axis([100 * (least - room), 100 * (most + room)], "%")], [{ name: "improved", points, line: (at) => `L${at}` }]);
    this.#element.setAttribute("aria-label", `Hypervolume over time: from ${share(least)} to ${share(most)}`);
  }
}
