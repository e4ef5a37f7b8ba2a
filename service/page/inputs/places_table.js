/** The table of places: its columns and cells, of stops on the earth or of rows of planes. */

import { detailColumns, withDetail } from "./details.js";
import { isCity, nameOf } from "./places.js";
import { moved } from "./stops.js";
import { cellNumber } from "../common/numbers.js";

const PLANES = ["x₁", "y₁", "x₂", "y₂"].map((title) => ({ title }));
const EARTH = ["Longitude", "Latitude"].map((title, part) => ({ title, members: "location", part }));
const DEGREES = [180, 90]; // at most

/** Whether the stops of a request of this form have a table. */
export const hasTable = (form) => ["coordinates", "stops"].includes(form);

/** The columns of the table; those of planes below the objective that is measured in them. */
export function columnsOfPlaces(form, asked, objectives) {
  if (form === "coordinates") return PLANES.map((column, at) => ({ ...column, part: at, group: objectives[Math.floor(at / 2)].name }));
  return form === "stops" ? [...detailColumns(asked).map((each) => ({ ...each, members: "details" })), ...EARTH] : [];
}

/** The rows of the table, as of EditableTable; `rows` are those of planes. */
export function rowsOfPlaces(form, { stops, ids, details = [] }, rows) {
  const shown = (value) => (typeof value === "number" ? cellNumber(value) : value);
  if (form === "coordinates") return rows.map((cells, city) => ({ name: nameOf(ids, city), cells: cells.map(shown) }));
  if (form !== "stops") return [];
  return stops.map(({ id, location }, row) => ({ name: id, cells: [...details.map(({ texts }) => texts[row] ?? ""), ...([location ?? []].flat().map(shown))] }));
}

/** The request for stops with other texts in cells of the table, and whether each place among them is one. */
export function withCells(asked, columns, cells) {
  let [changed, isRead] = [asked, true];
  for (const { row, column, text } of cells) {
    const { part, detail } = columns[column];
    if (detail !== undefined) changed = withDetail(changed, detail, row, text);
    else {
      const value = numberOr(text);
      changed = moved(changed, row, part, value);
      isRead &&= isPlaced(value, part, true);
    }
  }
  return [changed, isRead];
}

/** The same for rows of planes. */
export function withNumbers(rows, cells) {
  const changed = cells.reduce((before, { row, column, text }) => before.with(row, before[row].with(column, numberOr(text))), rows);
  return [changed, cells.every(({ row }) => isCity(changed[row]))];
}

/** The first place that is not of numbers, as an error of a request; undefined if there is none. */
export function misplacedIn(form, stops, rows, nameOfStop) {
  const columns = form === "stops" ? EARTH : form === "coordinates" ? PLANES : [];
  const places = stops?.map(({ location }) => [location ?? []].flat()) ?? rows;
  for (const [row, place] of places.entries()) {
    const column = columns.findIndex((_, at) => at in place && !isPlaced(place[at], at, Boolean(stops)));
    const at = form === "stops" ? `location/${column}` : column;
    if (column >= 0) return { pointer: `/${form}/${row}/${at}`, detail: `${columns[column].title} of ${nameOfStop(row) ?? `stop ${row + 1}`} must be a number` };
  }
}

const isPlaced = (value, column, onEarth) => Number.isFinite(value) && !(onEarth && Math.abs(value) > DEGREES[column]);

function numberOr(text) {
  const number = text.replace(",", ".");
  return number === "" || Number.isNaN(Number(number)) ? number : Number(number);
}
