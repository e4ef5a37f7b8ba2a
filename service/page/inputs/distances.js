/** Distances: in a plane as TSPLIB's EUC_2D has them, rounded to whole numbers, and on the earth. */

const RADIUS = 6371008.8; // metres, the earth's mean one, as the service takes it

/** From each place to each. */
export const rounded = (places) =>
  places.map((from) => places.map((to) => Math.floor(distance(from, to) + 0.5)));

/** Not Math.hypot, whose last digit may be another, and decide what a half is rounded to. */
function distance([x, y], [u, v]) {
  return Math.sqrt((x - u) * (x - u) + (y - v) * (y - v));
}

/** Metres between two places of longitude and latitude, on a sphere (haversine formula). */
export function metres([east, north], [otherEast, otherNorth]) {
  const half = (degrees) => Math.sin((degrees * Math.PI) / 360) ** 2;
  const level = Math.cos((north * Math.PI) / 180) * Math.cos((otherNorth * Math.PI) / 180);
  return 2 * RADIUS * Math.asin(Math.sqrt(Math.min(1, half(otherNorth - north) + level * half(otherEast - east))));
}
