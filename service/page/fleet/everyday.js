/** Read and write a depot, minutes at the stops, shifts, time to spare and a speed as members of a request: what every dispatcher has. */

import { duration, timeText } from "../common/durations.js";
import { isMeasured, withAnother, without } from "../inputs/stops.js";
import { secondsIn } from "./cells.js";
import { byIds } from "./references.js";
import { withClock } from "./trade.js";

const [DAY, NEAR] = [86400, 100]; // seconds; kilometres from a depot that is remembered to a stop, at most
const DEGREE = 111; // kilometres
const ADDED = /^depot( \d+)?$| \(depot\)$/; // names of depots that are no rows of a file, also as they were called before

/** Whether all of it can be said of a request: its stops lie on the earth, and its times are in a known unit. */
export const isAskable = (asked) => isMeasured(asked) && asked.stops?.length > 0 && asked.stops.every(({ location }) => location) && asked.vehicles.length > 0 && Boolean(secondsIn(asked));

/**
 * What is given: `depot` is a name, `service`, `shift` and `slack`, the time to spare before windows close, are in seconds, `speed` is in km/h, `leave` is early or
 * late, and `reload` says whether vehicles load again at the depot. Each is null if nothing is given,
 * and undefined if it differs from row to row. `missing` counts the rows without.
 */
export function everydayIn(asked) {
  const { stops, vehicles } = byIds(asked);
  const second = secondsIn(asked);
  const visited = visitedIn(asked);
  const depot = common(vehicles.map(({ start, end }) => start ?? end ?? undefined));
  const services = visited.map(({ service }) => service);
  const shifts = vehicles.map(({ shift, shifts }) => (shifts ? shifts.flat() : shift));
  const lacking = (values) => values.filter((value) => value === undefined).length;
  const shift = common(shifts);
  const service = common(services);
  return {
    depot: depot === null || stops.some(({ id }) => id === depot) ? depot : undefined,
    service: service && service * second,
    shift: shift?.length > 2 ? undefined : (shift?.map((time) => time * second) ?? shift),
    speed: speedIn(asked),
    leave: asked.leave ?? "late",
    slack: asked.slack ? asked.slack * second : null,
    reload: common(vehicles.map(({ start, reload = [] }) => Boolean(start) && reload.includes(start))),
    missing: { depot: vehicles.filter(isFree).length, service: lacking(services), shift: lacking(shifts) },
  };
}

/** The value that all have that have one; null if none has, undefined if they differ. */
function common(values) {
  const given = values.filter((value) => value !== undefined);
  if (!given.length) return null;
  return given.every((value) => String(value) === String(given[0])) ? given[0] : undefined;
}

const isFree = (vehicle) => vehicle.start === undefined && vehicle.end === undefined;

/** Says what is missing, in one line; "" if nothing is. */
export function missingSaid({ depot, service, shift, leave, missing }) {
  const said = [
    [depot, missing.depot, "No depot is given: vehicles", "start and end at any stop."],
    [service, missing.service, "No time at the stops is given:", "0 min.", "stops"],
    [shift, missing.shift, "No shifts are given: vehicles", leave === "early" ? "set off at midnight." : "set off at any time of the day."],
  ];
  return said.flatMap(([value, count, none, what, rows = "vehicles"]) => (count ? [`${value === null ? none : `${count} of the ${rows}:`} ${what}`] : [])).join(" ");
}

/** How long most stops take that say so, in the unit of the request; undefined if none does. */
export function usualService(asked) {
  const given = visitedIn(asked).flatMap(({ service }) => service ?? []);
  const count = (value) => given.filter((each) => each === value).length;
  return given.reduce((usual, value) => (count(value) > count(usual) ? value : usual), given[0]);
}

/** How many of the stops are depots, which are not visited, in words; "" if none is. */
export function depotsSaid(asked) {
  const ends = depotsIn(asked);
  const depots = (asked.stops ?? []).filter((stop) => ends.has(stop.id) && !isOrder(stop, asked)).length;
  return depots > 1 ? `with ${depots} depots` : depots ? "with depot" : "";
}

/** The stops at which no vehicle starts, ends or loads again. */
function visitedIn(asked) {
  const depots = depotsIn(asked);
  return asked.stops.filter(({ id }) => !depots.has(id));
}

const depotsIn = (asked) => new Set(byIds(asked).vehicles.flatMap(({ start, end, reload = [] }) => [start, end, ...reload]));

/** Whether a value is only for the rows without one: others have different ones, or the file gives them. */
const isForRest = (value, count) => value === undefined || (value !== null && count > 0);

/** The request with a time at the stops in seconds: at those without one, or at all if they have the same; null takes it away. */
export function withService(asked, seconds) {
  const timed = withClock(asked);
  const { service: before, missing } = everydayIn(timed);
  const depots = depotsIn(timed);
  const isKept = (stop) => depots.has(stop.id) || (isForRest(before, missing.service) && stop.service !== undefined);
  const value = seconds === null ? null : seconds / secondsIn(timed);
  return { ...timed, stops: timed.stops.map((stop) => (isKept(stop) ? stop : withMember(stop, "service", value))) };
}

/** The request with a shift in seconds of the day, in the same way. */
export function withShift(asked, shift) {
  const timed = withClock(asked);
  const { shift: before, missing } = everydayIn(timed);
  const isKept = (vehicle) => isForRest(before, missing.shift) && (vehicle.shift ?? vehicle.shifts);
  const value = shift?.map((time) => time / secondsIn(timed));
  const shifted = ({ shifts: _, ...vehicle }) => withMember(vehicle, "shift", value);
  return { ...timed, vehicles: timed.vehicles.map((vehicle) => (isKept(vehicle) ? vehicle : shifted(vehicle))) };
}

function withMember(item, member, value) {
  const { [member]: _, ...others } = item;
  return value === null || value === undefined ? others : { ...others, [member]: value };
}

/** A shift that ends with the day, if only its begin is given. */
export const wholeShift = (times) => (times.length === 1 ? [times[0], Math.max(DAY, times[0])] : times);

/** The speed of straight lines; null if no time is measured by one, undefined if they differ. */
const speedIn = ({ objectives, clock }) => common([...objectives, typeof clock === "object" ? clock : {}].map(({ speed }) => speed ?? undefined));

export function withSpeed(asked, speed) {
  const faster = (source) => (source?.speed ? { ...source, speed } : source);
  return { ...asked, objectives: asked.objectives.map(faster), ...(asked.clock && { clock: faster(asked.clock) }) };
}

/** The request whose vehicles set off as `early` as they can, or as `late`. */
export const withLeave = (asked, leave) => withMember(leave === "early" ? withClock(asked) : asked, "leave", leave === "early" ? leave : null);

/** The request whose vehicles reach each stop so many seconds before its window closes; null takes that away. */
export function withSlack(asked, seconds) {
  const timed = withClock(asked);
  return withMember(timed, "slack", seconds ? seconds / secondsIn(timed) : null);
}

/** The request whose vehicles load again where they start during the day, or nowhere. */
export function withReload(asked, isMeant) {
  const loading = ({ reload: _, ...vehicle }) => (isMeant && vehicle.start != null ? { ...vehicle, reload: [vehicle.start] } : vehicle);
  return { ...asked, vehicles: asked.vehicles.map(loading) };
}

/** The request whose vehicles start and end at a stop; of an order a depot is added at its place. Undefined without such a stop. */
export function withDepotAt(asked, id) {
  const named = byIds(asked);
  const stop = named.stops.find((each) => each.id === id);
  if (!stop) return undefined;
  if (isOrder(stop, named)) return withDepot(named, { location: stop.location });
  const { service: _, ...bare } = stop;
  return homed({ ...named, stops: named.stops.map((each) => (each === stop ? bare : each)) }, id);
}

/** The request whose vehicles start and end at a place; a depot that they have is moved there, unless it is an order. */
export function withDepot(asked, { id = "depot", location }) {
  const named = byIds(asked);
  const depot = homeOf(named);
  const kept = named.stops.findIndex((stop) => stop.id === depot && !isOrder(stop, named));
  if (kept >= 0) return homed({ ...named, stops: named.stops.with(kept, { ...named.stops[kept], location }) }, depot);
  const name = freeName(named.stops, id);
  return homed(withAnother(named, name, location), name);
}

/** The depot of all vehicles; undefined if some have none, or they differ. */
function homeOf(asked) {
  const { depot, missing } = everydayIn(asked);
  return missing.depot ? undefined : depot;
}

function freeName(stops, id) {
  const taken = new Set(stops.map((stop) => stop.id));
  let [name, number] = [id, 1];
  while (taken.has(name)) name = `${id} ${(number += 1)}`;
  return name;
}

/** Whether something is delivered or done at a stop, so that it stays one to visit. */
function isOrder({ id, demand, pickup, window, windows, due, prize }, { stops, shipments }) {
  const isLoaded = (each) => each?.some((amount) => amount > 0);
  const isTimed = !stops.some((stop) => isLoaded(stop.demand)) && (window ?? windows ?? due ?? prize) !== undefined;
  return isLoaded(demand) || isLoaded(pickup) || isTimed || shipments?.some((each) => [each.pickup, each.delivery].includes(id));
}

/** The request whose vehicles start, end and load where they did not say so, or did so at the depot before. */
function homed(asked, id) {
  const before = homeOf(asked);
  const moved = (stop) => (stop === before ? id : stop);
  const vehicles = asked.vehicles.map((vehicle) => {
    if (isFree(vehicle)) return { ...vehicle, start: id, end: id };
    const ends = Object.fromEntries(["start", "end"].filter((end) => end in vehicle).map((end) => [end, moved(vehicle[end])]));
    return { ...vehicle, ...ends, ...(vehicle.reload && { reload: vehicle.reload.map(moved) }) };
  });
  const row = before === id ? -1 : asked.stops.findIndex((stop) => stop.id === before && ADDED.test(stop.id) && !isOrder(stop, asked));
  const placed = { ...asked, vehicles };
  return row < 0 ? placed : without(placed, row);
}

/** What is given, to be remembered: `depot` is `{ id, location }`. */
export function rememberedOf(asked) {
  const given = everydayIn(asked);
  const place = byIds(asked).stops.find(({ id }) => id === given.depot);
  return { ...given, depot: place && { id: place.id, location: place.location } };
}

/**
 * The request with what is remembered and not given, and what is said of that, in a few words each. A depot that is far from all
 * stops is one of another city.
 */
export function recalled(asked, { depot, service, shift, speed, reload, leave, slack }) {
  if (!isAskable(asked)) return { asked, said: [] };
  const given = everydayIn(asked);
  const isHome = given.depot === null && depot && isNear(asked, depot.location);
  const steps = [
    [isHome, withDepotOf, depot, depot?.id === "depot" ? "the depot" : `depot ${depot?.id}`],
    [isHome && reload, withReload, true, "vehicles load again there"],
    [given.service === null && service > 0, withService, service, `${duration(service)} at each stop`],
    [given.shift === null && shift, withShift, shift, `shifts from ${shift?.map(timeText).join(" to ")}`],
    [given.slack === null && slack > 0, withSlack, slack, `${duration(slack)} to spare before a window closes`],
    [given.leave !== leave && leave === "early", withLeave, leave, "vehicles set off as early as possible"],
    [given.speed && speed > 0 && given.speed !== speed, withSpeed, speed, `${speed} km/h`],
  ].filter(([isMeant]) => isMeant);
  return { asked: steps.reduce((changed, [, change, value]) => change(changed, value), asked), said: steps.map((step) => step.at(-1)) };
}

/** A stop of the name of the depot is it, if it is at its place. */
function withDepotOf(asked, depot) {
  const isThere = asked.stops.some(({ id, location }) => id === depot.id && String(location) === String(depot.location));
  return (isThere && withDepotAt(asked, depot.id)) || withDepot(asked, depot);
}

function isNear({ stops }, [longitude, latitude]) {
  const wide = Math.cos((latitude * Math.PI) / 180);
  return stops.some(({ location: [x, y] }) => DEGREE * Math.hypot((x - longitude) * wide, y - latitude) <= NEAR);
}
