/** Place the starts and ends on a robot's map: by click, by drag and by keys, and never on an obstacle. */

import "../vendor/leaflet/leaflet.js";
import { routeStyle } from "../fleet/route_styles.js";
import { cellIn, cellNamed, endsOf, faultOf } from "../inputs/map_ends.js";
import { ring } from "./flatmap.js";
import { Handling } from "./handling.js";

const { L } = globalThis;
const element = (id) => document.getElementById(id);
const SIDE = 18; // pixels
const FAST = 10; // pixels at least that an arrow key moves an end, with Shift one cell
const HELP = matchMedia("(pointer: coarse)").matches
  ? "Tap the start or the end to choose it, and drag it where it belongs."
  : "Drag the start or the end, or press Enter on the map to choose one and move it by arrow keys.";

/** It is the plane and the choice of a Handling: see there. */
export class GridEnds {
  #map;
  #told;
  #request = null;
  #ends = [];
  #ofPaths = new Map(); // the path of each robot on the selected tour or plan, as cells
  #rings = [];
  #chosen = null;
  #editable = false;

  /**
   * @param {L.Map} map where row and column are `-lat` and `lng`
   * @param {{ onMove: (end: object, cell: number[] | null) => void, onRefused: (said: string) => void }} told called
   *   with the cell where an end was put, null if it was taken away; and with the reason why it stays where it was
   */
  constructor(map, told) {
    this.#map = map;
    this.#told = told;
    new Handling(map, this, this);
    map.on("click", ({ latlng }) => this.placing && this.#put(this.#chosen, cellAt(latlng)));
    element("end-of").addEventListener("change", ({ target }) => this.choose(Number(target.value)));
    element("place-end").addEventListener("click", () => this.#turnPlacing(!this.placing));
    element("remove-end").addEventListener("click", () => this.remove());
    element("end-at").addEventListener("change", ({ target }) => this.#type(target));
    element("ends").addEventListener("keydown", ({ key }) => key === "Escape" && this.#turnPlacing(false));
  }

  /** Takes a request on a map, whether its ends can be moved, and whether the map is the `same` as before: then the choice stays. */
  show(request, editable, same) {
    const before = same && this.#ends.map(({ name }) => name).join();
    this.#request = request;
    this.#ends = endsOf(request);
    if (!same) this.#ofPaths = new Map();
    this.#editable = editable;
    const names = this.#ends.map(({ name }) => name);
    element("ends").hidden = !editable;
    element("end-of").replaceChildren(...names.map((name, at) => new Option(name, at)));
    this.choose(names.join() === before ? this.#chosen : null);
    this.#draw();
  }

  /**
   * Takes the paths of the selected tour or plan, each a robot's index, or null for one alone, and cells. They start and
   * end somewhere, also where the request leaves that open.
   */
  follow(paths) {
    this.#ofPaths = new Map(paths);
    this.#draw();
  }

  // The choice of a Handling.

  get city() {
    return this.#chosen;
  }

  get editable() {
    return this.#editable;
  }

  get choosable() {
    return this.#editable;
  }

  /** Whether a click places the chosen end. */
  get placing() {
    return element("place-end").getAttribute("aria-pressed") === "true";
  }

  choose(at) {
    this.#chosen = at;
    if (at === null) this.#press(false);
    else element("end-of").value = at;
    element("remove-end").disabled = !this.#ends[this.#listed]?.cell;
    this.#rings.forEach((each, index) => each?.getElement()?.classList.toggle("chosen", index === at));
    this.#say();
  }

  /** Chooses the next end that is drawn; while one is placed, places it in the middle of what is seen. */
  turn(by) {
    if (!this.#editable) return;
    if (this.placing) return this.#put(this.#chosen, this.#middle(this.#ends[this.#chosen]));
    const drawn = this.#ends.flatMap((_, at) => (this.#cellOf(at) ? [at] : []));
    const from = drawn.indexOf(this.#chosen);
    if (drawn.length) this.choose(drawn.at(from < 0 ? (by > 0 ? 0 : -1) : (from + by) % drawn.length));
  }

  remove() {
    const end = this.#ends[this.#listed];
    if (end?.cell) this.#told.onMove(end, null);
  }

  // The plane of a Handling.

  near(point, reach) {
    const far = this.#ends.map((_, at) => (this.#cellOf(at) ? this.pointOf(at).distanceTo(point) : Infinity));
    const least = Math.min(...far);
    return least <= reach ? far.lastIndexOf(least) : null;
  }

  pointOf(at) {
    return this.#pointOf(this.#cellOf(at) ?? this.#middle(this.#ends[at]));
  }

  /** The pixels that an arrow key moves an end: whole cells. */
  stride(fine) {
    const cell = this.#map.getZoomScale(this.#map.getZoom(), 0);
    return fine ? cell : cell * Math.max(1, Math.round(FAST / cell));
  }

  drag(at, point) {
    const cell = cellAt(this.#map.containerPointToLatLng(point));
    this.#rings[at] ??= this.#made(this.#ends[at]);
    this.#rings[at].setLatLng(middleOf(cell)).addTo(this.#map);
    this.#rings[at].getElement().classList.toggle("forbidden", Boolean(this.#faultOf(at, cell)));
  }

  drop(at, point) {
    this.#put(at, cellAt(this.#map.containerPointToLatLng(point)));
  }

  /** Puts the end that the list shows where its field says. */
  #type(field) {
    const cell = cellIn(this.#request, field.value);
    if (cell) this.#put(this.#listed, cell);
    else if (field.value.trim()) return this.#told.onRefused(`“${field.value}” is neither x and y in metres nor a row and a column, as “row 3, column 5”.`);
    field.value = "";
  }

  #put(at, cell) {
    const end = this.#ends[at];
    const fault = cell ? this.#faultOf(at, cell) : "is not free";
    const said = cell ? cellNamed(cell) : "no cell nearby";
    this.#draw();
    if (fault) {
      const stays = end.cell || this.#cellOf(at) ? "stays where it was" : "is not placed";
      return this.#told.onRefused(`${said[0].toUpperCase()}${said.slice(1)} ${fault}: the ${inSentence(end)} ${stays}.`);
    }
    this.#press(false);
    this.#chosen = at;
    if (String(cell) === String(end.cell)) this.choose(at);
    else this.#told.onMove(end, cell);
  }

  #faultOf(at, cell) {
    return faultOf(this.#request, this.#ends[at], cell);
  }

  /** The free cell nearest to the middle of what is seen of the map; null if there is none nearby. */
  #middle(end) {
    const { grid } = this.#request;
    const [row, column] = cellAt(this.#map.getCenter());
    const [height, width] = [grid.length, grid[0].length];
    for (let reach = 0; reach <= Math.max(height, width); reach += 1) {
      for (const cell of around([row, column], reach)) if (!faultOf(this.#request, end, cell)) return cell;
    }
    return null;
  }

  /** The end that the list shows. */
  get #listed() {
    return Number(element("end-of").value);
  }

  #turnPlacing(on) {
    if (on) this.choose(this.#listed);
    this.#press(on);
    if (on) this.#map.getContainer().focus({ preventScroll: true });
    this.#say();
  }

  #press(on) {
    element("place-end").setAttribute("aria-pressed", String(on));
  }

  #say() {
    element("ends-help").textContent = this.#editable ? this.#said : "";
  }

  get #said() {
    if (this.#chosen === null) return HELP;
    const end = this.#ends[this.#chosen];
    if (this.placing) return `Click the cell of the ${inSentence(end)}, or press Enter on the map for its middle; Escape gives up.`;
    const cell = this.#cellOf(this.#chosen);
    return cell ? `${end.name}: ${cellNamed(cell)}. Drag it, or move it by arrow keys; with Shift by one cell.` : `${end.name}: not placed yet.`;
  }

  #cellOf(at) {
    const { cell, robot, role } = this.#ends[at];
    const path = this.#ofPaths.get(robot) ?? [];
    const [start, end] = [path[0], path.at(-1)];
    if (role === "start") return cell ?? start ?? null;
    return cell ?? (String(start) === String(end) ? null : end);
  }

  #draw() {
    for (const each of this.#rings) each?.remove();
    this.#rings = this.#ends.map((end, at) => {
      const cell = this.#cellOf(at);
      return cell && this.#made(end).setLatLng(middleOf(cell)).addTo(this.#map);
    });
    this.#ends.forEach(({ robot }, at) => this.#paint(this.#rings[at], robot));
    this.#rings[this.#chosen]?.getElement().classList.add("chosen");
    for (const role of ["start", "end"]) {
      element("grid-legend").querySelector(`.${role}`).hidden = !this.#ends.some((end, at) => end.role === role && this.#rings[at]);
    }
  }

  /** A robot's ends have the colour of its path. */
  #paint(drawn, robot) {
    if (drawn && robot !== null) drawn.getElement().style.borderColor = `var(--${routeStyle(robot).colour})`;
  }

  #made({ role }) {
    return ring(role, SIDE);
  }

  /** Where a cell is drawn. Leaflet's own function rounds to whole pixels, and a cell may be less than one. */
  #pointOf(cell) {
    const map = this.#map;
    return map.project(middleOf(cell)).subtract(map.getPixelOrigin()).add(map._getMapPanePos());
  }
}

const inSentence = ({ name }) => `${name[0].toLowerCase()}${name.slice(1)}`;
const middleOf = ([row, column]) => [-row - 0.5, column + 0.5];
const cellAt = ({ lat, lng }) => [Math.ceil(-lat) - 1, Math.floor(lng)];

/** The cells of the square at this distance around a cell. */
function* around([row, column], reach) {
  for (let along = -reach; along <= reach; along += 1) {
    yield [row - reach, column + along];
    yield [row + reach, column + along];
    yield [row + along, column - reach];
    yield [row + along, column + reach];
  }
}
