/** Say where tours start and end on a robot's map: as a cell, as a place or a pose of the request, and in words. */

const NO_FRAME = [0, 0, 0]; // the origin of a map that came without one: its lower left corner
const DIGITS = 3; // of a pose, after the first one of a cell's side

/**
 * The ends of a request on a map, each `{ role, robot, name, cell }`: the role is start or end, the robot an index or
 * null where there is one alone. The cell is null where the request leaves it open.
 */
export function endsOf(request) {
  const { robots, closed } = request;
  if (!Array.isArray(robots)) return ["start", "end"].map((role) => endOf(request, request, role, null, title(role)));
  const roles = closed === false ? ["start", "end"] : ["start"];
  return robots.flatMap((robot, at) => roles.map((role) => endOf(request, robot, role, at, `${title(role)} of ${robot.id}`)));
}

function endOf(request, item, role, robot, name) {
  const pose = item[`${role}_pose`];
  const place = role === "start" && item.start === undefined ? 0 : item[role];
  return { role, robot, name, cell: (pose ? cellOf(request, pose) : request.places?.[place]) ?? null };
}

const title = (role) => (role === "start" ? "Start" : "End");

/** The place of a cell, by its index, or the pose of its middle. */
export function placedAt(request, cell) {
  const place = placeAt(request, cell);
  return place < 0 ? { pose: poseOf(request, cell) } : { place };
}

const placeAt = ({ places = [] }, [row, column]) => places.findIndex((place) => place[0] === row && place[1] === column);

/** The robots of a request, one of them with an end in this cell, or without it. */
export function withRobotEnd(request, { robot, role }, cell) {
  const { [role]: _, [`${role}_pose`]: __, ...rest } = request.robots[robot];
  const { place, pose } = cell ? placedAt(request, cell) : {};
  const put = pose ? { [`${role}_pose`]: pose } : place === undefined ? {} : { [role]: place };
  return request.robots.with(robot, { ...rest, ...put });
}

/** The request with the origin that its poses need. */
export function framed(request) {
  const posed = [request, ...(Array.isArray(request.robots) ? request.robots : [])].some((item) => item?.start_pose || item?.end_pose);
  return request.grid && posed && !request.origin ? { ...request, origin: NO_FRAME } : request;
}

/** Why an end cannot be in a cell, as the rest of a sentence about the cell; null if it can. */
export function faultOf(request, end, [row, column]) {
  const { grid, unknownCells, robot_radius: radius = 0, cell_size: side } = request;
  if (grid[row]?.[column] === undefined) return "is not on the map";
  if (unknownCells?.[row][column] && grid[row][column]) return "is unknown";
  if (grid[row][column]) return "is an obstacle";
  if (isNear(grid, [row, column], radius / side)) return `is within ${radius} m of an obstacle`;
  if ((request.second_matrix || request.second_coordinates) && placeAt(request, [row, column]) < 0) return "is not a place, and costs are known between places alone";
  const other = end.robot === null && endsOf(request).find(({ role }) => role !== end.role)?.cell;
  if (other && other[0] === row && other[1] === column) return `is where the tour ${end.role === "start" ? "ends" : "starts"}`;
  return null;
}

/** Whether an obstacle is within some cells of a cell. */
function isNear(grid, [row, column], radius) {
  const reach = Math.floor(radius * (1 + 1e-9));
  for (let down = -reach; down <= reach; down += 1) {
    for (let right = -reach; right <= reach; right += 1) {
      if (grid[row + down]?.[column + right] && Math.hypot(down, right) <= radius * (1 + 1e-9)) return true;
    }
  }
  return false;
}

/** A cell in words, counted from 1. */
export const cellNamed = ([row, column]) => `row ${row + 1}, column ${column + 1}`;

/** x and y in metres of the middle of a cell, in the frame of the map. */
function poseOf({ grid, cell_size: side, origin }, [row, column]) {
  const [x, y, yaw] = origin ?? NO_FRAME;
  const [right, up] = [(column + 0.5) * side, (grid.length - row - 0.5) * side];
  const [cosine, sine] = [Math.cos(yaw), Math.sin(yaw)];
  const digits = Math.max(0, DIGITS - Math.floor(Math.log10(side)));
  return [x + cosine * right - sine * up, y + sine * right + cosine * up].map((value) => Number(value.toFixed(digits)));
}

/** The row and column of the cell at a pose; null if it is not two numbers. It may lie outside the map. */
function cellOf({ grid, cell_size: side, origin }, [x, y]) {
  const [left, bottom, yaw] = origin ?? NO_FRAME;
  const [cosine, sine] = [Math.cos(yaw), Math.sin(yaw)];
  const column = Math.floor((cosine * (x - left) + sine * (y - bottom)) / side);
  const row = grid.length - 1 - Math.floor((cosine * (y - bottom) - sine * (x - left)) / side);
  return Number.isFinite(row) && Number.isFinite(column) ? [row, column] : null;
}

/** The cell in a text, as x and y in metres, or as "row 3, column 5", counted from 1; null if it is something else. */
export function cellIn(request, text) {
  const [, row, column] = /^\s*row\s*(\d+)[\s,;]*col(?:umn)?\s*(\d+)\s*$/i.exec(text) ?? [];
  if (row) return [row - 1, column - 1];
  const pose = poseIn(text);
  return pose && cellOf(request, pose);
}

/** The pose in a text, as "1.5, -0.2"; null if it is something else. */
export function poseIn(text) {
  const numbers = text.split(/[\s,;]+/).map(Number);
  return [2, 3].includes(numbers.length) && numbers.every(Number.isFinite) ? numbers : null;
}
