/** Propose what to plan on a robot's map that only shows its walls. */

import { nearness } from "./nearness.js";
import { DISTANCE } from "../common/objectives.js";

const PLACES_ACROSS = 12; // places along the longer side
const OF_MAP = ["grid", "cell_size", "origin", "cost_layers"];
const OBJECTIVES = [DISTANCE, { name: "nearness to walls", unit: "" }];

/**
 * The request itself; for a map alone, a request to visit places all over it: short against the cost layers that came
 * with it, or else against far from walls.
 */
export function proposed(request) {
  const { grid, cell_size: cell } = request;
  if (!grid || !cell || Object.keys(request).some((member) => !OF_MAP.includes(member))) return request;
  const longest = Math.max(grid.length, grid[0].length);
  const spacing = Math.ceil((cell * longest * 100) / PLACES_ACROSS) / 100;
  const costs = request.cost_layers ? {} : { names: OBJECTIVES, cost_layer: nearness(grid) };
  return { ...costs, ...request, robot_radius: 0, spacing };
}
