/** Keep a user's vehicles when a file is opened, or read again. */

const INVENTED = "vehicle"; // the id of the vehicle that is added for a file without vehicles, and the code of the note on it

/** What was read anew for other columns, with the vehicles before if they were edited since they were `read`, which is JSON. */
export function withEdited(brought, before, read) {
  const { vehicles } = brought.members;
  if (!vehicles || !before || JSON.stringify(before) === read) return brought;
  return { ...brought, vehicles: before.map((each, at) => ({ ...vehicles[at], ...each })) };
}

/** What was read from a file of stops without vehicles, with the vehicles before if they are not such an invented one, and fit. */
export function withFleet(brought, before, read) {
  const { members, notes } = brought;
  const isOwn = before && (before.some(({ id }) => id !== INVENTED) || JSON.stringify(before) !== read);
  const isInvented = members.vehicles?.length === 1 && members.vehicles[0].id === INVENTED && notes.some(({ code }) => code === INVENTED);
  if (!isOwn || !isInvented || !canServe(before, members)) return brought;
  const others = notes.filter(({ code }) => code !== INVENTED);
  return { ...brought, vehicles: before, notes: [...others, { code: INVENTED, text: "The file names no vehicles: they are those from before." }] };
}

/**
 * What was read from files of stops and a table of vehicles that joined them, with the stops that are shown if they were edited since they were
 * `read`, which is JSON, and these vehicles serve them. `asked` is the request that is shown, false if no vehicles joined.
 */
export function withTyped(brought, asked, read) {
  const { vehicles } = brought.members;
  if (!asked || JSON.stringify(asked.stops) === read || !asked.stops || !vehicles || !canServe(vehicles, asked)) return brought;
  const { members, ...others } = brought;
  return { ...others, members: { ...asked, vehicles } };
}

/** Whether vehicles start and end at stops of a request, carry what it demands, and have shifts only where it has times. */
function canServe(vehicles, { stops, clock }) {
  const ids = stops.map(({ id }) => id);
  const kinds = stops.find(({ demand }) => demand)?.demand.length;
  return vehicles.every(({ start, end, reload = [], capacity, shift, shifts, breaks }) => {
    const places = [start, end, ...reload].filter((each) => each !== undefined && each !== null);
    return places.every((each) => ids.includes(each)) && capacity?.length === kinds && Boolean(clock || !(shift ?? shifts ?? breaks));
  });
}
