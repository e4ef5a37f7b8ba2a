/** Turn a map of a robot into a coverage request: a picture, a map.yaml of ROS with its picture, or a message of ROS. */

import { AS_IT_LOOKS, blockedCells } from "./shades.js";
import { interpretation } from "./map_yaml.js";
import { pictureOf } from "./pictures.js";
import { blockedOf, isMessage, placeOf } from "./message.js";
import { nearness } from "./nearness.js";

const PLACES_ACROSS = 12; // places along the longer side, as a first proposal
const CELL = 0.05; // metres, as robots' maps mostly have it

export const OBJECTIVES = [
  { name: "distance", unit: "m" },
  { name: "nearness to walls", unit: "" },
];

const YAML = /\.ya?ml$/i;

/** Whether a file is a picture of a map, or says how to read one. */
export const isOfMap = ({ name, type }) => type.startsWith("image/") || YAML.test(name) || /\.pgm$/i.test(name);

/** The request of a picture, and of the map.yaml that may come with it. */
export async function coverageOf(files) {
  const [yaml, ...yamls] = files.filter(({ name }) => YAML.test(name));
  const [picture, ...others] = files.filter(({ name }) => !YAML.test(name));
  if (yamls.length || others.length) throw new Error(`one map is wanted: a picture, or one with its map.yaml, got ${files.length} files`);
  const said = yaml ? interpretation(yaml.name, await yaml.text()) : { how: AS_IT_LOOKS, place: { cell_size: CELL } };
  if (!picture) throw new Error(`${yaml.name} says how to read ${said.image}: open both together`);
  return covered(blockedCells(await pictureOf(picture), said.how), said.place);
}

/** The request of JSON that is, or has, a message nav_msgs/OccupancyGrid; the JSON itself where it is none. */
export function withoutMessage(name, given) {
  if (isMessage(given)) return { names: OBJECTIVES, ...covered(blockedOf(name, given), placeOf(given)) };
  if (!isMessage(given?.occupancy_grid)) return given;
  const { occupancy_grid: message, obstacle_from: from, unknown, ...others } = given;
  return { ...others, grid: blockedOf(name, message, from, unknown), ...placeOf(message) };
}

/** The request of a grid: to visit places all over it, short against far from walls. */
function covered(grid, place) {
  const longest = Math.max(grid.length, grid[0].length);
  const spacing = Math.ceil((place.cell_size * longest * 100) / PLACES_ACROSS) / 100;
  return { grid, cost_layer: nearness(grid), ...place, robot_radius: 0, spacing };
}
