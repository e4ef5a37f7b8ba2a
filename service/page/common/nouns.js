/** Call what a front holds by its noun: tours, or the plans of a fleet. */

const TOURS = { one: "tour", many: "tours" };
const PLANS = { one: "plan", many: "plans" };

export const isPlan = (item) => Boolean(item?.routes);

/** The noun of a front's items, in the singular and in the plural. */
export const nounOf = (front) => (isPlan(front[0]) ? PLANS : TOURS);
