/** The selected plan by vehicle or robot: legend, lanes over time, stops, and what is left out. */

import { UNNAMED } from "../common/objectives.js";
import { visitItem } from "../common/elements.js";
import { customersIn, withCustomer } from "../inputs/details.js";
import { nameOf } from "../inputs/places.js";
import { ChosenVisit } from "./chosen_visit.js";
import { knownFleet } from "./known_fleet.js";
import { Lanes } from "./lanes.js";
import { leftOut, reason } from "./left_out.js";
import { showLegend } from "./legend.js";
import { namesOf } from "./routes_of_plan.js";
import { ServeBy } from "./serve_by.js";
import { timetable } from "./timetable.js";
import { arrivalIn } from "./visit_sentence.js";

const element = (id) => document.getElementById(id);

export class PlanView {
  #lanes;
  #chosen;
  #asked = {}; // the request, as far as it is known
  #editable = true;
  #objectives = UNNAMED;
  #customerOf = () => "";
  #plan = null;
  #movers = null; // of its routes
  #hours = new Map(); // when each stop is visited, in words

  /**
   * @param {(stop: string | null) => void} onChoose called with the stop that is chosen in a lane
   * @param {(stop: string, vehicle: string) => void} onServe called with a stop and the vehicles that are to serve it
   */
  constructor(onChoose, onServe) {
    const serveBy = new ServeBy(onServe);
    this.#lanes = new Lanes(element("fleet-lanes"), (lane, at) => this.#chosen.choose({ lane, at }));
    this.#chosen = new ChosenVisit(element("fleet-stop"), this.#lanes, onChoose, (stop) => serveBy.show(stop, knownFleet(this.#editable ? this.#asked : {})));
  }

  /** Takes the request whose plans will be shown; `editable` says whether it can be changed. */
  open(asked, editable) {
    this.#asked = asked;
    this.#customerOf = customersIn(asked);
    this.#editable = editable;
    this.show(null);
  }

  /** Takes other details of the stops. */
  retell(asked) {
    this.#asked = asked;
    this.#customerOf = customersIn(asked);
    this.name(this.#objectives);
  }

  /** Sets the names of the lengths. */
  name(objectives) {
    this.#objectives = objectives;
    const plan = this.#plan;
    this.show(null);
    if (plan?.lengths.length === objectives.length) this.show(plan, this.#movers);
  }

  /** When a stop is visited, in words, if it is visited once; "" if that is not known. */
  hourOf(stop) {
    return (this.#plan && this.#hours.get(stop)) ?? "";
  }

  /** Takes the stop that is chosen on a map; null if none is. */
  choose(stop) {
    this.#chosen.chooseStop(stop);
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
    const known = knownFleet(this.#asked);
    const names = namesOf(plan.routes, movers, this.#asked);
    const times = timetable(plan.routes, names, this.#asked);
    showLegend(element("fleet-legend"), plan, movers, this.#asked, this.#objectives, { names, ...times });
    this.#showTimes(plan, names, times);
    element("fleet-left-out-title").textContent = reason(plan, this.#objectives);
    list("fleet-left-out", leftOut(plan, known.stops, this.#customerOf, this.#objectives));
  }

  /** Shows a lane for each vehicle if the plan has times, and the stops of each vehicle in order. */
  #showTimes(plan, names, { lanes, clock }) {
    const { routes } = plan;
    this.#hours = hoursByStop(lanes, clock);
    this.#lanes.show(lanes, clock);
    this.#chosen.show(plan, lanes, clock);
    showSigns(lanes);
    const visit = (stop, time) => visitItem(withCustomer(nameOfStop(stop), this.#customerOf(nameOfStop(stop))), time && arrivalIn(time, clock.said));
    const visits = (route, lane) => route[this.#movers.through].map((stop, at) => visit(stop, lanes[lane]?.visits[at]));
    element("fleet-stops").replaceChildren(...routes.map((route, at) => listed(names[at], visits(route, at))));
  }
}

/** When each stop is visited, by its id: not of those at which vehicles start, load and end. */
const hoursByStop = (lanes, clock) =>
  new Map(lanes.flatMap(({ visits }) => visits.filter(({ kind }) => kind === "visit").map((visit) => [visit.stop, arrivalIn(visit, clock.said)])));

/** Shows what the signs in the lanes mean, of those that there are. */
function showSigns(lanes) {
  const visits = lanes.flatMap((lane) => lane.visits);
  const there = {
    drives: visits.length,
    visits: visits.length,
    waits: visits.some(({ waiting }) => waiting),
    loads: visits.some(({ kind }) => kind === "loading"),
    late: visits.some(({ late }) => late),
    tight: visits.some(({ closing }) => closing),
    windows: visits.some(({ windows }) => windows.length),
  };
  for (const [name, shown] of Object.entries(there)) element("fleet-signs").querySelector(`.${name}`).hidden = !shown;
  element("fleet-signs").hidden = !visits.length;
}

/** Stops of a fleet have ids; places of robots are numbered from 1. */
const nameOfStop = (stop) => (typeof stop === "number" ? nameOf(null, stop) : stop);

/** The numbered stops of one vehicle or robot, below its name. */
function listed(name, visits) {
  const [item, stops] = [document.createElement("li"), document.createElement("ol")];
  stops.append(...visits);
  item.append(Object.assign(document.createElement("b"), { textContent: name }), stops);
  return item;
}

function list(id, texts) {
  element(id).replaceChildren(...texts.map((textContent) => Object.assign(document.createElement("li"), { textContent })));
}
