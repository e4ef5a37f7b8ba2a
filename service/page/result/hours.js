/** The hours of a tour over the day, in words. */

import { clockOf } from "../fleet/times.js";

/** When a tour leaves, as it reaches each of its stops, and when it ends; none of a tour without a day. */
export function hoursOf(tour) {
  if (!tour?.times) return [];
  const clock = clockOf([tour.departure, ...tour.times], "s");
  return tour.times.map(clock.said);
}
