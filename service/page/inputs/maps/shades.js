/** Tell from the shades of a map's picture which cells are blocked, as the service does: see its guide, "Cover a map". */

const WHITE = 255;
const UNKNOWN = 205; // the grey that map_saver of ROS writes for unknown cells, which are blocked
const SCALE = 99; // occupancy in mode scale goes from 0 up to this, between the thresholds
const OBSTACLE_FROM = 49.5; // occupancy, which the service rounds and compares with 50
const LUMA = [19595, 38470, 7471]; // weights of red, green and blue (ITU-R BT.601), of 2 ** 16

/** Of a picture without a map.yaml: dark is blocked. */
export const AS_IT_LOOKS = { mode: "looks", negate: false, occupied: 0.5 };

/** Rows of 0 where a picture is free and 1 where it is blocked, or unknown. */
export function blockedCells({ width, height, pixel }, how) {
  const blocked = BLOCKED[how.mode];
  return Array.from({ length: height }, (_, row) =>
    Array.from({ length: width }, (_, column) => Number(blocked(pixel(row * width + column), how))),
  );
}

/** The modes of map_server, and one of our own. */
const BLOCKED = {
  looks: (pixel, how) => darkness(brightness(pixel), how) > how.occupied || brightness(pixel) === UNKNOWN,
  trinary: (pixel, how) => pixel[3] < WHITE || !(darkness(mean(pixel), how) < how.free) || mean(pixel) === UNKNOWN,
  scale: (pixel, how) => pixel[3] < WHITE || SCALE * between(darkness(mean(pixel), how), how) >= OBSTACLE_FROM,
  raw: (pixel) => mean(pixel) >= OBSTACLE_FROM, // beyond 100 it is unknown
};

const darkness = (shade, { negate }) => (negate ? shade : WHITE - shade) / WHITE;
const mean = ([red, green, blue]) => (red + green + blue) / 3;
const brightness = (pixel) => Math.floor((LUMA.reduce((sum, weight, channel) => sum + weight * pixel[channel], 0) + 2 ** 15) / 2 ** 16);

/** Where a darkness lies between both thresholds, from 0 to 1. */
const between = (dark, { occupied, free }) => (dark > occupied ? 1 : Math.max(0, (dark - free) / (occupied - free)));
