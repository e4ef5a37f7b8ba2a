/** Turn a picture of a map into a coverage task: dark is blocked, nearness to walls is risk. */

const REACH = 10; // cells from a wall, beyond which there is no risk
const PLACES_ACROSS = 12; // places along the longer side, as a first proposal
const CELL = 0.05; // metres, as robots' maps mostly have it
const STRAIGHT = 1;
const DIAGONAL = Math.SQRT2;

export const OBJECTIVES = [
  { name: "distance", unit: "m" },
  { name: "nearness to walls", unit: "" },
];

export async function coverageOf(file) {
  const grid = occupancy(await pixels(file));
  const spacing = Math.ceil((CELL * Math.max(grid.length, grid[0].length) * 100) / PLACES_ACROSS) / 100;
  return { grid, cost_layer: risk(grid), cell_size: CELL, robot_radius: 0, spacing };
}

async function pixels(file) {
  let picture;
  try {
    picture = await createImageBitmap(file);
  } catch {
    throw new Error(`${file.name} must be a picture, and is not`);
  }
  const canvas = new OffscreenCanvas(picture.width, picture.height);
  const context = canvas.getContext("2d");
  context.drawImage(picture, 0, 0);
  return context.getImageData(0, 0, picture.width, picture.height);
}

function occupancy({ data, width, height }) {
  const dark = (pixel) => data[4 * pixel] + data[4 * pixel + 1] + data[4 * pixel + 2] < 3 * 128;
  return Array.from({ length: height }, (_, row) =>
    Array.from({ length: width }, (_, column) => (dark(row * width + column) ? 1 : 0)),
  );
}

/** From 1 beside a wall to 0 where none is in reach. */
const risk = (grid) =>
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
