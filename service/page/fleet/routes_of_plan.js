/** The routes of a plan by vehicle or robot: their names, and how much they visit. */

/** The name of each route: its robot, or its type of vehicle, with a number if several routes have that type. */
export function namesOf(routes, { by }) {
  const used = new Map();
  return routes.map(({ [by]: name }) => {
    if (routes.filter((other) => other[by] === name).length === 1) return name;
    used.set(name, (used.get(name) ?? 0) + 1);
    return `${name} ${used.get(name)}`;
  });
}

/** How many stops a route visits, beside those at which it starts and ends. */
export function visits(route, { through }, asked) {
  const stops = route[through];
  const ends = endsOf(route, asked);
  const round = stops.length > 1 && stops[0] === stops.at(-1);
  return stops.length - (ends ? ends.filter((end) => end != null).length : round ? 2 : 0);
}

/** Where the request wants a route to start and end; undefined if that is not known. */
function endsOf({ vehicle, robot }, { vehicles = [], robots = [], closed }) {
  const type = vehicles.find(({ id }) => id === vehicle);
  if (type) return [type.start, type.end];
  const one = robots.find(({ id }) => id === robot);
  const start = one?.start_pose ?? one?.start ?? 0;
  return one && [start, closed === false ? (one.end_pose ?? one.end) : start];
}
