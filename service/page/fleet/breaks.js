/** Find out at which stops of a route its driver takes breaks: an answer says only when each begins. */

const NEAR = 1e-6; // times that differ by less, relative to them, are equal

/**
 * The breaks at each stop of a route, each `[from, to]`. No break is taken while the vehicle drives: it is at the last stop reached.
 *
 * @param {{ arrivals: number[], breaks?: number[] }} route
 * @param {{ window: number[], length: number }[]} asked the breaks of its vehicle
 */
export function breaksAt({ arrivals, breaks = [] }, asked) {
  const found = arrivals.map(() => []);
  const first = firstOf(breaks, asked);
  for (const [at, from] of breaks.entries()) {
    const stop = arrivals.findLastIndex((arrival) => arrival - from <= NEAR * Math.abs(from));
    found[Math.max(stop, 0)].push([from, from + (asked[first + at]?.length ?? 0)]);
  }
  return found;
}

/** The number of the first break on the way: those before it are over when the vehicle leaves, and none is left out between. */
function firstOf(breaks, asked) {
  const isWithin = (from, { window: [opens, closes] }) => from >= opens * (1 - NEAR) && from <= closes * (1 + NEAR);
  const first = asked.findIndex((_, number) => breaks.every((from, at) => asked[number + at] && isWithin(from, asked[number + at])));
  return Math.max(first, 0);
}
