/** The selected plan by vehicle or robot: legend, lanes over time, stops, and what is left out. */

import { UNNAMED } from "../common/objectives.js";
import { nameOf } from "../inputs/names.js";
import { Lanes } from "./lanes.js";
import { leftOut, reason } from "./left_out.js";
import { showLegend } from "./legend.js";
import { namesOf } from "./routes_of_plan.js";
import { clockOf } from "./times.js";
import { visitTimes } from "./visit_times.js";

const element = (id) => document.getElementById(id);

export class PlanView {
  #lanes = new Lanes(element("fleet-lanes"));
  #asked = {}; // the request, as far as it is known
  #objectives = UNNAMED;
  #plan = null;
  #movers = null; // of its routes

  /** Takes the request whose plans will be shown. */
  open(asked) {
    this.#asked = asked;
    this.show(null);
  }

  /** Sets the names of both lengths. */
  name(objectives) {
    this.#objectives = objectives;
    const plan = this.#plan;
    this.show(null);
    this.show(plan, this.#movers);
  }

  /** Shows a plan, whose routes are of these movers; hides everything where there is none. */
  show(plan, movers) {
    if (plan && plan === this.#plan) return;
    this.#plan = plan;
    element("fleet").hidden = !plan;
    if (!plan) return;
    this.#movers = movers;
    element("fleet-title").textContent = movers.many;
    element("fleet-listed").textContent = movers.listed;
    const stops = new Map(this.#asked.stops?.map((stop) => [stop.id, stop]));
    showLegend(element("fleet-legend"), plan, movers, this.#asked, this.#objectives);
    this.#showTimes(plan, stops);
    element("fleet-left-out-title").textContent = reason(plan, this.#objectives[0]);
    list("fleet-left-out", leftOut(plan, stops, this.#objectives[0]));
  }

  /** Shows a lane for each vehicle if the plan has times, and the stops of each vehicle in order. */
  #showTimes({ routes }, stops) {
    const names = namesOf(routes, this.#movers);
    const timed = routes.length > 0 && routes.every(({ arrivals }) => arrivals);
    const lanes = timed ? routes.map((route, at) => ({ name: names[at], visits: visitTimes(route, stops) })) : [];
    const times = lanes.flatMap(({ visits }) => visits.flatMap(({ arrival, end }) => [arrival, end]));
    const clock = timed ? clockOf(times, this.#unit) : null;
    this.#lanes.show(lanes, clock);
    element("fleet-lanes-help").hidden = !timed;
    const visit = (stop, time) => (clock ? `${stop} ${clock.said(time)}` : stop);
    const said = (route) => route[this.#movers.through].map((stop, at) => visit(nameOfStop(stop), route.arrivals?.[at])).join(" → ");
    list("fleet-stops", routes.map((route, at) => `${names[at]}: ${said(route)}`));
  }

  /** The unit of the objective that is time. */
  get #unit() {
    return this.#objectives.find(({ name }) => name === this.#asked.clock)?.unit ?? "";
  }
}

/** Stops of a fleet have ids; places of robots are numbered from 1. */
const nameOfStop = (stop) => (typeof stop === "number" ? nameOf(null, stop) : stop);

function list(id, texts) {
  element(id).replaceChildren(...texts.map((textContent) => Object.assign(document.createElement("li"), { textContent })));
}
