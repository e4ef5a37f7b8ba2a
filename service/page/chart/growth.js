/** A chart of the hypervolume's growth during a search. */

import uPlot from "./uplot.js";
import { colour, onSchemeChange } from "../common/colours.js";
import { share } from "../common/numbers.js";

const FONT = "11px system-ui, sans-serif";

export class Growth {
  #element;
  #unknown;
  #chart;

  /** @param {HTMLElement} unknown is shown in place of the chart if the search reported nothing */
  constructor(element, unknown) {
    this.#element = element;
    this.#unknown = unknown;
    this.#chart = new uPlot(options(element), [[], []], element);
    new ResizeObserver(() => this.#chart.setSize(size(element))).observe(element);
    onSchemeChange(() => this.#chart.redraw(false, true));
  }

  /** Shows rows of seconds and hypervolume. */
  show(growth) {
    this.#chart.setData([growth.map(([seconds]) => seconds), growth.map(([, grown]) => 100 * grown)]);
    const drawn = growth.length > 1; // one row does not make a line
    this.#element.hidden = !drawn;
    this.#unknown.hidden = drawn;
    if (!drawn) return;
    const said = `from ${share(growth[0][1])} to ${share(growth.at(-1)[1])}`;
    this.#element.setAttribute("aria-label", `Hypervolume over time: ${said}`);
  }
}

const size = (element) => ({ width: element.clientWidth, height: element.clientHeight });

function options(element) {
  const stroke = () => colour("improved");
  return {
    ...size(element),
    legend: { show: false },
    cursor: { show: false },
    padding: [8, 18, 0, 0],
    scales: { x: { time: false } },
    axes: [axis(22, (tick) => `${tick} s`, 50), axis(52, (tick) => `${tick} %`, 24)],
    series: [{}, { stroke, width: 1.5, points: { show: false } }],
  };
}

function axis(room, shown, space) {
  return {
    size: room,
    space,
    font: FONT,
    stroke: () => colour("quiet"),
    grid: { stroke: () => colour("line"), width: 1 },
    ticks: { show: false },
    values: (_, ticks) => ticks.map(shown),
  };
}
