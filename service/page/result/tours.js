/** Find the tour of a front that is nearest to a balance or to a place on the chart. */

/** The index of the tour nearest to a balance: 0 at the least first length, 1 at the least second. */
export const nearest = (front, balance) => least(front, (item) => Math.abs(item.balance - balance));

/** The index of the tour that is drawn nearest to a place on the chart. */
export const drawnNearest = (front, place, position) =>
  least(front, (item) => {
    const [x, y] = position(item.lengths);
    return Math.hypot(x - place[0], y - place[1]);
  });

/** The index of the tour with the least second length. */
export const lastOf = (front) => least(front, ({ lengths }) => lengths[1]);

/** Whether another tour of a front is better under both objectives: a plan that changes little of the one that is driven may be. */
export const isBeaten = (front, { lengths: [first, second] }) =>
  front.some(({ lengths: [other, another] }) => other <= first && another <= second && (other < first || another < second));

/** The index of the first tour that is least far; 0 if there is none. */
function least(front, distance) {
  const far = front.map(distance);
  return far.reduce((best, each, at) => (each < far[best] ? at : best), 0);
}
