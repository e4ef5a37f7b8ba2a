/** Replanning: the stops of a way, and what has changed on it as the body of `POST /front/{id}/replan`. */

import { Problem } from "./service.js";
import { timeOfDay } from "../common/durations.js";

/**
 * The stops of a front that can be replanned: all stops so far, also those visited, in the order in which
 * they are drawn. `keys` are their names in the service, and `names` those on the page.
 */
export class Way {
  constructor(instance, ids, cities) {
    this.instance = instance;
    this.added = []; // stops since the tour was planned first
    this.keys = ids ?? Array.from({ length: cities }, (_, city) => city);
    this.names = this.keys.map((key) => (typeof key === "number" ? String(key + 1) : key));
  }

  /** The changes: `at` is the last stop visited on a tour, and `now` the time of day, by default that at which it leaves there. */
  body({ at, now, removed, added, vehicle }, { tour, times }) {
    const visit = (name) => tour.indexOf(this.names.indexOf(name));
    const unknown = [at, ...removed].find((name) => name && visit(name) < 0);
    if (unknown) throw refusal("unknown-stop", unknown === at ? "done" : "remove", `the selected tour has no stop "${unknown}"`);
    const keys = tour.map((city) => this.keys[city]);
    return {
      tour: keys,
      ...(times && { now: now ? timeNamed(now) : this.#leaves(tour, times, at ? visit(at) : 0) }),
      done: at ? keys.slice(0, visit(at) + 1) : [],
      remove: removed.map((name) => keys[visit(name)]),
      add: added.map((stop) => this.#placed(stop)),
      ...(vehicle && { position: this.#placed(vehicle) }),
    };
  }

  /** When a tour leaves its stop at a place. */
  #leaves(tour, times, place) {
    return times[place] + (this.instance.stops[tour[place]].service ?? 0);
  }

  /** The way with the added stops, once it is replanned. */
  with(stops) {
    const { coordinates, stops: before } = this.instance;
    const rows = stops.map(({ row }) => row);
    const instance = coordinates
      ? { coordinates: [...coordinates, ...rows] }
      : before
        ? { ...this.instance, stops: [...before, ...stops.map(({ id, row }) => ({ id, location: row }))] }
        : this.instance;
    const way = new Way(instance, [...this.keys.map(String), ...stops.map(({ id }) => id)]);
    way.replanned = true;
    way.added = [...this.added, ...stops];
    way.names = [...this.names, ...stops.map(({ id }) => id)];
    return way;
  }

  /** What a link says of it beside the request of the whole tour, once it is replanned. */
  linked() {
    return this.replanned && { added: this.added };
  }

  /** The way of a link; null if it says none, as links come from anywhere. */
  static of(instance, ids, { added }) {
    const isPlaced = (each) => typeof each?.id === "string" && Array.isArray(each.row) && each.row.every(Number.isFinite);
    const cities = (instance.coordinates ?? instance.stops ?? instance.matrices?.[0])?.length;
    return Array.isArray(added) && added.every(isPlaced) && cities ? new Way(instance, ids, cities).with(added) : null;
  }

  /** The answer about the rest, with its tours in cities of this way. */
  answer(found) {
    const city = new Map(this.keys.map((key, index) => [String(key), index]));
    return { ...found, front: found.front.map((item) => ({ ...item, tour: item.stops.map((id) => city.get(id)) })) };
  }

  #placed({ id, row }) {
    if (this.instance.coordinates) return { id, coordinates: [row.slice(0, 2), row.slice(2)] };
    return { id, location: row };
  }
}

function timeNamed(text) {
  const time = timeOfDay(text);
  if (time === undefined) throw refusal("invalid-request", "now", `the time now must be as 8:15, got "${text}"`);
  return time;
}

const refusal = (code, member, detail) => new Problem({ code, detail, errors: [{ pointer: `/${member}` }] });
