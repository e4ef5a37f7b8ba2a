/** The rest of a fleet's day: as the body of `POST /front/{id}/replan`, and as a request whose plans the page can show. */

import { placesOf, rangesOf } from "../fleet/route_styles.js";
import { isMeasured } from "../inputs/stops.js";
import { doneOf, leftOf } from "./progress.js";

/**
 * What is asked of the service.
 *
 * @param {{ at: number, asked: object }} driven the number of the plan in its front, and the request that it is of
 * @param {{ vans: object[], now: number | null, out: Set<string>, removed: Set<string>, added: object[], isHandFree: boolean, changes: object | null }} day how far its
 *   vehicles have come, by `progressOf`, where each of them is in `tip`; the time, and in words; the vehicles that are out of
 *   service, by name; cancelled stops; new ones; whether the time to spare may be used up; and
 *   how stops that change are counted, if they are
 */
export function bodyOf({ at: plan, asked }, { vans, now, nowSaid, out, removed, added, isHandFree, changes }) {
  const { time_limit: seconds, seed } = asked;
  const left = new Set(vans.flatMap(leftOf));
  const under = vans.flatMap((van, route) => (van.isOut || out.has(van.name) ? [{ route, ...wayOf(van, out.has(van.name), asked, nowSaid) }] : []));
  return {
    plan,
    ...(now !== null && { now }),
    ...(isHandFree && { slack: 0 }),
    ...(changes && { changes }),
    routes: under,
    add: added,
    remove: [...removed].filter((stop) => left.has(stop)),
    ...(seed !== undefined && { seed }),
    ...(seconds > 0 && { time_limit: seconds }),
  };
}

/** A vehicle that has left: the service has it go on from the last stop done, unless it is somewhere else. */
function wayOf(van, isBroken, asked, nowSaid) {
  const position = isBroken ? undefined : positionOf(van, asked, nowSaid);
  const leaves = isBroken ? null : van.leaves;
  return { done: doneOf(van), ...(leaves !== null && { leaves }), ...(position !== undefined && { position, ...drivenOf(van, position) }), ...(isBroken && { broken_down: true }) };
}

/** How far a van between two stops has driven; at a stop the service knows it. */
function drivenOf({ distance, driving }, { id }) {
  return id === undefined ? {} : { ...(distance !== undefined && { distance }), ...(driving !== undefined && { driving }) };
}

function positionOf({ name, visits, at, share, tip }, asked, nowSaid) {
  if (share > 0 && tip && isMeasured(asked)) return { id: `${name} at ${nowSaid}`, location: tip };
  return ["loading", "end"].includes(visits[at].kind) ? visits[at].stop : undefined;
}

/** The rest of the day on the page: it stands in for the form, whose request is that of the whole day. */
export class FleetRest {
  replanned = true;
  #under; // the numbers of the routes whose vehicles have left
  #isBroken; // whether one is out of service
  #drivenSaid; // what the plan that is driven is called beside others

  /**
   * @param {{ routes: object[], names: string[], asked: object }} driven the plan that is driven
   * @param {object} body what was asked, by `bodyOf`
   * @param {object} day the day that the body is about
   */
  constructor(driven, { routes, add, slack = driven.asked.slack }, day) {
    Object.assign(this, { driven, day });
    this.#under = new Set(routes.map(({ route }) => route));
    this.#isBroken = routes.some((each) => each.broken_down);
    this.#drivenSaid = add.length ? "the plan before, without new orders" : "the plan before";
    const { asked } = driven;
    const positions = routes.map(({ position }) => position).filter((position) => position?.id);
    const stops = [...asked.stops, ...add, ...positions];
    const details = asked.details?.map(({ column, texts }, at) => ({ column, texts: stops.map(({ id }, row) => texts[row] ?? day?.told?.get(id)?.[at] ?? "") }));
    this.asked = this.instance = { ...asked, stops, details, slack };
    this.names = stops.map(({ id }) => id);
  }

  /** What a link says of it, beside the request of the whole day: stops that are not in that, and the vehicles of the plan that is driven. */
  linked({ stops }) {
    const { routes, names, asked } = this.driven;
    const places = placesOf(routes, asked);
    const vans = routes.map(({ vehicle, shift }, at) => ({ vehicle, shift, place: places[at], name: names[at] }));
    const details = this.asked.details?.map(({ texts }) => texts.slice(stops.length));
    return { stops: this.asked.stops.slice(stops.length), vans, under: [...this.#under], details, slack: this.asked.slack, broken: this.#isBroken };
  }

  /** The rest of a link; null if it says none of this request, as links come from anywhere. */
  static of(request, { stops, vans, under, details, slack, broken }) {
    const isNamed = (each) => typeof each?.name === "string" && typeof each.vehicle === "string" && Number.isInteger(each.place);
    if (!areStops(stops) || !Array.isArray(vans) || !vans.every(isNamed) || !Array.isArray(under) || !under.every((at) => vans[at])) return null;
    const told = (at) => (Array.isArray(details?.[at]) ? details[at].map(String) : []);
    const asked = { ...request, details: request.details?.map(({ column, texts }, at) => ({ column, texts: [...texts, ...told(at)] })) };
    return new FleetRest({ routes: vans, names: vans.map(({ name }) => name), asked }, { routes: under.map((route) => ({ route, broken_down: Boolean(broken) })), add: stops, ...(Number.isFinite(slack) && { slack }) }, null);
  }

  /** The answer of the service, whose vehicles have the names and the colours that they have in the plan that is driven. */
  answer(found) {
    const { driven, ...others } = found; // that of vehicles that go on: not what was planned, if one is out of service
    const beside = driven && !this.#isBroken ? { driven, drivenSaid: this.#drivenSaid } : {};
    return { ...others, ...beside, front: found.front.map((plan) => ({ ...plan, routes: this.#named(plan.routes) })) };
  }

  /** The plan that changes least, of a front that is shown. */
  preferred(front) {
    return front.reduce((best, plan) => (plan.kept > best.kept ? plan : best));
  }

  #named(routes) {
    const { routes: before, names, asked } = this.driven;
    const places = placesOf(before, asked);
    const ranges = rangesOf(asked);
    const waiting = before.map((_, at) => at).filter((at) => !this.#under.has(at));
    const taken = new Set(names);
    return routes.map((route) => {
      const at = route.route ?? this.#take(waiting, route);
      if (at !== undefined) return { ...route, name: names[at], place: places[at] };
      const place = freePlace(places, ranges.get(route.vehicle));
      places.push(place);
      return { ...route, name: freeName(route.vehicle, taken), place };
    });
  }

  /** The number of a route before whose vehicle is of the same kind and has not left. */
  #take(waiting, { vehicle, shift }) {
    const found = waiting.findIndex((at) => this.driven.routes[at].vehicle === vehicle && this.driven.routes[at].shift === shift);
    return found < 0 ? undefined : waiting.splice(found, 1)[0];
  }
}

const areStops = (stops) => Array.isArray(stops) && stops.every((stop) => typeof stop?.id === "string" && Array.isArray(stop.location ?? []));

/** The first place that no vehicle has of those of a type, or else after all. */
function freePlace(taken, [from, to] = [0, 0]) {
  for (let place = from; place < to; place++) if (!taken.includes(place)) return place;
  return Math.max(-1, ...taken) + 1;
}

/** The name of a vehicle that the plan before did without: "van 3" beside "van 1" and "van 2". */
function freeName(vehicle, taken) {
  const isNumbered = [...taken].some((each) => each.startsWith(`${vehicle} `));
  let [name, number] = isNumbered ? [`${vehicle} 1`, 1] : [vehicle, 1];
  while (taken.has(name)) name = `${vehicle} ${(number += 1)}`;
  taken.add(name);
  return name;
}
