/** The clock of a plan or tour: its times in words, and the marks of an axis. */

import { SECONDS } from "../common/durations.js";

const STEPS = [1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 14400, 21600, 43200, 86400]; // seconds
const DAY = 86400; // seconds
const SHORT = 1800; // seconds in all, up to which seconds are shown

/**
 * The clock of these times, from the first to the last. `said` puts a time into words, and `marks`
 * returns at most `most` round times. If the unit is one of time, times are hours and minutes, from
 * 24 hours on with the number of the day.
 */
export function clockOf(times, unit) {
  const from = times.reduce((least, time) => Math.min(least, time));
  const to = times.reduce((most, time) => Math.max(most, time));
  const second = SECONDS.get(unit);
  const short = (to - from) * second < SHORT;
  const said = second ? (time) => hours(time * second, short) : (time) => `${Number(time.toPrecision(6))}${unit && ` ${unit}`}`;
  return { from, to, said, marks: (most) => multiples(from, to, stepOf((to - from) / most, second)) };
}

/** When a tour over the day leaves, as it reaches each of its stops, and when it ends; none of a tour without a day. */
export function hoursOf(tour) {
  if (!tour?.times) return [];
  return tour.times.map(clockOf([tour.departure, ...tour.times], "s").said);
}

/** Hours and minutes, and seconds too if the whole time is short. */
function hours(seconds, short) {
  const two = (value) => String(value).padStart(2, "0");
  const all = short ? Math.round(seconds) : 60 * Math.round(seconds / 60);
  const day = all < DAY ? "" : `day ${Math.floor(all / DAY) + 1}, `;
  const minutes = `${day}${Math.floor(all / 3600) % 24}:${two(Math.floor(all / 60) % 60)}`;
  return short ? `${minutes}:${two(all % 60)}` : minutes;
}

/** The least round step that is at least this one. */
function stepOf(least, second) {
  const known = second && STEPS.find((each) => each >= least * second);
  if (known) return known / second;
  const tens = 10 ** Math.floor(Math.log10(least));
  return tens * [1, 2, 5, 10].find((each) => each * tens >= least);
}

function multiples(from, to, step) {
  if (!(step > 0)) return [from]; // all at one time, or too near to each other
  const first = Math.ceil(from / step);
  return Array.from({ length: Math.floor(to / step) - first + 1 }, (_, at) => (first + at) * step);
}
