/** The kinds of plans, a row each: looked up by what a request is of, or by what an answer says that it is. */

const TOURS = { one: "tour", many: "tours" };
const PLANS = { one: "plan", many: "plans" };

// Those who go a plan's routes, in words; the members of a route that say who does, and what it visits; and what Python prints of it.
const VEHICLES = { one: "Vehicle", many: "Vehicles", stops: "Stops", listed: "Stops of each vehicle", by: "vehicle", through: "stops", printed: "route.stops" };
const ROBOTS = { one: "Robot", many: "Robots", stops: "Places", listed: "Places of each robot", by: "robot", through: "tour", printed: "(route.robot, route.tour.tolist())" };

// A front is asked for at a `path`, in Python by a `call`; it holds what the `noun` says: tours, or plans with routes of `movers`.
const KINDS = {
  front: { path: "front", call: "front", noun: TOURS },
  coverage: { path: "coverage", call: "coverage", noun: TOURS, onGrid: true },
  fleet: { path: "fleet", call: "fleet", noun: PLANS, movers: VEHICLES },
  robots: { path: "coverage", call: "robots", noun: PLANS, movers: ROBOTS, onGrid: true },
};

/** The kind of an answer. */
export const kindNamed = ({ kind }) => KINDS[kind];

/** The kind of a request; where nothing is known of it, that of a front. */
export const kindOf = ({ vehicles, grid, robots }) =>
  KINDS[Array.isArray(vehicles) ? "fleet" : !grid ? "front" : Array.isArray(robots) ? "robots" : "coverage"];

/** Which member of a request for a front has its stops; null for other kinds, or where that is not known. */
export const formOf = (request) =>
  (kindOf(request) === KINDS.front && ["matrices", "coordinates", "stops"].find((member) => request[member])) || null;
