/** A fleet's day while a plan of it is driven: what is done by now, what has changed, and the plan of what is left. */

import { amount } from "../common/amounts.js";
import { SECONDS, timeText } from "../common/durations.js";
import { kindNamed } from "../common/kinds.js";
import { changesAsked, showFew } from "./few_changes.js";
import { withText } from "../fleet/cells.js";
import { knownFleet } from "../fleet/known_fleet.js";
import { stylesOf } from "../fleet/route_styles.js";
import { namesOf } from "../fleet/routes_of_plan.js";
import { clockUnit } from "../fleet/units.js";
import { customersIn } from "../inputs/details.js";
import { rounded } from "../inputs/places.js";
import { pastedFile } from "../opening/reading.js";
import { showFaults } from "../planning/faults.js";
import { Remedies, patched } from "../planning/remedies.js";
import { changesOf } from "./changes.js";
import { Offers } from "./offers.js";
import { Orders } from "./orders.js";
import { progressOf, travelled } from "./progress.js";
import { FleetRest, bodyOf } from "./rest.js";
import { doneSaid, loadingSaid, vanSaid } from "./said.js";
import { showChanges } from "./show_changes.js";
import { VanList } from "./van_list.js";

export { restIn } from "./linked_rest.js";

const element = (id) => document.getElementById(id);
const { movers: VEHICLES } = kindNamed({ kind: "fleet" });
const PLANNED = { now: null, turned: new Set() }; // of a plan that has not begun
const TIME = "Write a time, as 11:00.";
const MINUTE = 60; // seconds

export class Today {
  #result;
  #list;
  #orders;
  #offers;
  #remedies;
  #chosen = []; // the changes that were chosen of those that would help
  #found = null; // the front whose plans may be driven, `{ state, way, asked }`
  #driven = null; // the plan that is driven
  #proposed = null; // what is proposed instead, `{ state, way, plan, at }`
  #now = null; // in the unit of the clock
  #turned = new Set(); // stops that are done though they are not by the plan, or the other way round
  #cancelled = new Set(); // stops
  #out = new Set(); // vehicles out of service, by name
  #vans = []; // how far they have come
  #clock = null;
  #past = []; // the lines of what was driven before the plan that is driven
  #lines = []; // and by that plan

  /**
   * @param {Result} result shows the plans, and draws what is driven
   * @param {{ onReplan: () => void, onBack: (found: object, plan: object) => void }} told
   */
  constructor(service, result, { onReplan, onBack }) {
    this.#result = result;
    const turn = (set) => (each) => {
      if (!set.delete(each)) set.add(each);
      this.#draw();
    };
    this.#list = new VanList(element("vans"), element("vans-key"), { onTurn: turn(this.#turned), onCancel: turn(this.#cancelled), onOut: turn(this.#out) });
    this.#orders = new Orders(service, result.wait);
    this.#offers = new Offers(service, () => ({ ...this.asked, asked: this.#driven.asked, clock: this.#clock }), (row, window) => this.#orders.promise(row, window));
    element("today").addEventListener("toggle", () => this.#open());
    element("today-now").addEventListener("change", ({ target }) => this.#readNow(target.value.trim()));
    const replan = (chosen) => {
      this.#chosen = chosen;
      this.#remedies.clear();
      onReplan();
    };
    this.#remedies = new Remedies(element("today-remedies"), ({ patch }) => replan([...this.#chosen, ...patch]));
    element("replan-fleet").addEventListener("click", () => replan([]));
    // They are of the day as it was when it was refused.
    for (const kind of ["input", "click"]) element("today").addEventListener(kind, ({ target }) => target.closest("#today-remedies") || this.#remedies.clear());
    element("drive").addEventListener("click", () => this.#drive());
    element("to-driven").addEventListener("click", () => onBack(this.#found, this.#driven.item));
    addEventListener("paste", (event) => this.#paste(event), { capture: true });
  }

  /** Takes a front of a fleet that is final, `{ state, way, asked }`: of what is left of the plan that is driven, or of a day; null takes all away. */
  show(found) {
    if (found?.way && found.way.driven === this.#driven) this.#proposed = found;
    else if (found && found.state.answer.id === this.#found?.state.answer.id) this.#proposed = null;
    else this.#begin(found);
  }

  /** A day on which nothing has changed yet. */
  #begin(found) {
    this.#found = found;
    this.#driven = this.#proposed = null;
    for (const each of [this.#turned, this.#cancelled, this.#out]) each.clear();
    [this.#vans, this.#lines] = [[], []];
    if (!found?.way) this.#past = [];
    element("today").hidden = !found;
    element("changes").hidden = true;
    if (!found) return (element("today").open = false);
    this.#orders.open(found.asked);
    this.#offers.clear();
    element("offer").hidden = !found.asked.clock || !this.#orders.canAdd;
    element("today-clock").hidden = !found.asked.clock;
    if (!found.asked.clock) this.#now = null;
    this.#showHand(found.asked);
    showFew(found.asked);
  }

  /** Asks whether vehicles that are late may use up the time to spare, if there is any. */
  #showHand({ slack, ...asked }) {
    const label = element("today-hand");
    label.hidden = !slack;
    label.control.checked = false;
    label.lastChild.data = ` Vehicles that are late may use up the ${amount(slack ?? 0, { measure: "waiting", unit: clockUnit(asked) })} to spare before windows close`;
  }

  /** Takes the plan that is selected, and its number in the front: it is driven, unless it is proposed. */
  select(plan, at) {
    if (!plan || !this.#found) return;
    if (this.#proposed) Object.assign(this.#proposed, { plan, at });
    else this.#driven = { item: plan, at, routes: plan.routes, names: namesOf(plan.routes, VEHICLES, this.#found.asked), asked: this.#found.asked };
    this.#draw();
  }

  clicked(...place) {
    this.#orders.clicked(...place);
  }

  /** What is asked of the service: the `id` of the front, the `body`, and the `way` by which the rest is shown. Throws a Problem where something cannot be read. */
  get asked() {
    const added = this.#orders.added;
    const day = { vans: this.#vans, now: this.#now, nowSaid: this.#now === null ? "" : this.#clock.said(this.#now), out: new Set(this.#out), removed: new Set(this.#cancelled), added, told: this.#orders.told, isHandFree: !element("today-hand").hidden && element("today-hand").control.checked, changes: changesAsked(this.#driven.asked) };
    const body = patched(bodyOf(this.#driven, day), this.#chosen);
    return { id: this.#found.state.answer.id, body, way: new FleetRest(this.#driven, body, day) };
  }

  /** Says why the rest was not planned, and what would help. */
  refuse(problem) {
    showFaults(problem, "today");
    this.#remedies.show(problem);
  }

  #open() {
    const { clock } = this.#found?.asked ?? {};
    if (element("today").open && clock && !element("today-now").value) this.#proposeNow();
    this.#draw();
  }

  /** The time of day, if it lies within the plan. */
  #proposeNow() {
    const second = SECONDS.get(clockUnit(this.#found.asked));
    const { clock } = this.#driven ? progressOf(this.#driven, PLANNED) : {};
    const date = new Date();
    const seconds = MINUTE * (MINUTE * date.getHours() + date.getMinutes());
    if (!second || !clock || seconds < clock.from * second || seconds > clock.to * second) return;
    element("today-now").value = timeText(seconds);
    this.#now = seconds / second;
  }

  #readNow(text) {
    const { now = null } = withText({}, { member: "now", type: "time" }, text, SECONDS.get(clockUnit(this.#found.asked)));
    const isRead = typeof now !== "string";
    element("today-now").toggleAttribute("aria-invalid", !isRead);
    element("today-now-fault").textContent = isRead ? "" : TIME;
    if (!isRead) return;
    this.#now = now;
    this.#draw();
  }

  /** Shows how far the vehicles have come, and what would change for them. */
  #draw() {
    if (!this.#driven) return;
    const isOpen = element("today").open;
    if (isOpen) this.#drawVans();
    this.#result.pass(isOpen ? [...this.#past, ...this.#lines] : [], isOpen && Boolean(this.#proposed?.plan) && this.#cancelled.size > 0);
    element("changes").hidden = !this.#proposed?.plan;
    if (this.#proposed?.plan) this.#drawChanges();
  }

  #drawVans() {
    const { routes, asked } = this.#driven;
    const { vans, clock } = progressOf(this.#driven, { now: this.#now, turned: this.#turned });
    const [styles, known] = [stylesOf(routes, asked), knownFleet(asked)];
    this.#clock = clock;
    this.#lines = [];
    this.#vans = vans.map((van, at) => {
      const line = this.#lineOf(routes[at], van);
      if (line) this.#lines.push({ places: line, tip: van.isBack ? null : styles[at].colour, out: this.#out.has(van.name) ? { name: van.name, style: styles[at] } : null });
      const said = vanSaid(van, { isOutOfService: this.#out.has(van.name), clock, known, vehicle: routes[at].vehicle });
      return { ...van, style: styles[at], said, tip: line?.at(-1).map(rounded) };
    });
    element("today-done").textContent = doneSaid(vans, this.#now, !this.#turned.size);
    element("today-loading").textContent = loadingSaid(this.#vans, routes, asked, this.#out);
    this.#list.show(this.#vans, { clock, out: this.#out, removed: this.#cancelled });
  }

  /** The line that a vehicle has driven; null without a map, or before the vehicle leaves. */
  #lineOf({ stops }, { isOut, at, share }) {
    const found = isOut && this.#result.along(stops);
    return found ? travelled(found.way, found.places, at, share) : null;
  }

  #drawChanges() {
    const { plan, way } = this.#proposed;
    const { asked, day } = way;
    const { vans, clock } = progressOf({ routes: plan.routes, names: namesOf(plan.routes, VEHICLES, asked), asked }, PLANNED);
    showChanges(changesOf(day.vans, vans, clock?.second ? clock : null, { ...day, unassigned: plan.unassigned ?? [], customerOf: customersIn(asked) }));
  }

  /** Has the proposed plan driven from now on. */
  #drive() {
    const { plan, at, ...found } = this.#proposed;
    this.#past = [...this.#past, ...this.#lines.map((line) => ({ ...line, tip: null }))];
    this.#begin(found);
    this.select(plan, at);
    element("today").scrollIntoView({ block: "nearest" });
  }

  /** Takes a table that is pasted anywhere but into the form, which is of the whole day. */
  #paste(event) {
    const { open, hidden } = element("today");
    if (!open || hidden || !this.#orders.canAdd || element("request").contains(event.target)) return;
    const text = event.clipboardData.getData("text");
    const file = this.#orders.fills(event.target, text) ? null : pastedFile(text);
    if (!file) return;
    event.preventDefault();
    event.stopPropagation();
    this.#orders.paste(file);
  }
}
