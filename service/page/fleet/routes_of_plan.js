/** The routes of a plan by vehicle or robot: their names, their stops, and which of these are visits. */

const VEHICLES = { one: "Vehicle", many: "Vehicles", stops: "Stops", listed: "Stops of each vehicle" };
const ROBOTS = { one: "Robot", many: "Robots", stops: "Places", listed: "Places of each robot" };

/** What a plan's routes are of, in words. Of places that robots visit none is left out. */
export const wordsOf = ({ unassigned }) => (unassigned ? VEHICLES : ROBOTS);

/** What each route is called: its robot, or its type of vehicle, with a number where several routes have one type. */
export function namesOf(routes) {
  const used = new Map();
  return routes.map((route) => {
    const name = movedBy(route);
    if (routes.filter((other) => movedBy(other) === name).length === 1) return name;
    used.set(name, (used.get(name) ?? 0) + 1);
    return `${name} ${used.get(name)}`;
  });
}

/** The id of the robot, or of the type of vehicle, whose route it is. */
export const movedBy = ({ vehicle, robot }) => robot ?? vehicle;

/** The stops of a route in order: ids, or of robots the indexes of places. */
export const stopsOf = ({ stops, tour }) => stops ?? tour;

/** How many stops a route visits, beside those at which it starts and ends. */
export function visits(route, asked) {
  const stops = stopsOf(route);
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
