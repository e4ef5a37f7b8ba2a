/** Show a front: chart, slider, figures and maps, which select a tour together. */

import { FrontChart } from "../chart/chart.js";
import { Asking } from "./asking.js";
import { inFull, lessOf } from "../common/amounts.js";
import { choiceKept, choiceOf } from "./choice.js";
import { placeIn } from "./chosen.js";
import { compare } from "./comparison.js";
import { showFigures, showTourFigures } from "./figures.js";
import { Growth } from "../chart/growth.js";
import { customersIn, withCustomer } from "../inputs/details.js";
import { nameOf } from "../inputs/places.js";
import { shadeOf } from "../map/gridmap.js";
import { showGround } from "../map/key.js";
import { Maps } from "../map/maps.js";
import { roundOf } from "../map/planes.js";
import { kindNamed, kindOf } from "../common/kinds.js";
import { measuresOf } from "../fleet/measures.js";
import { onTimeSaid } from "../fleet/spread.js";
import { PlanView } from "../fleet/plan_view.js";
import { lastBack } from "../fleet/timetable.js";
import { hoursOf } from "../fleet/times.js";
import { visitItem } from "../common/elements.js";
import { UNNAMED } from "../common/objectives.js";
import { BalanceSlider } from "../chart/slider.js";
import { RoutedWay, pathOfWays } from "../map/ways/routed_way.js";
import { SeveralObjectives } from "./several.js";
import { nearest } from "./tours.js";
import { showUnreached } from "./unreached.js";

const MIDDLE = 0.5; // the middle balance

const element = (id) => document.getElementById(id);

export class Result {
  #maps;
  #chart;
  #growth;
  #slider;
  #several;
  #planView;
  #asking;
  #asked = {}; // the request, as far as it is known
  #customerOf = () => ""; // of a stop, by its name
  #kind = kindOf({}); // of the front
  #front = [];
  #closed = true;
  #before = null; // the tour that was replanned, and whether it was closed
  #balance = MIDDLE; // the balance that the viewer chose
  #linked = null; // the tour or plan of the link that was opened, until the viewer chooses another
  #kept = false; // whether a link carried what is shown, and the service no longer keeps its front
  #selected = null;
  #previewed = null; // pointed at on the chart
  #pinned = null;
  #frame = 0;
  #objectives = UNNAMED;
  #ids = null; // of the stops
  #id = null; // the id of the front, once it is final
  #routed = null; // set if the service has a routing engine
  #onSelected;

  /**
   * @param {Service} service the service that asks which tour is best
   * @param {object} edited callbacks for clicks on the maps, for stops moved and deleted: see Maps; `onServe`: see PlanView; and
   *   `onSelected`, called with the tour or plan that is selected, and its number
   */
  constructor(service, edited) {
    this.#onSelected = edited.onSelected;
    this.#planView = new PlanView((stop) => this.#maps.choose(stop), edited.onServe);
    const onSelect = (index) => this.#choose(index);
    const more = (stop) => [this.#customerOf(stop), this.#planView.hourOf(stop)];
    this.#maps = new Maps({ ...edited, more, onChoose: (stop) => this.#planView.choose(stop) });
    const onPreview = (index) => this.#preview(index);
    const told = { onSelect, onPreview, onBudget: (index) => this.#choose(index) };
    this.#chart = new FrontChart(element("front-chart"), element("front-labels"), told);
    this.#several = new SeveralObjectives({ onSelect, onPreview });
    this.#growth = new Growth(element("growth"), element("growth-help"));
    this.#slider = new BalanceSlider(element("balance"), element("balance-shown"), onSelect);
    this.#asking = new Asking(service, onSelect);
    element("pin").addEventListener("click", () => this.#pin());
    element("order").addEventListener("toggle", () => this.#order());
    this.clear({});
  }

  /** Sets the names of both lengths, and of the stops if they have ids. */
  name(objectives, ids = null) {
    this.#objectives = objectives;
    this.#ids = ids;
    this.#maps.name(objectives, ids);
    this.#planView.name(objectives);
    if (objectives.length > 2) return;
    this.#chart.name(objectives);
    this.#slider.name(objectives);
    objectives.forEach((objective, plane) => {
      element(`less-${plane + 1}`).textContent = lessOf(objective);
    });
  }

  /** An instance without a front; `editable` says whether its stops may be changed on the maps. */
  clear(instance, { fit = true, editable = true } = {}) {
    cancelAnimationFrame(this.#frame);
    this.#maps.show(instance, fit, editable);
    this.#planView.open(instance, editable);
    this.#asked = instance;
    this.#customerOf = customersIn(instance);
    this.#kind = kindOf(instance);
    showUnreached(null);
    this.#sayShade(instance);
    this.#front = [];
    this.#id = null;
    this.#balance = MIDDLE;
    this.#linked = null;
    this.#keep({ kept: false });
    this.#selected = this.#pinned = this.#previewed = this.#before = null;
    this.#chart.mark("driven", null);
    this.#several.mark("driven", null);
    this.#legend("driven", false);
    this.#chart.show([], [], this.#kind.noun, isPlannable(instance));
    this.#legend("alone", false);
    this.#legend("improved", false);
    this.#growth.show([]);
    this.#slider.show([], this.#kind.noun);
    this.#several.hide();
    this.#asking.show(null);
    this.#drawPin();
    this.#draw();
    showFigures(element("figures"), null, null);
  }

  /** Takes other details of the stops, of which nothing else is another. */
  retell(instance) {
    this.#customerOf = customersIn(instance);
    this.#planView.retell(instance);
  }

  /** Shades a robot's map by the cost layer that the request names. */
  shade = (request) => {
    this.#maps.shade(request);
    this.#sayShade(request);
  };

  #sayShade(instance) {
    const dear = shadeOf(instance ?? {}) && this.#objectives[1 + (instance.shaded ?? 0)].name;
    showGround(element("ground"), { unknown: instance?.unknownCells, dear });
  }

  /** Shows other ends of the tours on a robot's map. */
  showEnds = (request) => this.#maps.showEnds(request);

  /** Shows the front of the network alone, if it is known, and the best front so far. */
  show({ stage, alone, answer, growth, again = false }) {
    this.#kind = kindNamed(answer);
    this.#keep({ kept: stage === "kept", again });
    this.#front = answer.front;
    this.#id = ["done", "cancelled"].includes(stage) ? answer.id : null;
    this.#previewed = null;
    this.#closed = answer.closed !== false;
    this.#growth.show(growth);
    this.#showDriven(answer);
    element("front-chart").parentElement.hidden = false;
    if (this.#objectives.length > 2) this.#several.show(answer.front, this.#objectives, this.#kind.noun);
    else this.#showBoth(alone, answer);
    this.#maps.place(answer.places, answer.uncovered);
    showUnreached(answer.uncovered, this.#asked.cell_size);
    element("tour-title").textContent = this.#kind.movers ? "Selected plan" : "Tour";
    if (this.#front.length) this.#select(this.#wanted);
    const isChoice = this.#id && this.#front.length > 1;
    this.#asking.show(isChoice ? { id: this.#id, objectives: this.#objectives, noun: this.#kind.noun } : null);
    showFigures(element("figures"), alone, this.#kept ? null : answer);
  }

  /** Marks the rest of the plan that is driven, if a front is beside one, and says what it is. */
  #showDriven({ driven: lengths, drivenSaid = "" }) {
    this.#mark("driven", lengths ? { lengths } : null);
    this.#legend("driven", Boolean(lengths));
    element("legend").querySelector(".driven").textContent = drivenSaid;
  }

  /** Notes whether a link carried what is shown, and offers to plan it `again`. */
  #keep({ kept, again = false }) {
    this.#kept = kept;
    element("plan-again").hidden = !(kept && again);
  }

  /** Shows a front of two objectives on its chart. */
  #showBoth(alone, answer) {
    // Until the search has found something, the best front so far is the network's.
    const improved = answer.front === alone?.front ? [] : answer.front;
    element("front-chart").parentElement.hidden = this.#kept && !alone;
    this.#chart.show(alone?.front ?? [], improved, this.#kind.noun, true, this.#kept);
    this.#legend("alone", alone !== null && this.#chart.sees(alone.front));
    element("legend").querySelector(".alone").textContent = this.#kept ? "others, no longer kept" : "first result";
    this.#legend("improved", improved.length > 0 && !this.#kept);
    this.#slider.show(answer.front, this.#kind.noun);
  }

  /** The tour to select in a front that is shown. */
  get #wanted() {
    const linked = this.#linked ? placeIn(this.#front, this.#linked) : -1;
    if (linked >= 0) return linked;
    if (this.#objectives.length > 2) return this.#several.middle;
    return this.#chart.budget.index ?? nearest(this.#front, this.#balance);
  }

  /** The tour that is shown. */
  get selected() {
    return this.#selected;
  }

  /** Draws map tiles under stops where the service names any, and tours along the streets where it has an engine. */
  equip({ tiles, credit, roads }, service) {
    this.#maps.tile({ url: tiles, credit });
    if (roads) this.#routed = new RoutedWay(service, this.#maps.ways, () => this.#redraw());
  }

  /** Draws what lies around the stops, from now on: `streets`, `places` by name, and the `legs` of tours. */
  surround(surroundings) {
    this.#maps.surround(surroundings);
    this.#redraw();
  }

  #redraw() {
    this.#drawPin();
    this.#draw();
  }

  /** Rings a clicked place that is not a stop yet; null removes the rings. */
  wait = (plane, place) => this.#maps.wait(plane, place);

  /** The tour or plan to select in the next front, or if it is not there, the balance; and the limits on the objectives. */
  want(balance, linked = null, limits = null) {
    this.#balance = balance ?? MIDDLE;
    this.#linked = linked;
    if (limits?.length > 2) this.#several.want(limits);
    else if (Array.isArray(limits)) this.#chart.want(limits);
  }

  /** What is exported: a picture, the selected tour or plan with its balance, and whether its lines can follow the streets. */
  get taken() {
    const driven = Boolean(this.#routed) && this.#maps.driven;
    const movers = this.#kind.movers ?? null;
    const selected = this.#selected && { item: this.#selected, round: movers ? [] : this.#names(), movers };
    const all = this.#objectives.length > 2 ? this.#several.limits : this.#chart.budget.limits;
    const limits = all.some(Number.isFinite) ? all : undefined;
    return { picture: this.#selected && this.#picture, balance: this.#selected?.balance, limits, driven, selected };
  }

  /** The names of the stops of the selected tour, back to its start where it is closed. */
  #names() {
    const names = named(this.#selected, this.#ids);
    return roundOf(names, this.#closed && names.length > 1);
  }

  get #picture() {
    const lines = [this.#pinned ?? this.#before, this.#selected].filter(Boolean);
    const tours = lines.map((item) => ({ item, cities: this.#round(item), dashed: item !== this.#selected }));
    const maps = this.#maps.pictures(tours);
    const choice = this.#said(this.#selected);
    const limits = this.#objectives.length > 2 ? this.#several.limitsShown : this.#chart.budget.limits;
    return { front: this.#front, selected: this.#selected, choice, objectives: this.#objectives, limits, maps };
  }

  /** What is said of a tour or plan. */
  #said(item) {
    const said = this.#kept ? choiceKept(this.#kind.noun) : choiceOf(this.#front, item, this.#objectives, this.#kind.noun);
    return `${said}${this.#kind.movers ? `${onTimeSaid(item)}${lastBack(item, this.#asked)}` : ""}`;
  }

  /** The cities of a tour, back to its start if it is closed; none for a plan. */
  #round({ tour = [], closed = this.#closed }) {
    return roundOf(tour, closed);
  }

  /** Keeps the selected tour on the maps while the rest of it is planned; of a plan, what is driven is drawn by `pass`. */
  replan(instance, names) {
    element("result").scrollIntoView();
    const before = this.#selected?.tour ? { tour: this.#selected.tour, closed: this.#closed } : null;
    this.clear(instance, { fit: false, editable: false });
    this.#ids = names;
    this.#maps.name(this.#objectives, names);
    this.#before = before;
    this.#drawPin();
  }

  #choose(index) {
    this.#balance = this.#front[index].balance ?? MIDDLE;
    this.#linked = null;
    this.#select(index);
  }

  #select(index) {
    this.#selected = this.#front[index];
    this.#previewed = null;
    if (this.#objectives.length === 2) this.#slider.select(index);
    this.#drawSoon();
  }

  /** Shows a tour in place of the selected one, until it is selected or left. */
  #preview(index) {
    const previewed = index === null ? null : this.#front[index];
    if (previewed === this.#previewed) return;
    this.#previewed = previewed;
    this.#drawSoon();
  }

  /** Draws once per frame, even if the slider or the pointer moves more often. */
  #drawSoon() {
    cancelAnimationFrame(this.#frame);
    this.#frame = requestAnimationFrame(() => this.#draw());
  }

  #pin() {
    this.#pinned = this.#pinned ? null : this.#selected;
    this.#drawPin();
    this.#draw();
  }

  #drawPin() {
    element("pin").textContent = this.#pinned ? "Stop comparing" : "Keep to compare";
    this.#legend("pinned", this.#pinned !== null);
    this.#mark("pinned", this.#pinned);
    this.#legend("before", this.#before !== null);
    const dashed = this.#pinned ?? this.#before;
    this.#maps.draw("pinned", dashed, dashed?.closed ?? this.#closed);
  }

  #draw() {
    const shown = this.#previewed ?? this.#selected;
    element("pin").disabled = !this.#selected;
    this.#legend("selected", shown !== null);
    this.#mark("selected", this.#selected);
    element("budget").textContent = this.#chart.budget.said;
    this.#mark("previewed", this.#previewed);
    this.#maps.draw("selected", shown, this.#closed);
    this.#planView.show(this.#kind.movers ? shown : null, this.#kind.movers);
    const measures = shown ? measuresOf(shown, this.#objectives, this.#asked) : [];
    compare(element("comparison"), this.#objectives, shown, this.#pinned, measures, { movers: this.#kind.movers ?? null, asked: this.#asked });
    showTourFigures(element("tour-figures"), shown);
    element("choice").textContent = shown ? this.#said(shown) : "";
    for (const objective of [0, 1]) {
      const said = shown ? inFull(shown.lengths[objective], this.#objectives[objective]) : "";
      element(`length-${objective + 1}`).textContent = said;
    }
    this.#order();
    this.#follow();
    if (this.#selected) this.#onSelected(this.#selected, this.#front.indexOf(this.#selected));
  }

  /** Draws in grey what the vehicles of a fleet have driven: see Maps. */
  pass = (...driven) => this.#maps.pass(...driven);

  /** The places along a way through stops by their ids: see Maps. */
  along = (stops) => this.#maps.along(stops);

  /** Requests the ways along the streets of the selected tour or plan, once its front is final. */
  #follow() {
    const item = this.#selected;
    if (!item || !this.#id || !this.#maps.driven) return this.#routed?.forget();
    this.#routed?.want(pathOfWays(this.#id, this.#kind, item, this.#front.indexOf(item)), this.#maps.waysOf(item, this.#closed));
  }

  /** Marks a tour on the chart that is shown; null removes the mark. */
  #mark(name, item) {
    const chart = this.#objectives.length > 2 ? this.#several : this.#chart;
    chart.mark(name, item?.lengths ?? null);
  }

  /** Says what a colour on the chart means, while it is there. */
  #legend(name, there) {
    element("legend").querySelector(`.${name}`).hidden = !there;
  }

  /** The order of a tour's stops; of a plan each vehicle has its own. */
  #order() {
    element("order").hidden = !this.#selected || Boolean(this.#kind.movers);
    if (!element("order").open || element("order").hidden) return;
    const hours = hoursOf(this.#selected);
    element("order").querySelector("ol").replaceChildren(...this.#names().map((name, at) => visitItem(withCustomer(name, this.#customerOf(name)), hours[at])));
  }
}

/** Whether there is anything to plan: a robot's map, or stops. */
const isPlannable = ({ grid, coordinates, stops, matrices }) => Boolean(grid ?? (coordinates ?? stops ?? matrices)?.length);

/** The names of the stops of a tour, in its order. */
function named(tour, ids) {
  if (!tour) return [];
  return !ids && tour.stops ? tour.stops : tour.tour.map((city) => nameOf(ids, city));
}
