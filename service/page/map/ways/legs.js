/** The ways along the streets between the stops of an example, as `/examples` has them. */

export class Legs {
  #data;
  #stops;

  constructor(data) {
    this.#data = data;
    this.#stops = new Map(data.legs.map((_, stop) => [data.nodes[stop].join(), stop]));
  }

  /** Longitude and latitude of the places along a way through stops at these places; null if some way is not known. */
  along(places) {
    const { origin, step, nodes } = this.#data;
    const stops = places.map((place) => this.#stops.get(place.map((at, axis) => Math.round((at - origin[axis]) / step)).join()));
    if (stops.includes(undefined)) return null;
    const visited = stops.slice(1).flatMap((stop, leg) => this.#way(stops[leg], stop));
    return [...stops.slice(0, 1), ...visited].map((node) => nodes[node].map((steps, axis) => origin[axis] + step * steps));
  }

  /** The nodes from one stop to another, without the first. If several nodes follow a node, a digit says which one. */
  #way(from, to) {
    const digits = this.#data.legs[from][to];
    const way = [];
    let taken = 0;
    for (let node = from; node !== to; way.push(node)) {
      const ahead = this.#data.next[node];
      node = ahead.length > 1 ? ahead[digits[taken++]] : ahead[0];
    }
    return way;
  }
}
