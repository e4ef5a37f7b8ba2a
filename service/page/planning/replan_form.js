/** The fields for what has changed since a tour was planned. */

import { isMeasured } from "../inputs/stops.js";
import { Placing } from "../inputs/placing.js";

const element = (id) => document.getElementById(id);

export class ReplanForm {
  #added = [];
  #vehicle = null;
  #way = null;
  #vehicles = 0; // added places so far, each with a different id
  #placings;

  /**
   * @param {() => void} onReplan called to plan the rest
   * @param {(plane: number, place: number[] | null) => void} onWaiting as of Placing
   */
  constructor(onReplan, onWaiting) {
    const help = element("replan-help");
    this.#placings = [
      new Placing(element("place-vehicle"), help, (row) => this.#drive(row), onWaiting, { once: true }),
      new Placing(element("place-added"), help, (row) => this.#add(row), onWaiting, { once: true }),
    ];
    element("replan").addEventListener("click", onReplan);
  }

  /** Offers to replan the tours of a way; null where there is none. */
  show(way) {
    this.#way = way;
    this.#added = [];
    this.#vehicle = null;
    element("replanning").hidden = !way;
    for (const id of ["at", "removed", "added"]) element(id).value = "";
    element("now").value = "";
    element("now-field").hidden = way?.instance.departure == null;
    const placed = way && (way.instance.coordinates || isMeasured(way.instance));
    for (const id of ["place-vehicle", "place-added", "added-field"]) element(id).hidden = !placed;
    for (const placing of this.#placings) placing.stop();
    this.#say();
  }

  clicked(...place) {
    for (const placing of this.#placings) placing.clicked(...place);
  }

  get changes() {
    const names = element("removed").value.split(",").map((name) => name.trim());
    return { at: element("at").value.trim(), now: element("now").value.trim(), removed: names.filter(Boolean), added: this.#added, vehicle: this.#vehicle };
  }

  /** The places that are not stops of the front yet. */
  get places() {
    return [...this.#added, ...(this.#vehicle ? [this.#vehicle] : [])];
  }

  #drive(row) {
    this.#vehicles += 1;
    this.#vehicle = { id: this.#vehicles > 1 ? `vehicle ${this.#vehicles}` : "vehicle", row };
    this.#say();
  }

  #add(row) {
    const id = element("added").value.trim() || `new ${this.#way.names.length + this.#added.length + 1}`;
    this.#added = [...this.#added, { id, row }];
    element("added").value = "";
    this.#say();
  }

  #say() {
    const said = this.places.map(({ id, row }) => `${id} at ${row.join(", ")}`);
    element("replan-help").textContent = said.length ? `Stops to add: ${said.join("; ")}.` : "";
  }
}
