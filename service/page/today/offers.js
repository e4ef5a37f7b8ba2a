/** Offer a time for a new order: which slots are possible beside the plan that is driven, and what each costs. */

import { comparedAlike } from "../common/amounts.js";
import { SECONDS } from "../common/durations.js";
import { made } from "../common/elements.js";
import { isMetres, namesIn, withUnit } from "../common/objectives.js";
import { clockUnit, withUnits } from "../fleet/units.js";
import { Problem } from "../planning/service.js";

const element = (id) => document.getElementById(id);
const [HOUR, DAY] = [3600, 86400]; // seconds

/** The row of the last order that has no time yet; -1 if all have one. */
export const openRow = (orders) => orders.findLastIndex(({ window, windows = [] }) => !window && !windows.length);

/**
 * What is asked of the service: the last order without a time, every hour until the last vehicle is back.
 *
 * @param {object} body the request to replan, with all new orders
 * @param {object} asked the request that the plan is of
 */
export function offersBody({ add, seed, time_limit, ...body }, asked) {
  const row = openRow(add);
  const second = SECONDS.get(clockUnit(asked)) ?? 1;
  const shifts = asked.vehicles.flatMap(({ shift, shifts = [] }) => (shift ? [shift] : shifts));
  const from = Math.max(body.now ?? 0, shifts.length ? Math.min(...shifts.map(([begin]) => begin)) : 0);
  const to = shifts.length === 0 ? DAY / second : Math.max(...shifts.map(([, end]) => end));
  const begin = Math.floor((from * second) / HOUR) * (HOUR / second);
  return { ...body, add: add.toSpliced(row, 1), order: add[row], every: { from: begin, to, length: HOUR / second } };
}

/** The rows of a table of offers: when, such as "9:00–10:00", and by how much each objective rises, such as "+1.2 km" or "same". */
export function offersSaid(offers, objectives, clock) {
  const least = (objective) => (isMetres(objective) ? 1 : 1e-9);
  const risen = objectives.map((objective, m) => {
    const rises = offers.map(({ choices }) => choices[0].rise[m]);
    const sizes = comparedAlike(rises.map(Math.abs), objective);
    return rises.map((rise, at) => (Math.abs(rise) < least(objective) ? "same" : `${rise < 0 ? "−" : "+"}${sizes[at]}`));
  });
  return offers.map(({ slot }, at) => [slot.map(clock.said).join("–"), ...risen.map((column) => column[at])]);
}

export class Offers {
  #service;

  /**
   * @param {() => { id: string, body: object, asked: object, clock: object }} day throws a Problem where something cannot be read
   * @param {(row: number, window: number[]) => void} onTake
   */
  constructor(service, day, onTake) {
    this.#service = service;
    element("offer").addEventListener("click", () => this.#ask(day, onTake));
  }

  clear() {
    element("offers").replaceChildren();
    element("offers").hidden = true;
    element("offers-said").textContent = "";
  }

  async #ask(day, onTake) {
    this.clear();
    try {
      const { id, body, asked, clock } = day();
      const row = openRow(body.add);
      if (row < 0) return this.#say("Add an order without a window, and its place.");
      const { offers, objectives } = await this.#service.post({ path: `front/${id}/offers`, body: offersBody(body, asked) });
      const possible = offers.filter((each) => each.possible);
      const units = withUnits(namesIn({ objectives }), asked);
      this.#say(possible.length ? `${body.add[row].id} can be visited in any of these hours; beside each stands what it adds to the plan. Press the hour that you promise to the customer, then “Replan the rest of the day”.` : `${body.add[row].id} cannot be visited in any hour.`);
      const take = ({ slot }) => {
        this.clear();
        onTake(row, slot);
      };
      this.#show(offersSaid(possible, units, clock), units, (at) => take(possible[at]));
    } catch (error) {
      if (!(error instanceof Problem)) throw error;
      this.#say(`No times: ${error.message}.`);
    }
  }

  #show(rows, units, take) {
    if (!rows.length) return;
    const heads = ["Hour", ...units.map(withUnit)].map((title) => made("th", { scope: "col" }, title));
    const press = (said, at) => made("th", { scope: "row" }, made("button", { type: "button", onclick: () => take(at) }, `Promise ${said}`));
    const lines = rows.map(([said, ...rises], at) => made("tr", {}, press(said, at), ...rises.map((rise) => made("td", {}, rise))));
    element("offers").replaceChildren(made("thead", {}, made("tr", {}, ...heads)), made("tbody", {}, ...lines));
    element("offers").hidden = false;
  }

  #say(text) {
    element("offers-said").textContent = text;
  }
}
