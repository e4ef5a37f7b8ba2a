/** Names of stops: their ids, or where they have none, what people count: 1, 2, 3. */

export const nameOf = (ids, city) => ids?.[city] ?? String(city + 1);

/** What a request calls the stop that is named: its id, its index, or the text where it is neither. */
export function stopNamed(ids, name) {
  if (ids?.includes(name)) return name;
  return !ids && /^\d+$/.test(name) && Number(name) > 0 ? Number(name) - 1 : name;
}
