/** Propose what to plan on a robot's map that only shows its walls. */

import { DISTANCE } from "../common/objectives.js";

const REACH = 10; // cells from a wall within which driving is a risk
const [STRAIGHT, DIAGONAL] = [1, Math.SQRT2];
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

/** How near each cell is to an obstacle, as a risk: from 1 at a wall to 0 where no wall is in reach. */
const nearness = (grid) =>
  distances(grid).map((row) => row.map((cells) => Number(Math.max(0, 1 - cells / REACH).toFixed(2))));

/** Cells to the nearest blocked one, in straight and diagonal steps: one pass down, one up. */
function distances(grid) {
  const far = grid.map((row) => row.map((cell) => (cell ? 0 : Infinity)));
  const forwards = [[-1, -1, DIAGONAL], [-1, 0, STRAIGHT], [-1, 1, DIAGONAL], [0, -1, STRAIGHT]];
  pass(far, forwards, (size) => Array.from({ length: size }, (_, index) => index));
  const backwards = forwards.map(([row, column, step]) => [-row, -column, step]);
  pass(far, backwards, (size) => Array.from({ length: size }, (_, index) => size - 1 - index));
  return far;
}

function pass(far, steps, order) {
  for (const row of order(far.length)) {
    for (const column of order(far[row].length)) {
      for (const [down, right, step] of steps) {
        const before = far[row + down]?.[column + right] ?? Infinity;
        far[row][column] = Math.min(far[row][column], before + step);
      }
    }
  }
}
