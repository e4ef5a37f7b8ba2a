/** Ask the service for the way of a tour along the streets, as its routing engine knows it. */

const REST = 250; // milliseconds for which a tour is selected before its way is asked for

export class RoutedWay {
  #service;
  #ways;
  #onFound;
  #timer = 0;
  #wanted = null; // the cities of the way that is to come

  /**
   * @param {Service} service which has a routing engine
   * @param {Ways} ways in which ways are kept
   * @param {() => void} onFound told when another one is known
   */
  constructor(service, ways, onFound) {
    this.#service = service;
    this.#ways = ways;
    this.#onFound = onFound;
  }

  /** Asks for the way of a tour of a stored front through these cities, unless another is wanted soon. */
  want(front, { lengths }, cities) {
    clearTimeout(this.#timer);
    this.#wanted = cities;
    if (this.#ways.along(cities)) return;
    this.#timer = setTimeout(() => this.#ask(front, lengths[0], cities), REST);
  }

  /** Wants none any more. */
  forget() {
    clearTimeout(this.#timer);
    this.#wanted = null;
  }

  /** The map is good without; why the engine has no way is said where costs are asked for. */
  async #ask(front, most, cities) {
    const path = `tour?${new URLSearchParams({ front, first_at_most: most, geometry: "roads" })}`;
    const headers = { Accept: "application/geo+json" };
    const answer = await this.#service.ask(path, { headers }).then((response) => response.json(), () => null);
    if (this.#wanted !== cities || !answer) return;
    const { type, coordinates } = answer.features[0].geometry;
    this.#ways.keep(cities, type === "LineString" ? coordinates : coordinates.flat());
    this.#onFound();
  }
}
