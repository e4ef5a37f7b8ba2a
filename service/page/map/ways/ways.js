/** Ways through the stops that are drawn, along the streets as far as these are known. */

import { Legs } from "./legs.js";

export class Ways {
  #places = []; // of the stops, longitude and latitude of each
  #legs = null; // of an example
  #found = new Map(); // by the stops of a way

  /** Knows the legs of an example from now on, or those of none. */
  know(legs) {
    this.#legs = legs && new Legs(legs);
    this.#found.clear();
  }

  /** Leads through stops at these places from now on; none where they are not on the earth. */
  lead(places) {
    this.#places = places;
    this.#found.clear();
  }

  /** Keeps a way that was asked for: the places along it, longitude and latitude of each. */
  keep(cities, places) {
    this.#found.set(cities.join(), places);
  }

  /** The places along a way through stops, null where they are not known. */
  along(cities) {
    if (!cities.length || !this.#places.length || (!this.#legs && !this.#found.size)) return null;
    const key = cities.join();
    if (this.#legs && !this.#found.has(key)) this.#found.set(key, this.#legs.along(cities.map((city) => this.#places[city])));
    return this.#found.get(key) ?? null;
  }
}
