/** The cells of the tables of a fleet: members of stops and vehicles as text, and text as their values. */

import { SECONDS, timeOfDay, timeText } from "../common/durations.js";
import { cellNumber } from "../common/numbers.js";
import { clockUnit } from "./units.js";

const [MINUTE, HOUR] = [60, 3600]; // seconds
const LASTING = /^(?:(\d+) ?h(?: |$))?(?:(\d+) ?min(?: |$))?(?:(\d+(?:\.\d+)?) ?s)?$/;
const BREAK = /^(.+?[-–—].+?)[\s,]+(\S+(?: (?:s|min|h))?)$/;
const BY_VEHICLE = /^(.+?)\s*:\s*(\S+(?: (?:s|min|h))?)$/;
const MINUTES = /^\d{3}$/; // in a unit of minutes: 540 is 9:00
const DOUBTFUL = /^\d\d?[.,]\d$/; // 8.5 may be 8:30 or 8:50
const HALF_OF_DAY = /[ap]\.?m\.?$/i;
const MOST_MINUTES = 120; // 300 may be minutes or seconds
const COUNTED = "a number in the unit of the times";

// The types of columns of numbers.
const NUMBERS = {
  longitude: numbers((value) => Math.abs(value) <= 180, "a number, -180 to 180"),
  latitude: numbers((value) => Math.abs(value) <= 90, "a number, -90 to 90"),
  amount: numbers((value) => value >= 0, "a number, 0 or more"),
  limit: numbers((value) => value > 0, "a number above 0"),
  price: numbers((value) => value >= 0, "a number, 0 or more"),
  count: numbers((value) => value >= 1 && Number.isInteger(value), "a whole number, 1 or more"),
};

/**
 * The types of columns: how a value is written, and how a text is read, which is undefined if it is not
 * understood or refused. Both take the seconds in a unit of time, undefined if that is not known. `hint` says what to write.
 */
const TYPES = {
  text: { write: String, read: (text) => text },
  ...NUMBERS,
  loads: { write: listed, read: (text) => all(text.split(/[\s;,]+/).filter(Boolean), load), hint: "a whole number such as 2, or one for each kind of load, such as 2, 5" },
  words: { write: listed, read: (text) => pieces(text, /[;,|]/) },
  time: { write: writtenTime, read: time, hint: "a time, as 10:30" },
  due: {
    write: (value, second) => spanText(value, second),
    read: (text, second) => time(text, second) ?? span(text, second),
    hint: "a time, as 10:30, or from when and until when, as 10:00-10:30",
  },
  lasting: { write: lastingText, read: lasting, hint: "how long it takes, as 5 min, 0:05 or 300 s" },
  percent: {
    write: (value) => String(cellNumber(100 * value)),
    read: (text) => only((value) => value > 0 && value <= 100, (number(text.replace(/\s*%$/, "")) ?? NaN) / 100),
    hint: "a number of per cent, as 80, of what it is without",
  },
  services: {
    write: (value, second) => listOf(value).map((each) => `${each?.vehicle}: ${lastingText(each?.service, second)}`).join("; "),
    read: (text, second) => all(pieces(text, /;/), (each) => serviceOf(each, second)),
    hint: "how long it takes by some vehicles, as van: 10 min; bike: 5 min",
  },
  long: { write: lastingText, read: (text, second) => (second && isPlain(text) ? undefined : lasting(text, second)), hint: "how long it is, as 8 h, 480 min or 8:00" },
  spans: {
    write: (value, second) => spansOf(value).map((span) => spanText(span, second)).join("; "),
    read: (text, second) => apart(all(pieces(text, /[;,]/), (each) => span(each, second))),
    hint: "two times in order, as 8:00-12:30, or 22:00-26:00, or several in order that neither overlap nor touch, with ; between",
  },
  breaks: {
    write: (value, second) => listOf(value).map((each) => `${spanText(each?.window, second)} ${lastingText(each?.length, second)}`).join("; "),
    read: (text, second) => all(pieces(text, /;/), (each) => pause(each, second)),
    hint: "when it may begin and how long it takes, as 12:00-13:00 30 min",
  },
};

/** The seconds in a unit of a request's times: 1 if it has no clock yet, undefined if the unit is not known. */
export const secondsIn = (asked) => (asked.clock ? SECONDS.get(clockUnit(asked)) : 1);

/** The text of a stop's or vehicle's cell. What was not understood is shown as it was typed. */
export function cellText(item, column, second) {
  const value = valueOf(item, column);
  if (value === undefined || value === null) return "";
  return typeof value === "string" ? value : TYPES[column.type].write(typeof value === "number" ? value / (column.per ?? 1) : value, second);
}

const isNumber = (type) => type in NUMBERS;

/** Whether a cell holds what is not understood or refused, or the name of a stop or vehicle that there is not. */
export const isUnread = (item, column) => unknownIn(item, column) !== undefined;

/** Columns as EditableTable takes them. */
export const headed = (columns) => columns.map(({ title, member, several = "", list, type }) => ({ title, members: `${member} ${several}`, list, text: !isNumber(type) }));

/** The row of a stop or vehicle as EditableTable takes it; `details` are texts of the columns that are details. */
export const rowOf = (item, columns, second, details = []) => ({
  name: item?.id ?? "",
  cells: columns.map((each) => (each.detail === undefined ? cellText(item, each, second) : (details[each.detail] ?? ""))),
  unread: columns.flatMap((each, at) => (isUnread(item, each) ? [at] : [])),
});

/** The first text in a cell that is not understood, or not such a name; undefined if there is none. */
export const unknownIn = (item, column) =>
  listOf(valueOf(item, column)).find((each) => typeof each === "string" && !(column.names?.includes(each) ?? ["text", "words"].includes(column.type)));

/** What to write into a cell of a column. */
export const hintOf = ({ type }, second) => (!second && ["time", "due", "spans", "lasting", "long", "services"].includes(type) ? COUNTED : TYPES[type].hint);

/** A stop or vehicle with another text in one of its cells; without text, its member goes. */
export function withText(item, { member, several, part, type, per = 1 }, text, second) {
  const changed = { ...item };
  const read = text && (TYPES[type].read(text, second) ?? text);
  const value = typeof read === "number" ? read * per : read;
  if (part !== undefined) return { ...changed, [member]: (item[member] ?? [0, 0]).with(part, value) };
  for (const each of [member, several]) delete changed[each];
  if (!text) return changed;
  const many = several && Array.isArray(value) && value.length !== 1;
  changed[many ? several : member] = several && !many && Array.isArray(value) ? value[0] : value;
  return changed;
}

function valueOf(item, { member, several, part }) {
  const value = item?.[several] ?? item?.[member];
  return part === undefined ? value : value?.[part];
}

const listOf = (value) => (Array.isArray(value) ? value : [value]);
const spansOf = (value) => (Array.isArray(value[0]) ? value : value.length ? [value] : []);
const spanText = (span, second) => listOf(span).map((each) => writtenTime(each, second)).join("-");
const pieces = (text, separator) => text.split(separator).map((each) => each.trim()).filter(Boolean);

/** Texts as a list of values; undefined if one is not understood, or there is none. */
function all(texts, read) {
  const values = texts.map(read);
  return values.length && values.every((each) => each !== undefined) ? values : undefined;
}

function listed(value) {
  return listOf(value).join(", ");
}

function numbers(accepts, hint) {
  return { write: (value) => String(cellNumber(value)), read: (text) => only(accepts, number(text)), hint };
}

const only = (accepts, value) => (accepts(value) ? value : undefined);
const isPlain = (text) => /^[\d.,]+$/.test(text);
const load = (text) => only((value) => value >= 0 && Number.isInteger(value), number(text));

function number(text) {
  const value = Number(text.replace(",", "."));
  return text.trim() && Number.isFinite(value) ? value : undefined;
}

/** A time: hours of the day as 8 or 8.30, where the unit is one of time, or a larger number in that unit. */
function time(text, second) {
  const isCounted = !text.includes(":") && (!second || (second === MINUTE && MINUTES.test(text)));
  const seconds = isCounted ? undefined : timeOfDay(text);
  if (seconds !== undefined) return second && seconds / second;
  return second < HOUR && DOUBTFUL.test(text) ? undefined : NUMBERS.amount.read(text);
}

function writtenTime(value, second) {
  return timeText(value * second) ?? String(value);
}

/** How long something takes; a plain number is one of minutes, unless it is too large to be that without doubt. */
function lasting(text, second) {
  const [whole, hours = 0, minutes = 0, seconds = 0] = LASTING.exec(text) ?? [];
  if (whole) return second && (HOUR * hours + MINUTE * minutes + Number(seconds)) / second;
  if (text.includes(":")) return time(text, second);
  const value = NUMBERS.amount.read(text);
  return second && value > MOST_MINUTES ? undefined : second && value !== undefined ? (value * MINUTE) / second : value;
}

function lastingText(value, second) {
  const seconds = value * second;
  if (!(seconds >= 0)) return String(value);
  return seconds % MINUTE ? `${Number(seconds.toFixed(3))} s` : `${seconds / MINUTE} min`;
}

function span(text, second) {
  const texts = text.split(/\s*(?:[-–—]|\b(?:to|bis)\b)\s*/);
  const [half] = HALF_OF_DAY.exec(texts[1]) ?? [];
  if (half) texts[0] = [half, "am"].map((each) => texts[0] + each).find((each) => timeOfDay(each) <= timeOfDay(texts[1])) ?? texts[0];
  const ends = all(texts, (each) => time(each, second));
  return ends?.length === 2 && ends[0] <= ends[1] ? ends : undefined;
}

/** Spans that each begin after the one before; undefined if they do not. */
const apart = (spans) => (spans?.every(([from], at) => !at || from > spans[at - 1][1]) ? spans : undefined);

/** How long a visit takes by vehicles of an id. */
function serviceOf(text, second) {
  const [, vehicle, long] = BY_VEHICLE.exec(text) ?? [];
  const service = long === undefined ? undefined : lasting(long, second);
  return service === undefined ? undefined : { vehicle, service };
}

function pause(text, second) {
  const [, between, long] = BREAK.exec(text) ?? [];
  const [window, length] = between ? [span(between, second), lasting(long, second)] : [];
  return window && length !== undefined ? { window, length } : undefined;
}
