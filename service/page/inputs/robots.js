/** Make the request for another number of robots on a map: one has tours, several have plans. */

import { isProposed, withoutLayer } from "./map_proposal.js";

const ENDS = ["start", "end", "start_pose", "end_pose"];
// What is about the tours of one robot alone.
const OF_ONE = ["cost_layers", "names", "shaded", "detours", "initial_tours", "preferences", "repairs", "arrivals", "bound", "actor"];

const only = (members, names) => Object.fromEntries(Object.entries(members).filter(([name]) => names.includes(name)));
const without = (members, names) => Object.fromEntries(Object.entries(members).filter(([name]) => !names.includes(name)));

/** A request on a map for so many robots. The first keeps its ends, and further ones start at the first place until they are put elsewhere. */
export function withRobots(request, count) {
  const { robots, over, ...others } = request;
  if (count === 1) return robots ? withoutLayer({ ...others, ...only(robots[0], ENDS) }, 0) : request;
  const before = robots ?? [{ id: "robot 1", ...only(request, request.closed === false ? ENDS : ["start", "start_pose"]) }];
  const added = before.slice(0, count);
  for (let number = 1; added.length < count; number += 1) {
    if (added.every(({ id }) => id !== `robot ${number}`)) added.push({ id: `robot ${number}` });
  }
  const costs = isProposed(request) ? ["cost_layer"] : [];
  return { ...without(robots ? request : others, [...ENDS, ...OF_ONE, ...costs]), robots: added.map((robot) => (robot.start === null ? without(robot, ["start"]) : robot)) };
}
