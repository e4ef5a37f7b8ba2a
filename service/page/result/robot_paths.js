/** Write the paths of the selected tour or plan for robots: as messages nav_msgs/Path of ROS 2, and as CSV in metres. */

import { quoted } from "./exports.js";

const FRAME = "map";
const COLUMNS = ["x", "y", "yaw", "place"];

/** The paths of a tour, or of each robot of a plan, each `{ robot, path }`; null if one has no poses: its map has no origin. */
export function drivenPaths({ path, routes }) {
  const paths = routes?.map((route) => ({ robot: route.robot, path: route.path })) ?? [{ robot: null, path }];
  return paths.every((each) => hasPoses(each.path)) ? paths : null;
}

/** The message of a tour, or an object with the message of each robot of a plan. */
export function navPathsOf(paths) {
  const messages = paths.map(({ robot, path }) => [robot, navPathOf(path)]);
  return JSON.stringify(messages[0]?.[0] === null ? messages[0][1] : Object.fromEntries(messages));
}

/** A row for each cell on the way, with its place where it is one; of a plan, with the robot first. */
export function csvOfPaths(paths) {
  const several = paths[0]?.robot !== null;
  const rows = paths.flatMap(({ robot, path }) => {
    const places = new Map(); // by cell
    for (const [cell, place] of path.visits ?? []) places.set(cell, [...(places.get(cell) ?? []), place]);
    const before = several ? [quoted(robot, /[,"\r\n]/)] : [];
    return path.points.map(([x, y], cell) => [...before, x, y, path.yaws[cell], places.get(cell)?.join(" ") ?? ""]);
  });
  return [[...(several ? ["robot"] : []), ...COLUMNS], ...rows].map((row) => `${row.join(",")}\n`).join("");
}

function navPathOf({ points, yaws }) {
  const header = { stamp: { sec: 0, nanosec: 0 }, frame_id: FRAME };
  const poses = points.map(([x, y], cell) => ({
    header,
    pose: { position: { x, y, z: 0 }, orientation: { x: 0, y: 0, z: Math.sin(yaws[cell] / 2), w: Math.cos(yaws[cell] / 2) } },
  }));
  return { header, poses };
}

/** Whether a path has a pose for each cell: links come from anywhere. */
function hasPoses({ cells, points, yaws, visits = [] } = {}) {
  const isRow = (row, length) => Array.isArray(row) && row.length === length && row.every(Number.isFinite);
  const isPairs = (rows) => Array.isArray(rows) && rows.every((row) => isRow(row, 2));
  return isPairs(points) && points.length === cells.length && isRow(yaws, cells.length) && isPairs(visits);
}
