/** Ways through the stops on the map, along the streets as far as these are known. */

import { Legs } from "./legs.js";

export class Ways {
  #places = []; // longitude and latitude of each stop
  #legs = null; // the legs of an example
  #found = new Map(); // the ways along the streets, by their stops

  /** Takes the legs of an example, or null. */
  know(legs) {
    this.#legs = legs && new Legs(legs);
    this.#found.clear();
  }

  /** Leads through stops at these places from now on; none where they are not on the earth. */
  lead(places) {
    this.#places = places;
    this.#found.clear();
  }

  /** Stores a way that was requested: the longitude and latitude of the places along it. */
  keep(cities, places) {
    this.#found.set(cities.join(), places);
  }

  /** The places along a way through stops, null if they are not known. */
  along(cities) {
    if (!cities.length || !this.#places.length || (!this.#legs && !this.#found.size)) return null;
    const key = cities.join();
    if (this.#legs && !this.#found.has(key)) this.#found.set(key, this.#legs.along(cities.map((city) => this.#places[city])));
    return this.#found.get(key) ?? null;
  }
}
