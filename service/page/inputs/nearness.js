/** Compute how near each cell of a grid is to an obstacle, as a risk. */

const REACH = 10; // cells from a wall, beyond which there is no risk
const STRAIGHT = 1;
const DIAGONAL = Math.SQRT2;

/** The nearness, from 1 at a wall to 0 where no wall is in reach. */
export const nearness = (grid) =>
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
