/** The time of day in a request: when tours may leave, and how the times of travel change. */

import { clockUnit, unitOf } from "../fleet/units.js";
import { kindOf } from "../common/kinds.js";
import { timeOfDay, timeText } from "../common/durations.js";

const [LEAST, MOST] = [0.01, 100]; // factors that the service takes
export const OWN = -2; // in place of the number of an objective
const BETWEEN = /\s*[;\n]\s*|\s*,\s*(?=\d{1,3}:)/;
const PAIR = /^(\d[\d:]*)\s*[×x*=\s]\s*(\d+(?:[.,]\d+)?)$/i;

/** Whether the times of a request can change over the day. */
export const canHaveDay = (asked) => Boolean(asked.stops && Array.isArray(asked.objectives)) && (!kindOf(asked).movers || isTimed(asked));

/** Whether tours of a request can leave at a time; the vehicles of a fleet leave within their shifts. */
export const canDepart = (asked) => !kindOf(asked).movers;

/** Whether a fleet has times, in seconds. */
const isTimed = (asked) => clockUnit(asked) === "s";

/** When tours may leave: the earliest and the latest second of the day; null if at no time in particular. */
export function departuresIn({ departure }) {
  if (departure == null) return null;
  return typeof departure === "object" ? [departure.earliest, departure.latest] : [departure, departure];
}

/** The request whose tours leave at one of these times; null is for none. */
export function leaving({ departure: _, ...others }, times) {
  if (!times) return others;
  const [earliest, latest] = times;
  return { ...others, departure: earliest === latest ? earliest : { earliest, latest } };
}

/** The index of the objective that is measured in seconds of travel, as the service finds it; OWN if a fleet has times of its own, -1 if there are none. */
export function clockIn({ objectives, clock }) {
  if (typeof clock === "object" && clock) return OWN;
  if (clock != null) return objectives.findIndex(({ name }) => name === clock);
  const changing = objectives.findIndex(({ over_the_day: factors, slices, breakpoints, traffic }) => [factors, slices, breakpoints].some((each) => each?.length) || traffic);
  return changing < 0 ? objectives.findIndex((each) => unitOf(each) === "s") : changing;
}

/** How the times of travel change: pairs of a second of the day and a factor from then on. */
export function hoursIn(asked) {
  const { over_the_day: factors, slices } = clockOf(asked);
  return slices?.length ? relative(slices) : (factors ?? []);
}

/** Where the times at each hour come from, if they are not typed: "slices" or breakpoints of a file, or "traffic" that a routing engine knows; else null. */
export function hoursFrom(asked) {
  const { slices, breakpoints, traffic } = clockOf(asked);
  return slices?.length || breakpoints?.length ? "slices" : traffic ? "traffic" : null;
}

/** What measures the times of travel. */
function clockOf(asked) {
  const axis = clockIn(asked);
  return (axis === OWN ? asked.clock : asked.objectives[axis]) ?? {};
}

/**
 * The request whose times of travel change so; those of a fleet under all objectives that are measured as its clock is. Its tours leave from the
 * first of these hours on, if they left at no time.
 */
export function changingOver(asked, hours) {
  const clock = clockOf(asked);
  const source = canDepart(asked) ? null : sourceOf(clock);
  const changed = (each) => {
    if (each !== clock && (!source || typeof each !== "object" || each.measure || sourceOf(each) !== source)) return each;
    const { over_the_day: _, ...others } = each;
    return hours.length ? { ...others, over_the_day: hours } : others;
  };
  const departure = hours.length && canDepart(asked) ? (asked.departure ?? hours[0][0]) : asked.departure;
  return { ...asked, objectives: asked.objectives.map(changed), ...(asked.clock != null && { clock: typeof asked.clock === "object" ? changed(asked.clock) : asked.clock }), ...(departure != null && { departure }) };
}

/** What costs are measured by, whose total or maximum is an objective. */
const sourceOf = ({ name: _, over: __, over_the_day: ___, unit: ____, spread: _____, percentile: ______, ...source }) => JSON.stringify(source);

export const hoursText = (hours) => hours.map(([from, factor]) => `${timeText(from) ?? from} ${factor}`).join("; ");

/** Hours as they are typed; undefined if they are not understood, too large, too small or out of order. */
export function hoursTyped(text) {
  const hours = text.split(BETWEEN).filter(Boolean).map(pair);
  const fine = hours.every((each, at) => each && (!at || each[0] > hours[at - 1]?.[0]));
  return fine ? hours : undefined;
}

function pair(text) {
  const [, time, number] = PAIR.exec(text.trim()) ?? [];
  const [from, factor] = time ? [timeOfDay(time), Number(number.replace(",", "."))] : [];
  return from !== undefined && factor >= LEAST && factor <= MOST ? [from, factor] : undefined;
}

const known = new WeakMap(); // the hours of slices, by these: they are long to sum

/** The mean cost of each slice, as a factor on that of the cheapest one. */
function relative(slices) {
  if (!known.has(slices)) {
    const means = slices.map(({ matrix }) => mean(matrix));
    const least = Math.min(...means);
    known.set(slices, slices.map(({ from }, at) => [from, least > 0 ? means[at] / least : 1]));
  }
  return known.get(slices);
}

/** The mean cost of the legs that are not forbidden, from each stop to another. */
function mean(matrix) {
  const costs = matrix.flatMap((row, from) => row.filter((cost, to) => to !== from && cost != null));
  return costs.reduce((sum, cost) => sum + cost, 0) / (costs.length || 1);
}
