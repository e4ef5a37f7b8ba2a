/** The table of the kinds of plans: looked up for a request by its members, or for an answer by its `kind`. */

const TOURS = { one: "tour", many: "tours" };
const PLANS = { one: "plan", many: "plans" };

// The names of vehicles or robots on the page; the members of a route with its mover and its visits; and how Python prints it.
const VEHICLES = {
  one: "Vehicle", many: "Vehicles", words: "vehicles", stops: "Stops", listed: "Stops of each vehicle",
  by: "vehicle", through: "stops", printed: "route.stops",
};
const ROBOTS = {
  one: "Robot", many: "Robots", words: "robots", stops: "Places", listed: "Places of each robot",
  by: "robot", through: "tour", printed: "(route.robot, route.tour.tolist())",
};

// The `path` of HTTP, the `call` in Python, and the `noun` of what a front holds: tours, or plans with routes of `movers`.
const KINDS = {
  front: { path: "front", call: "front", noun: TOURS },
  coverage: { path: "coverage", call: "coverage", noun: TOURS, onGrid: true },
  fleet: { path: "fleet", call: "fleet", noun: PLANS, movers: VEHICLES },
  robots: { path: "coverage", call: "robots", noun: PLANS, movers: ROBOTS, onGrid: true },
};

/** The kind of an answer. */
export const kindNamed = ({ kind }) => KINDS[kind];

/** The kind of a request; that of a front if nothing is known. */
export const kindOf = ({ vehicles, grid, robots }) =>
  KINDS[Array.isArray(vehicles) ? "fleet" : !grid ? "front" : Array.isArray(robots) ? "robots" : "coverage"];

/** The member with the stops in a request for a front; null for other kinds, or if it is not known. */
export const formOf = (request) =>
  (kindOf(request) === KINDS.front && ["matrices", "coordinates", "stops"].find((member) => request[member])) || null;
