/** Rename, add and delete stops and vehicles of a fleet, with all that refers to them. */

/** A request whose vehicles name stops by id where they named them by index, so that stops can be deleted. */
export function byIds(asked) {
  const idOf = (stop) => (typeof stop === "number" ? (asked.stops?.[stop]?.id ?? stop) : stop);
  return withReferences(asked, idOf);
}

/** The request of a fleet with another id for a stop. */
export function stopRenamed(asked, row, id) {
  const named = byIds(asked);
  const before = named.stops[row].id;
  const renamed = withReferences(named, (stop) => (stop === before ? id : stop));
  return { ...renamed, stops: named.stops.with(row, { ...named.stops[row], id }) };
}

function withReferences(asked, change) {
  const changed = (item, members) =>
    Object.fromEntries(members.filter((each) => item?.[each] != null).map((each) => [each, Array.isArray(item[each]) ? item[each].map(change) : change(item[each])]));
  const vehicles = asked.vehicles.map((each) => ({ ...each, ...changed(each, ["start", "end", "reload"]) }));
  if (!Array.isArray(asked.shipments)) return { ...asked, vehicles };
  const shipments = asked.shipments.map((each) => ({ ...each, ...changed(each, ["pickup", "delivery"]) }));
  return { ...asked, vehicles, shipments };
}

export function vehicleRenamed(asked, row, id) {
  const before = asked.vehicles[row].id;
  const stops = asked.stops.map((stop) => (stop.vehicle === before ? { ...stop, vehicle: id } : stop));
  return { ...asked, stops, vehicles: asked.vehicles.with(row, { ...asked.vehicles[row], id }) };
}

/** The request with one more type of vehicles, like the last one. */
export function withVehicle(asked) {
  const { vehicles } = asked;
  const taken = new Set(vehicles.map((each) => each?.id));
  let number = vehicles.length + 1;
  while (taken.has(`vehicle ${number}`)) number += 1;
  return { ...asked, vehicles: [...vehicles, { ...vehicles.at(-1), id: `vehicle ${number}` }] };
}

/** The request in which a stop is served by a type of vehicles; by any without its id. */
export function servedBy(asked, stop, vehicle) {
  const { vehicle: _, ...others } = asked.stops[stop];
  return { ...asked, stops: asked.stops.with(stop, vehicle ? { ...others, vehicle } : others) };
}
