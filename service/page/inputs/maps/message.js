/** Read a message nav_msgs/OccupancyGrid of ROS, as rosbridge sends it in JSON. */

const OBSTACLE_FROM = 50; // occupancy, from 0 to 100
const UNKNOWN = -1;

export const isMessage = (given) => Boolean(given?.info?.resolution) && Array.isArray(given.data);

/** Rows of 0 where a cell is free and 1 where it is not, the top one first: in the message the lowest is. */
export function blockedOf(name, { info, data }, from = OBSTACLE_FROM, unknown = "blocked") {
  const { width, height } = info;
  if (!(width > 0 && height > 0) || data.length !== width * height) {
    throw new Error(`data of ${name} must have ${width} x ${height} numbers, got ${data.length}`);
  }
  const blocked = (value) => Number(value === UNKNOWN ? unknown !== "free" : !(value >= 0 && value < from));
  return Array.from({ length: height }, (_, row) => data.slice((height - 1 - row) * width, (height - row) * width).map(blocked));
}

/** `cell_size` and `origin` of the request. */
export function placeOf({ info: { resolution, origin } }) {
  const { x = 0, y = 0 } = origin?.position ?? {};
  const { z = 0, w = 1 } = origin?.orientation ?? {};
  return { cell_size: resolution, origin: [x, y, 2 * Math.atan2(z, w)] };
}
