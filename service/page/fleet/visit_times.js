/** Compute the times of a route: at each stop the arrival, the begin of the visit, and its end. */

/**
 * @param {{ stops: string[], arrivals: number[] }} route
 * @param {Map<string, object>} asked the stops of the request by id, with their service and windows
 */
export function visitTimes({ stops, arrivals }, asked) {
  return stops.map((stop, at) => {
    const { service = 0, window } = asked.get(stop) ?? {};
    const arrival = arrivals[at];
    // At the first stop the time is that of the departure, unless it is a visit itself.
    const begin = Math.max(arrival, window?.[0] ?? arrival);
    return { stop, arrival, begin, end: begin + service };
  });
}
