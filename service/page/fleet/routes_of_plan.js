/** The routes of a plan by vehicle: their names, and which of their stops are visits. */

/** What each route is called: its type of vehicle, with a number where several routes have one type. */
export function vehicleNames(routes) {
  const used = new Map();
  return routes.map(({ vehicle }) => {
    if (routes.filter((route) => route.vehicle === vehicle).length === 1) return vehicle;
    used.set(vehicle, (used.get(vehicle) ?? 0) + 1);
    return `${vehicle} ${used.get(vehicle)}`;
  });
}

/** How many stops a route visits, beside those at which its vehicle starts and ends. */
export function visits({ vehicle, stops }, vehicles) {
  const type = vehicles?.find(({ id }) => id === vehicle);
  const round = stops.length > 1 && stops[0] === stops.at(-1);
  const ends = type ? [type.start, type.end].filter((end) => end != null).length : round ? 2 : 0;
  return stops.length - ends;
}
