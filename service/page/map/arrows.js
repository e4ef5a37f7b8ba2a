/** Draw arrowheads on the legs of a line, so that its direction is seen. */

const MOST_ARROWS = 60;
const [ARROW, ROOM, APART] = [5, 22, 60]; // pixels: an arrowhead's length, the least of a leg that has one, and from one to the next on streets

/** Fills arrowheads on legs that have room for one, on some of them where they are many; `along` streets as far from each other. */
export function drawArrows(context, places, along = false) {
  if (along) return drawApart(context, places);
  const apart = Math.ceil(places.length / MOST_ARROWS);
  for (let at = apart; at < places.length; at += apart) {
    if (distance(places[at - 1], places[at]) >= ROOM) arrow(context, places[at - 1], places[at]);
  }
}

/** The pieces of a street are short even if its legs are long. */
function drawApart(context, places) {
  let far = 0;
  for (let at = 1; at < places.length; at++) {
    const long = distance(places[at - 1], places[at]);
    far += long;
    if (far < APART || long < ARROW) continue;
    arrow(context, places[at - 1], places[at]);
    far = 0;
  }
}

const distance = (from, to) => Math.hypot(to.x - from.x, to.y - from.y);

/** An arrowhead in the middle of a leg. */
function arrow(context, from, to) {
  const long = distance(from, to);
  const [east, south] = [(ARROW * (to.x - from.x)) / long, (ARROW * (to.y - from.y)) / long];
  const [middleX, middleY] = [(from.x + to.x) / 2, (from.y + to.y) / 2];
  context.beginPath();
  context.moveTo(middleX + east, middleY + south);
  context.lineTo(middleX - east - 0.7 * south, middleY - south + 0.7 * east);
  context.lineTo(middleX - east + 0.7 * south, middleY - south - 0.7 * east);
  context.fill();
}
