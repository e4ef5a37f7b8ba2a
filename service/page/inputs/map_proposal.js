/** Propose what to plan on a robot's map that only shows its walls. */

import { nearness } from "./nearness.js";
import { DISTANCE } from "../common/objectives.js";

const PLACES_ACROSS = 12; // places along the longer side
const OF_MAP = ["grid", "cell_size", "origin", "cost_layers"];
const NEARNESS = "nearness to walls";
const OBJECTIVES = [DISTANCE, { name: NEARNESS, unit: "" }];

/**
 * The request itself; for a map alone, a request to visit places all over it: short against the cost layers that came
 * with it, or else against far from walls.
 */
export function proposed(request) {
  const { grid, cell_size: cell } = request;
  if (!grid || !cell || Object.keys(request).some((member) => !OF_MAP.includes(member))) return request;
  const longest = Math.max(grid.length, grid[0].length);
  const spacing = Math.ceil((cell * longest * 100) / PLACES_ACROSS) / 100;
  const costs = request.cost_layers ? {} : nearnessOf(grid);
  return { ...costs, ...request, robot_radius: 0, spacing };
}

/** The members of a request whose costs are those of nearness to walls. */
const nearnessOf = (grid) => ({ names: OBJECTIVES, cost_layer: nearness(grid) });

/** Whether the costs of a request are those that the page proposes. */
export const isProposed = ({ names }) => names?.[1]?.name === NEARNESS;

/** The request without one of its cost layers. One robot needs costs: without the last layer they are of nearness to walls. */
export function withoutLayer({ cost_layer: _, cost_layers: layers, names: __, shaded: ___, ...rest }, at) {
  const left = layers?.toSpliced(at, 1) ?? [];
  if (left.length) return { ...rest, cost_layers: left };
  return Array.isArray(rest.robots) ? rest : { ...rest, ...nearnessOf(rest.grid) };
}
