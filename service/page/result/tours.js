/** Find the tour of a front that is nearest to a balance or to a place on the chart. */

/** The index of the tour nearest to a balance: 0 at the least first length, 1 at the least second. */
export function nearest(front, balance) {
  let best = 0;
  for (let index = 1; index < front.length; index++) {
    if (Math.abs(front[index].balance - balance) < Math.abs(front[best].balance - balance)) best = index;
  }
  return best;
}

/** The index of the tour that is drawn nearest to a place on the chart. */
export function drawnNearest(front, place, position) {
  const distance = (item) => {
    const [x, y] = position(item.lengths);
    return Math.hypot(x - place[0], y - place[1]);
  };
  let best = 0;
  front.forEach((item, index) => {
    if (distance(item) < distance(front[best])) best = index;
  });
  return best;
}
