/** Distances in a plane as TSPLIB's EUC_2D has them: rounded to whole numbers. */

/** From each place to each. */
export const rounded = (places) =>
  places.map((from) => places.map((to) => Math.floor(distance(from, to) + 0.5)));

/** Not Math.hypot, whose last digit may be another, and decide what a half is rounded to. */
function distance([x, y], [u, v]) {
  return Math.sqrt((x - u) * (x - u) + (y - v) * (y - v));
}
