/** Names of stops: their ids, or if they have none, numbers from 1. */

export const nameOf = (ids, city) => ids?.[city] ?? String(city + 1);

/** How a request refers to the stop that is named: by its id or its index; the text itself if it is neither. */
export function stopNamed(ids, name) {
  if (ids?.includes(name)) return name;
  return !ids && /^\d+$/.test(name) && Number(name) > 0 ? Number(name) - 1 : name;
}
