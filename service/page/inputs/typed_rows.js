/** Let the service read typed rows of cities, as it reads files, once the typing pauses. */

import { inRows } from "./instance.js";
import { nameOf } from "../planning/faults.js";
import { Problem } from "../planning/service.js";

const PAUSE = 250; // ms without a key
const ABOUT_TEXT = ["unreadable-file", "file-too-large"]; // codes of refusals
const PLANES = ["x", "y", "second x", "second y"];
const FOUR = "each stop must have 4 items: x and y in the first plane, then in the second";

export class TypedRows {
  #service;
  #onRead;
  #text = null; // the text that was typed and is not read yet
  #timer = 0;
  #reading = new AbortController();

  /** @param {(found: { coordinates: number[][], ids?: string[] }) => void} onRead called with what was typed */
  constructor(service, onRead) {
    this.#service = service;
    this.#onRead = onRead;
  }

  /** Whether something was typed that is not read yet, or cannot be. */
  get waiting() {
    return this.#text !== null;
  }

  typed(text) {
    this.forget();
    this.#text = text;
    // A refused row may be half typed: this is reported when it is planned.
    this.#timer = setTimeout(() => this.settle().catch(disregard), PAUSE);
  }

  forget() {
    clearTimeout(this.#timer);
    this.#reading.abort();
    this.#text = null;
  }

  /** Reads now what was typed. Throws a Problem that names the row, or an AbortError. */
  async settle(reading = new AbortController()) {
    clearTimeout(this.#timer);
    this.#reading.abort();
    this.#reading = reading;
    const found = this.#text.trim() ? await this.#read(this.#text, reading.signal) : { coordinates: [] };
    reading.signal.throwIfAborted();
    this.#text = null;
    this.#onRead(found);
  }

  async #read(text, signal) {
    const rows = prepared(text);
    const file = new File([rows], "rows");
    const { request } = await this.#service.read([file], signal, columnsOf(rows)).catch((error) => {
      throw ABOUT_TEXT.includes(error.code) ? aboutRow(error) : error;
    });
    const found = inRows(request);
    // More planes are opened as a file: the table beside the box has two.
    if (!found.coordinates || found.coordinates[0]?.length > 4) throw refusal(FOUR);
    return found;
  }
}

/** Without empty lines a row's number is its stop's; its sign keeps `0, 1, 2, 3` from being a heading, as pandas writes it. */
const prepared = (text) => text.replace(/^\s*\n/gm, "").replace(/^\s*(?=\d)/, "+");

/** What rows of four numbers are taken for, maybe behind a name: the box says it, where a file would be asked about. */
function columnsOf(rows) {
  const [first] = rows.trimStart().split("\n");
  const separator = [";", "\t", "|", ","].find((sign) => first.includes(sign)) ?? /\s+/;
  const fields = first.trim().split(separator).map((field) => field.trim());
  const named = fields.length === PLANES.length + 1 && !isNumber(fields[0]);
  if (!fields.slice(named ? 1 : 0).every(isNumber) || fields.length - named !== PLANES.length) return [];
  const taken = named ? ["id", ...PLANES] : PLANES;
  return taken.map((field, at) => ({ file: "rows", name: `${at + 1}`, taken_for: field }));
}

const isNumber = (field) => /^[-+\u2212]?[\d.,]*\d[\d.,]*(e[-+]?\d+)?$/i.test(field);

// What is wrong with rows, where the page says it in other words, by the code of the fault.
const DEMANDS = {
  "other-fields": ({ fields, came }) => `must have ${fields} items, as the first row, got ${came}`,
  "row-of-one": ({ fields, came }) => `must have ${fields} item, as the first row, got ${came}; a text with a separator in it needs quotation marks`,
};

/** The same refusal, of the stop and the number that it is about. */
function aboutRow({ message, errors: [{ code, detail, demand, values }] }) {
  const more = message.slice(detail.length); // how many others there are
  if (["no-places", "which-places"].includes(code)) return refusal(FOUR);
  if (!values.row) return refusal(`${detail.slice(values.file.length + 2)}${more}`);
  const { row, column } = values;
  const number = ["1", "2", "3", "4"].includes(column) ? [column - 1] : [];
  const other = column && !number.length ? `, column '${column}'` : "";
  const name = nameOf(["coordinates", row - 1, ...number]);
  return refusal(`${name}${other} ${DEMANDS[code]?.(values) ?? demand}${more}`, row - 1);
}

function refusal(detail, row = "") {
  return new Problem({ code: "unreadable-file", detail, errors: [{ pointer: `/cities/${row}`, detail }] });
}

function disregard(error) {
  if (!(error instanceof Problem) && error.name !== "AbortError") throw error;
}
