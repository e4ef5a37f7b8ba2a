/** The orders that have come since a fleet was planned: rows of a table that are typed, clicked on the map, or pasted. */

import { counted } from "../common/numbers.js";
import { cellText, headed, hintOf, isUnread, rowOf, secondsIn, withText } from "../fleet/cells.js";
import { columnsOf, isShown } from "../fleet/columns.js";
import { usualService } from "../fleet/everyday.js";
import { detailColumns } from "../inputs/details.js";
import { Placing } from "../inputs/placing.js";
import { isMeasured } from "../inputs/stops.js";
import { EditableTable } from "../inputs/table.js";
import { Problem } from "../planning/service.js";

const element = (id) => document.getElementById(id);
const FIXED = "No order can be added here: its costs to the other stops are not known.";
const TIMED = new Set(["window", "service"]); // members that have a column where there is a clock

export class Orders {
  #service;
  #table;
  #placing;
  #asked = { stops: [], vehicles: [] };
  #added = [];
  #number = 0; // of the last order that was named here

  /**
   * @param {Service} service reads what is pasted
   * @param {(plane: number, place: number[] | null) => void} onWaiting as of Placing
   */
  constructor(service, onWaiting) {
    this.#service = service;
    const told = {
      onName: (row, id) => this.#write(row, { ...this.#added[row], id }),
      onCells: (cells) => this.#take(this.#withCells(cells)),
      onDelete: (row) => this.#take(this.#added.toSpliced(row, 1)),
    };
    this.#table = new EditableTable(element("orders"), told, "Order");
    this.#placing = new Placing(element("place-order"), element("orders-help"), (location) => this.#take([...this.#added, this.#timed({ id: this.#freeName(), location })]), onWaiting);
    element("add-order").addEventListener("click", () => {
      this.#take([...this.#added, this.#timed({ id: this.#freeName() })]);
      this.#table.focus(this.#added.length - 1);
    });
  }

  /** Takes the request of the plan that is driven, without any orders since. */
  open(asked) {
    this.#asked = asked;
    this.#added = [];
    this.#placing.stop();
    const placed = isMeasured(asked);
    for (const id of ["add-order", "place-order"]) element(id).hidden = !placed;
    element("orders-note").textContent = placed ? "or paste rows of a table with its headings, such as id, lon, lat" : FIXED;
    this.#show();
  }

  clicked(...place) {
    this.#placing.clicked(...place);
  }

  get canAdd() {
    return isMeasured(this.#asked);
  }

  /** What is told of the orders, by their ids: a text for each of the details of the request. */
  get told() {
    return new Map(this.#added.map(({ id, told = [] }) => [id, told]));
  }

  /** The orders, as stops of a request. Throws a Problem at the first one that cannot be planned with. */
  get added() {
    for (const [row, order] of this.#added.entries()) {
      const unread = this.#columns.find((each) => isUnread(order, each));
      if (unread) throw refusal(row, unread.member, `${unread.title} of ${order.id} cannot be “${cellText(order, unread, secondsIn(this.#asked))}”: write ${hintOf(unread, secondsIn(this.#asked))}`);
      if (this.#isKnown(order.id)) throw refusal(row, "id", `${order.id} is a stop of the plan already: give the new order another name`);
      if (order.location?.length !== 2 || !order.location.every(Number.isFinite)) throw refusal(row, "location", `${order.id} needs a place: write its longitude and latitude, or click where it is`);
    }
    return this.#added.map(({ told: _, ...order }) => order);
  }

  /** Gives an order the window that was promised. */
  promise(row, window) {
    this.#write(row, { ...this.#added[row], window });
  }

  /** Adds the rows of a pasted table; says what is wrong with it where it cannot be read. */
  async paste(file) {
    const help = element("orders-help");
    help.textContent = "What was pasted is being read.";
    try {
      const { request, details = [] } = await this.#service.read([file]);
      const textsOf = (row) => this.#asked.details?.map(({ column }) => details.find((each) => each.column === column)?.texts[row] ?? "");
      const rows = (request.stops ?? []).map((stop, row) => ({ ...stop, told: textsOf(row) })).filter(({ location }) => location);
      const fresh = rows.filter(({ id }) => !this.#isKnown(id) && !this.#added.some((each) => each.id === id));
      help.textContent = saidOf(rows.length, fresh.length);
      this.#take([...this.#added, ...fresh.map(({ id, location, demand, pickup, window, windows, service, told }) => this.#timed(JSON.parse(JSON.stringify({ id, location, demand, pickup, window, windows, service, told }))))]);
    } catch (error) {
      if (!(error instanceof Problem)) throw error;
      help.textContent = `Not read: ${error.message}.`;
    }
  }

  /** An order that takes as long as most other stops, unless it says how long. */
  #timed(order) {
    const service = this.#asked.clock ? usualService(this.#asked) : undefined;
    return service === undefined ? order : { service, ...order };
  }

  #isKnown(id) {
    return this.#asked.stops.some((stop) => stop.id === id);
  }

  #withCells(cells) {
    const columns = this.#columns;
    const changed = (order, column, text) => {
      if (column.detail === undefined) return withText(order, column, text, secondsIn(this.#asked));
      return { ...order, told: this.#asked.details.map((_, at) => (at === column.detail ? text : (order.told?.[at] ?? ""))) };
    };
    return cells.reduce((added, { row, column, text }) => added.with(row, changed(added[row], columns[column], text)), this.#added);
  }

  /** Whether a text that is pasted there fills cells of the table. */
  fills(target, text) {
    return Boolean(target.closest?.("#orders") && this.#table.blockAt(target, text));
  }

  #write(row, order) {
    this.#take(this.#added.with(row, order));
  }

  #take(added) {
    this.#added = added;
    this.#show();
  }

  get #columns() {
    const shown = this.#asked.clock ? TIMED : new Set();
    return [...detailColumns(this.#asked), ...columnsOf("stops", this.#asked)].filter((each) => ["location", "details"].includes(each.member) || isShown(each, each.member === "demand" ? this.#asked.stops : this.#added, shown));
  }

  #show() {
    const second = secondsIn(this.#asked);
    const columns = this.#columns;
    element("orders").hidden = !this.#added.length;
    this.#table.show(headed(columns), this.#added.map((order) => rowOf(order, columns, second, order.told)));
    element("orders-fault").textContent = "";
    this.#table.mark();
  }

  #freeName() {
    let name;
    do name = `extra ${(this.#number += 1)}`;
    while (this.#isKnown(name));
    return name;
  }
}

function saidOf(found, fresh) {
  if (!found) return "No rows with a place were found: a table needs the headings id, lon and lat.";
  const known = found - fresh;
  const left = known ? `; ${counted(known, "is a stop", "are stops")} of the plan already` : "";
  return `${counted(found, "row was", "rows were")} read${left}.`;
}

const refusal = (row, member, detail) => new Problem({ code: "invalid-request", detail, errors: [{ pointer: `/add/${row}/${member}`, detail }] });
