/** The form of a fleet: the tables of its stops and vehicles, what is traded, and the columns to add. */

import { isRead, tellFault } from "../planning/faults.js";
import { counted } from "../common/numbers.js";
import { detailColumns, withDetail } from "../inputs/details.js";
import { EditableTable } from "../inputs/table.js";
import { ObjectiveFields, isSpeedRead } from "../inputs/objective_fields.js";
import { nearest } from "../common/nearest.js";
import { cellText, headed, hintOf, isUnread, rowOf, secondsIn, unknownIn, withText } from "./cells.js";
import { EverydayForm } from "./everyday_form.js";
import { columnsOf, isShown } from "./columns.js";
import { vehiclesIn } from "./fleet_request.js";
import { byIds, vehicleRenamed, withVehicle } from "./references.js";
import { percentTyped, variesBy, varyingBy } from "./spread.js";
import { AGAINST, againstOf, alsoAgainst, doubtOfTimes, isTraded, timedBy, timesOf, tradedAgainst, tradedAlsoAgainst } from "./trade.js";

const element = (id) => document.getElementById(id);
const TIMES = { "": "There are no times", first: "Those of the first objective", second: "Those of the second objective", own: "Times of their own" };

export class FleetForm {
  #onChange;
  #stops;
  #vehicles;
  #objectives;
  #clock;
  #everyday;
  #asked = null; // the request of the fleet; null if there is none
  #added = { stops: new Set(), vehicles: new Set() }; // members whose columns are shown though they are empty

  /**
   * @param {EditableTable} stops the table of stops
   * @param {(asked: object, isRead?: boolean) => void} onChange called with the changed request, and whether it is understood
   */
  constructor(stops, onChange) {
    this.#stops = stops;
    this.#onChange = onChange;
    this.#vehicles = new EditableTable(
      element("vehicles"),
      {
        onName: (row, text) => onChange(vehicleRenamed(this.#asked, row, text)),
        onCells: (cells) => this.write("vehicles", cells),
        onDelete: (row) => onChange({ ...this.#asked, vehicles: this.#asked.vehicles.toSpliced(row, 1) }),
      },
      "Vehicle",
      element("fill-vehicles"),
    );
    this.#objectives = new ObjectiveFields(element("fleet-objectives"), (axis, change) => this.#measure(axis, change));
    this.#clock = new ObjectiveFields(element("fleet-clock"), (_, change) => onChange({ ...this.#asked, clock: { ...this.#asked.clock, ...change } }, isSpeedRead(change)));
    this.#everyday = new EverydayForm((changed) => this.#onTrade(changed));
    element("add-vehicle").addEventListener("click", () => this.#addVehicle());
    element("against").addEventListener("change", ({ target }) => this.#trade(target.value, tradedAgainst));
    element("also-against").addEventListener("change", ({ target }) => this.#trade(target.value, tradedAlsoAgainst));
    element("times").addEventListener("change", ({ target }) => this.#onTrade(timedBy(this.#asked, target.value)));
    element("spread").addEventListener("change", ({ target }) => this.#vary(target));
    element("widen").addEventListener("click", ({ target }) => target.setAttribute("aria-pressed", target.getAttribute("aria-pressed") !== "true"));
    for (const table of ["stops", "vehicles"]) {
      element(`${table}-column`).addEventListener("change", ({ target }) => this.#addColumn(table, target.value));
    }
  }

  /** Takes the request of a fleet that is opened; null if it is of another kind. */
  open(asked) {
    this.#asked = asked;
    this.#added = { stops: new Set(), vehicles: new Set() };
    this.#vehicles.forget();
    element("spread").setCustomValidity("");
    this.#everyday.open();
    if (!asked) this.#everyday.show(null);
    for (const each of document.querySelectorAll(".of-fleet")) each.hidden = !asked;
    element("objectives").hidden = Boolean(asked);
    if (asked) this.#showTrade();
  }

  /** Shows both tables of a changed request. */
  show(asked) {
    this.#asked = asked;
    const second = secondsIn(asked);
    this.#show("stops", this.#stops, second);
    this.#show("vehicles", this.#vehicles, second);
    this.#everyday.show(asked);
    element("vehicle-count").textContent = counted(vehiclesIn(asked), "vehicle", "vehicles");
    element("vehicle-names").replaceChildren(...asked.vehicles.map((each) => new Option(each?.id)));
  }

  /** Fills in what is remembered of every day. */
  recall() {
    this.#everyday.recall();
  }

  /** Takes the place where a map was clicked. */
  clicked(...place) {
    this.#everyday.clicked(...place);
  }

  /** Marks the cells that are not understood, and says what the first of each table must be; faults were cleared before. */
  mark() {
    for (const [name, table] of [["stops", this.#stops], ["vehicles", this.#vehicles]]) {
      table.mark();
      const fault = this.#faultIn(name);
      if (fault) tellFault(name, fault.detail);
    }
    const doubt = doubtOfTimes(this.#asked);
    if (doubt) tellFault("objectives", doubt);
  }

  /** The first cell that is not understood, as an error of a request; undefined if there is none. */
  get fault() {
    return this.#faultIn("stops") ?? this.#faultIn("vehicles");
  }

  #faultIn(name) {
    const columns = this.#shown(name);
    for (const [row, item] of this.#items(name).entries()) {
      const column = columns.find((each) => isUnread(item, each));
      if (column) return { pointer: `/${name}/${row}/${column.member}/${column.part}`, detail: unread(item, column, secondsIn(this.#asked)) };
    }
  }

  /** Takes the texts of cells, each `{ row, column, text }`. */
  write(table, cells) {
    const columns = this.#shown(table);
    const second = secondsIn(this.#asked);
    let isRead = true;
    const changed = cells.reduce((asked, { row, column, text }) => {
      const written = columns[column];
      if (written.detail !== undefined) return withDetail(asked, written.detail, row, text);
      const item = withText(asked[table][row], written, text, second);
      isRead &&= !isUnread(item, written);
      return { ...asked, [table]: asked[table].with(row, item) };
    }, this.#asked);
    this.#onChange(changed, isRead);
  }

  #items(table) {
    return this.#asked[table] ?? [];
  }

  #shown(table) {
    const told = table === "stops" ? detailColumns(this.#asked) : [];
    return [...told, ...columnsOf(table, this.#asked).filter((each) => isShown(each, this.#items(table), this.#added[table]))];
  }

  #show(name, table, second) {
    const columns = this.#shown(name);
    const items = byIds(this.#asked)[name] ?? [];
    const details = (row) => this.#asked.details?.map(({ texts }) => texts[row]);
    table.show(headed(columns), items.map((item, row) => rowOf(item, columns, second, details(row))));
    const missing = columnsOf(name, this.#asked).filter(({ member, part }) => part === undefined && !columns.some((each) => each.member === member));
    element(`${name}-column`).replaceChildren(new Option("Add a column", ""), ...missing.map(({ title, member }) => new Option(title, member)));
  }

  #addColumn(name, member) {
    this.#added[name].add(member);
    this.show(this.#asked);
    const table = name === "stops" ? this.#stops : this.#vehicles;
    table.focus(0, this.#shown(name).findIndex((each) => each.member === member));
  }

  #addVehicle() {
    this.#onChange(withVehicle(this.#asked));
    this.#vehicles.focus(this.#asked.vehicles.length - 1);
  }

  /** Takes another second or third objective, and shows the columns that it needs. */
  #trade(key, traded) {
    for (const table of ["stops", "vehicles"]) if (AGAINST[key]?.[table]) this.#added[table].add(AGAINST[key][table]);
    this.#onTrade(traded(this.#asked, key));
  }

  #onTrade(asked) {
    this.#onChange(asked);
    this.#showTrade();
  }

  /** Takes by how much the times vary. */
  #vary(input) {
    const percent = percentTyped(input.value);
    const fault = `Times must vary by 0 to 1000 %, as 20, got “${input.value.trim()}”`;
    if (isRead(input, percent !== undefined, fault)) this.#onTrade(varyingBy(this.#asked, percent));
  }

  /** Takes a new member of an objective; the clock keeps its objective under another name. */
  #measure(axis, change) {
    const { objectives, clock } = this.#asked;
    const named = change.name && clock === objectives[axis].name ? { clock: change.name } : {};
    this.#onChange({ ...this.#asked, ...named, objectives: objectives.with(axis, { ...objectives[axis], ...change }) }, isSpeedRead(change));
  }

  #showTrade() {
    const traded = isTraded(this.#asked);
    for (const each of document.querySelectorAll(".trade > *")) each.hidden = !traded;
    if (!traded) return;
    const times = timesOf(this.#asked);
    const { objectives, clock } = this.#asked;
    this.#objectives.show(objectives, true);
    this.#clock.show(times === "own" ? [clock] : [], true, ["Times"]);
    choose("against", Object.entries(AGAINST).map(([key, { title }]) => [key, title]), againstOf(this.#asked));
    choose("also-against", alsoAgainst(this.#asked), againstOf(this.#asked, 2));
    const offered = Object.entries(TIMES).filter(([key]) => key !== (objectives[1].measure ? "second" : "own"));
    choose("times", offered, times ?? "");
    this.#showSpread();
  }

  /** Shows by how much the times vary; what is not understood stays. */
  #showSpread() {
    const [input, percent] = [element("spread"), variesBy(this.#asked)];
    input.closest(".field").hidden = !this.#asked.clock;
    Object.assign(input, { disabled: percent === undefined, placeholder: percent === undefined ? "the days of the file" : "0" });
    if (input.validity.valid) input.value = percent ?? "";
  }
}

function choose(id, options, value) {
  element(id).replaceChildren(...options.map(([key, title]) => new Option(title, key)));
  element(id).value = value;
}

function unread(item, column, second) {
  const [cell, text] = [`${column.title} of ${item.id}`, `“${cellText(item, column, second)}”`];
  if (column.list) {
    const [, row] = /^(.*\S) \d+$/.exec(unknownIn(item, column)) ?? [];
    if (column.list === "vehicle-names" && column.names.includes(row)) return `${cell} cannot be ${text}: give that vehicle a row of its own, as those of one row are alike`;
    const meant = nearest(unknownIn(item, column), column.names);
    return `${cell} must be the name of a ${column.list.replace("-names", "")}, got ${text}${meant ? `; did you mean ${meant}?` : ""}`;
  }
  return `${cell} cannot be ${text}: write ${hintOf(column, second)}`;
}
