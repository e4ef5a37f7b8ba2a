/** The form, put together: stops as a table and as text, the objectives, and the settings. */

import { CostLayers } from "./cost_layers.js";
import { DayForm } from "./day_form.js";
import { detailsOfTyped, detailsWithAnother, detailsWithout, withSoundDetails, withoutDetails } from "./details.js";
import { Fields } from "./fields.js";
import { askedFor, described, inPlanes, ownNames, requestFor } from "./instance.js";
import { depotsSaid } from "../fleet/everyday.js";
import { FleetForm } from "../fleet/fleet_form.js";
import { byIds, servedBy, stopRenamed } from "../fleet/references.js";
import { RequestText } from "../fleet/fleet_request.js";
import { placedAt, withRobotEnd } from "./map_ends.js";
import { isProposed, withoutLayer } from "./map_proposal.js";
import { IF_LOST, isCity, nameOf, rounded, textOf } from "./places.js";
import { PlanLine } from "./plan_line.js";
import { RobotCount } from "./robot_count.js";
import { ObjectiveFields, isSpeedRead } from "./objective_fields.js";
import { columnsOfPlaces, hasTable, misplacedIn, rowsOfPlaces, withCells, withNumbers } from "./places_table.js";
import { isMeasured, isPriced, put, renamed, withAnother, without } from "./stops.js";
import { EditableTable } from "./table.js";
import { TypedRows } from "./typed_rows.js";
import { counted } from "../common/numbers.js";
import { formOf, kindOf } from "../common/kinds.js";
import { UNNAMED, namesIn } from "../common/objectives.js";
import { firstFault, problemOf, readAgain } from "../planning/faults.js";
import { say } from "../planning/status.js";

const element = (id) => document.getElementById(id);
const FIXED = "No stop can be added: its costs to the other stops are not known. Open a file that has it.";

export class RequestForm {
  #form;
  #fields;
  #table;
  #objectiveFields;
  #fleet;
  #day = new DayForm((changed) => this.#change(changed));
  #layers = new CostLayers({
    onName: (at, name) => this.#nameLayer(at, name),
    onShade: (at) => this.#shade(at),
    onRemove: (at) => this.open(withoutLayer(this.asked, at)),
  });
  #robots = new RobotCount(() => this.asked, (request) => this.open(request));
  #onShaded;
  #text = new RequestText(element("fleet-request"));
  #planLine;
  #onEdited;
  #settled;
  #typedRows;
  #rows = []; // rows of planes, one per stop, as they were opened, edited, or typed and read
  #drawn = []; // which of these rows are cities on the maps
  #brought = { coordinates: [] }; // the members of the opened request that are not settings
  #objectives = UNNAMED; // as they are shown

  /**
   * @param {Service} service reads what is typed
   * @param {{ onEdited: (instance: object | null, fit: boolean | string) => void, onEnds: (instance: object) => void,
   *   onShaded: (instance: object) => void, settled: () => Promise<boolean> }} told called with other stops or costs, null where one cannot be read;
   *   with what was typed that moves or limits the ends on a map; with the layer that shades the map; and to read what was typed, or show why that
   *   is not possible
   */
  constructor(form, service, { onEdited, onEnds, onShaded, settled }) {
    this.#onShaded = onShaded;
    this.#onEdited = onEdited;
    this.#settled = settled;
    this.#typedRows = new TypedRows(service, (found) => this.#take(found));
    this.#form = form;
    this.#fields = new Fields(form);
    this.#planLine = new PlanLine(form);
    this.#objectiveFields = new ObjectiveFields(element("objectives"), (axis, change) => this.#measure(axis, change));
    const told = {
      onName: (row, text) => this.#onceRead(() => this.#rename(row, text)),
      onCells: (cells) => this.#onceRead(() => this.#write(cells)),
      onDelete: (row) => this.#onceRead(() => this.#delete(row, IF_LOST)),
    };
    this.#table = new EditableTable(element("stops"), told, "Stop", element("fill-stops"));
    this.#fleet = new FleetForm(this.#table, (...changed) => this.#change(...changed));
    element("cities").addEventListener("input", () => this.#typed());
    for (const name of ["start", "end", "open", "cell_size", "robot_radius"]) form[name].addEventListener("change", () => onEnds(this.instance));
    element("rounded").addEventListener("change", () => this.#edited(false));
    element("add").addEventListener("click", () => this.#onceRead(() => this.#add()));
  }

  /** Takes a request into the form, and shows its stops under their objectives. */
  open(opened, names = UNNAMED) {
    const wanted = inPlanes(withSoundDetails(opened));
    const [kind, form] = [kindOf(wanted), formOf(wanted)];
    this.#brought = this.#fields.take(wanted, kind);
    this.#objectives = wanted.names ?? ownNames(wanted) ?? names;
    this.#table.forget();
    element("typed").hidden = form !== "coordinates";
    element("named").hidden = !this.#isFleet && (Boolean(kind.movers || wanted.cost_layers) || !(kind.onGrid || form));
    this.#fleet.open(this.#isFleet ? this.#brought : null);
    this.#day.open(this.#brought);
    this.#robots.show(wanted);
    this.#show(wanted.coordinates ?? []);
    element("rounding").hidden = !wanted.rounded;
    element("rounded").checked = Boolean(wanted.rounded);
    if (!this.#isFleet) this.#showObjectives();
    this.#edited();
  }

  get #isFleet() {
    return isFleet(this.#brought);
  }

  get asked() {
    const typed = { rows: this.#rows, whole: element("rounded").checked };
    return askedFor(this.#brought, this.#fields.members, typed);
  }

  /** The settings of how to plan, and not what. */
  get planning() {
    return this.#fields.planning;
  }

  get request() {
    return requestFor(this.asked);
  }

  get objectives() {
    return this.#objectives;
  }

  /** The instance to draw. */
  get instance() {
    if (kindOf(this.#brought).onGrid) return this.asked;
    return formOf(this.#brought) === "coordinates" ? { coordinates: this.#rows.filter(isCity) } : this.#brought;
  }

  /** The ids of the stops, null if they have none. */
  get ids() {
    return this.#brought.stops?.map(({ id }) => id) ?? this.#brought.ids ?? null;
  }

  /** Whether something was typed that is not among the stops yet. */
  get unread() {
    return this.#typedRows.waiting;
  }

  /** The fault of the first field whose text cannot be taken; null if there is none. */
  get fault() {
    return problemOf(this.#untaken);
  }

  /** The same, as an error of a request. */
  get #untaken() {
    return firstFault(this.#form) ?? (this.#isFleet ? this.#fleet.fault : null);
  }

  /** That fault, or the one of what is sent as it was typed, so that the service names it. */
  get refused() {
    return problemOf(this.#untaken ?? this.#misplaced ?? this.#fields.fault);
  }

  get #misplaced() {
    return misplacedIn(formOf(this.#brought), this.#brought.stops, this.#rows, (row) => this.ids?.[row]);
  }

  /** Reads what was typed now, as `TypedRows.settle` does. */
  settle(reading) {
    return this.#typedRows.settle(reading);
  }

  /** Adds a stop where it was clicked: a row of four numbers, or longitude and latitude. */
  addCity(row) {
    this.#onceRead(() => {
      this.#insert(row);
      const added = this.#count - 1;
      this.#table.reveal(added);
      say(`Stop ${nameOf(this.ids, added)} was added.`);
    });
  }

  /** Puts a stop where it was dragged on the first or second map. */
  moveCity(plane, city, place) {
    this.#onceRead(() => this.#put(plane, city, place));
  }

  #put(plane, city, place) {
    const there = place.map(rounded);
    if (this.#brought.stops) {
      this.#brought = put(this.#brought, plane, city, there);
      return this.#edited(false);
    }
    const row = this.#drawn[city];
    this.#takeRows(this.#rows.map((each, at) => (at === row ? each.toSpliced(2 * plane, 2, ...there) : each)), false);
  }

  /** Puts an end of a robot's tour into a cell of its map; null takes it away. */
  moveEnd(end, cell) {
    if (end.robot === null) this.#fields.put(end.role, cell ? placedAt(this.asked, cell) : {});
    else this.#brought = { ...this.#brought, robots: withRobotEnd(this.asked, end, cell) };
    this.#edited(false);
  }

  /** Whether some costs are those of a matrix, and not measured between places. */
  get priced() {
    return isPriced(this.#brought);
  }

  /** Fills in what a dispatcher has every day, and a file of a fleet does not say. */
  recall() {
    if (this.#isFleet) this.#fleet.recall();
  }

  /** Takes the place where a map was clicked. */
  clicked(...place) {
    if (this.#isFleet) this.#fleet.clicked(...place);
  }

  /** Has a stop of a fleet served by a type of vehicles; by any without its id. */
  serve(stop, vehicle) {
    this.#change(servedBy(this.#brought, this.ids.indexOf(stop), vehicle));
  }

  /** Takes the changed request of a fleet, or one with other hours; `isRead` says whether what was typed is understood. */
  #change(changed, isRead = true) {
    this.#brought = changed;
    this.#objectives = namesIn(changed);
    this.#edited(IF_LOST, isRead);
  }

  /** Deletes a stop that is drawn. */
  deleteCity(city) {
    this.#onceRead(() => this.#delete(this.#brought.stops ? city : this.#drawn[city]));
  }

  /** Reports the first key, which ends any planning; other stops are drawn once they are read. */
  #typed() {
    if (!this.unread) this.#onEdited(this.instance, false);
    this.#typedRows.typed(element("cities").value);
  }

  #take({ coordinates, ids }) {
    Object.assign(this.#brought, detailsOfTyped(this.#brought, this.ids, ids, coordinates.length));
    this.#rows = coordinates;
    if (ids) this.#brought.ids = ids;
    this.#edited();
  }

  /** Changes stops once what was typed is among them; if it cannot be read, they stay as they are. */
  async #onceRead(change) {
    if (this.unread) {
      this.#edited(false);
      if (!(await this.#settled())) return;
    }
    change();
  }

  #show(rows) {
    this.#rows = rows;
    this.#typedRows.forget();
    element("cities").value = textOf(rows);
  }

  #takeRows(rows, fit) {
    this.#show(rows);
    this.#edited(fit);
  }

  /** Shows what has changed. A plan stays where what was typed cannot be read. */
  #edited(fit = true, isRead = true) {
    const form = formOf(this.#brought);
    const count = (form === "coordinates" ? this.#rows : (this.#brought.stops ?? [])).length;
    const shown = this.#isFleet || hasTable(form);
    if (this.#isFleet) this.#fleet.show(this.#brought);
    else this.#table.show(columnsOfPlaces(form, this.#brought, this.#objectives), rowsOfPlaces(form, this.#brought, this.#rows));
    element("count").textContent = shown ? counted(count, "stop", "stops") : "";
    element("count-depots").textContent = this.#isFleet ? depotsSaid(this.#brought) : "";
    const isFixed = form !== "coordinates" && !isMeasured(this.#brought);
    element("add").disabled = element("place").disabled = isFixed;
    element("add").hidden = element("place").hidden = !shown;
    element("add-help").textContent = shown && isFixed ? FIXED : "";
    this.#day.show(this.#brought);
    this.#layers.show(this.#brought, this.#objectives[1].name, isProposed(this.#brought));
    this.#text.show(kindOf(this.#brought).movers ? withoutDetails(this.#brought) : null);
    element("brought").textContent = described(this.#brought);
    element("brought").hidden = !element("brought").textContent;
    this.#fields.name(this.ids, count);
    this.#planLine.show(this.#objectives);
    if (isRead) this.#drawn = this.#rows.flatMap((row, at) => (isCity(row) ? [at] : []));
    this.#onEdited(isRead ? this.instance : null, fit);
    this.mark();
  }

  #nameLayer(at, name) {
    const { cost_layers: layers } = this.#brought;
    this.#brought = { ...this.#brought, cost_layers: layers.with(at, { ...layers[at], name }) };
    this.#objectives = ownNames(this.#brought);
    this.#edited(false);
  }

  #shade(at) {
    this.#brought = { ...this.#brought, shaded: at };
    this.#onShaded(this.instance);
  }

  /** Marks the fields and cells that hold what cannot be taken, and says what they must be. */
  mark() {
    readAgain(this.#form);
    if (this.#isFleet) this.#fleet.mark();
  }

  #rename(row, text) {
    if (this.#isFleet) this.#brought = stopRenamed(this.#brought, row, text);
    else if (this.#brought.stops) this.#brought = renamed(this.#brought, row, text);
    else this.#brought.ids = this.#rows.map((_, city) => (city === row ? text : nameOf(this.ids, city)));
    this.#edited(false);
  }

  /** Takes the texts of cells, each `{ row, column, text }`. */
  #write(cells) {
    if (this.#isFleet) return this.#fleet.write("stops", cells);
    const { stops } = this.#brought;
    const columns = columnsOfPlaces(formOf(this.#brought), this.#brought, this.#objectives);
    const [changed, isRead] = stops ? withCells(this.#brought, columns, cells) : withNumbers(this.#rows, cells);
    if (stops) this.#brought = changed;
    else this.#show(changed);
    this.#edited(IF_LOST, isRead);
  }

  #delete(row, fit = false) {
    if (this.#brought.stops) {
      this.#brought = without(this.#isFleet ? byIds(this.#brought) : this.#brought, row);
      if (!this.#isFleet) this.#showObjectives();
      return this.#edited(fit);
    }
    Object.assign(this.#brought, { ids: this.#brought.ids?.toSpliced(row, 1), ...detailsWithout(this.#brought, row) });
    this.#takeRows(this.#rows.toSpliced(row, 1), fit);
  }

  /** How many stops have a row in the table. */
  get #count() {
    return (this.#brought.stops ?? this.#rows).length;
  }

  /** Adds a stop in the middle of the others, to be moved from there. */
  #add() {
    const { stops } = this.#brought;
    const rows = stops ? stops.map(({ location }) => location ?? []) : this.#rows.filter(isCity);
    this.#insert(middleOf(rows, stops ? 2 : 4));
    this.#table.focus(this.#count - 1);
  }

  #insert(row) {
    const name = this.#freeName();
    const { stops, ids } = this.#brought;
    if (ids) this.#brought.ids = [...ids, name];
    if (!stops) {
      Object.assign(this.#brought, detailsWithAnother(this.#brought));
      return this.#takeRows([...this.#rows, row], false);
    }
    this.#brought = withAnother(this.#brought, name, row);
    this.#edited(false);
  }

  /** A number that is not the name of any stop. */
  #freeName() {
    const ids = this.ids ?? [];
    let number = ids.length + 1;
    while (ids.includes(String(number))) number += 1;
    return String(number);
  }

  #measure(axis, change) {
    const { objectives } = this.#brought;
    const changed = (each, at) => (at === axis ? { ...each, ...change } : each);
    if (objectives) this.#brought.objectives = objectives.map(changed);
    else this.#brought.names = this.#objectives.map(changed);
    this.#objectives = objectives ? namesIn(this.#brought) : this.#brought.names;
    this.#edited(false, isSpeedRead(change));
  }

  #showObjectives() {
    const { stops, objectives } = this.#brought;
    const sourced = Boolean(stops && Array.isArray(objectives) && objectives.length >= 2);
    this.#objectiveFields.show(sourced ? objectives : this.#objectives, sourced);
  }
}

const isFleet = (request) => kindOf(request).path === "fleet";

function middleOf(rows, width) {
  const sum = (column) => rows.reduce((all, row) => all + (Number(row[column]) || 0), 0);
  return Array.from({ length: width }, (_, column) => rounded(sum(column) / (rows.length || 1)));
}
