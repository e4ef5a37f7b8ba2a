/** Keep details of stops: columns of a table that tell drivers something, such as customers and notes. They are never sent to be planned. */

/**
 * A request whose `details` are a list of `{ column, texts }`, with a text for each stop, or without that member if they are
 * something else: links and files come from anywhere.
 */
export function withSoundDetails(asked) {
  return isSound(asked.details) ? asked : withoutDetails(asked);
}

export function withoutDetails({ details: _, ...others }) {
  return others;
}

/** The member `details` of a request, changed in the same way for each column; none for a request without details. */
const changed = (details, change) => (details ? { details: details.map(({ column, texts }) => ({ column, texts: change(texts) })) } : {});

/** The member once the stop in a row is deleted. */
export const detailsWithout = ({ details }, row) => changed(details, (texts) => texts.toSpliced(row, 1));

/** The member once a stop is added after the others. */
export const detailsWithAnother = ({ details }) => changed(details, (texts) => [...texts, ""]);

/**
 * The member once other rows were typed: those of stops with the same ids, or in the same rows if no ids were typed.
 *
 * @param {{ details?: object[] }} asked
 * @param {string[] | null} before the ids of the stops before
 * @param {string[] | undefined} ids those that were typed
 * @param {number} count how many rows were typed
 */
export function detailsOfTyped({ details }, before, ids, count) {
  const rows = Array.from({ length: count }, (_, row) => (ids ? before?.indexOf(ids[row]) : row));
  return changed(details, (texts) => rows.map((row) => texts[row] ?? ""));
}

/** What a driver is told of the stop of a name, as a function of that: pairs of a column and a text, which may be "". */
export function detailsByStop({ details = [], stops, ids }) {
  const names = stops?.map(({ id }) => id) ?? ids;
  const rows = new Map(names?.map((name, row) => [String(name), row]));
  const rowOf = (name) => (names ? rows.get(String(name)) : Number(name) - 1);
  return (name) => details.map(({ column, texts }) => [column, texts[rowOf(name)] ?? ""]);
}

/** The columns of a table for the details of a request, each with its number among them in `detail`. */
export const detailColumns = ({ details = [] }) => details.map(({ column }, detail) => ({ title: column, member: "details", type: "text", text: true, detail }));

/** The request with another text in the cell of a detail. */
export const withDetail = (asked, detail, row, text) => ({
  ...asked,
  details: asked.details.map((each, at) => (at === detail ? { ...each, texts: asked.stops.map((_, stop) => (stop === row ? text : (each.texts[stop] ?? ""))) } : each)),
});

/** The names of the details that have a text, for a sentence. */
export const columnsIn = ({ details = [] }) => details.filter(({ texts }) => texts.some(Boolean)).map(({ column }) => column).join(", ").replace(/, ([^,]*)$/, " and $1");

const BRIEF = 60; // characters

/** Who or what is at the stop of a name, in a few words: what its details say; "" where nothing is known. */
export function customersIn(asked) {
  const known = detailsByStop(asked ?? {});
  return (name) => cut(known(name).map(([, text]) => text).filter(Boolean).join(", "));
}

const cut = (text) => (text.length > BRIEF ? `${text.slice(0, BRIEF - 1).trimEnd()}…` : text);

/** The name of a stop with what is behind it, such as "A10260 (Bakery Kanto)". */
export const withCustomer = (name, customer) => (customer ? `${name} (${customer})` : name);

const isTexts = (texts) => Array.isArray(texts) && texts.every((text) => typeof text === "string");
const isSound = (details) => Array.isArray(details) && details.every((each) => typeof each?.column === "string" && isTexts(each.texts));
