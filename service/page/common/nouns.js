/** Call what a front holds by its noun: tours, or the plans of a fleet or of robots. */

const TOURS = { one: "tour", many: "tours" };
const PLANS = { one: "plan", many: "plans" };

export const isPlan = (item) => Boolean(item?.routes);

/** Whether a request is of a fleet or of several robots, so that plans are its answer. */
export const asksForPlans = ({ vehicles, robots }) => Array.isArray(vehicles) || Array.isArray(robots);

/** The noun of a front's items, in the singular and in the plural. */
export const nounOf = (front) => (isPlan(front[0]) ? PLANS : TOURS);
