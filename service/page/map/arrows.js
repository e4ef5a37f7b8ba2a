/** Draw arrowheads on the legs of a line, so that its direction is seen. */

const MOST_ARROWS = 60;
const [ARROW, ROOM] = [5, 22]; // pixels: an arrowhead's length, and the least of a leg that has one

/** Fills arrowheads on legs that have room for one, on some of them where they are many. */
export function drawArrows(context, places) {
  const apart = Math.ceil(places.length / MOST_ARROWS);
  for (let at = apart; at < places.length; at += apart) arrow(context, places[at - 1], places[at]);
}

/** An arrowhead in the middle of a leg. */
function arrow(context, from, to) {
  const [x, y] = [to.x - from.x, to.y - from.y];
  const long = Math.hypot(x, y);
  if (long < ROOM) return;
  const [east, south] = [(ARROW * x) / long, (ARROW * y) / long];
  const [middleX, middleY] = [(from.x + to.x) / 2, (from.y + to.y) / 2];
  context.beginPath();
  context.moveTo(middleX + east, middleY + south);
  context.lineTo(middleX - east - 0.7 * south, middleY - south + 0.7 * east);
  context.lineTo(middleX - east + 0.7 * south, middleY - south - 0.7 * east);
  context.fill();
}
