/** Ask the service for the ways of a tour, or of a plan's routes, along the streets, as its routing engine knows them. */

const REST = 250; // milliseconds for which a tour is selected before its way is requested

export class RoutedWay {
  #service;
  #ways;
  #onFound;
  #timer = 0;
  #wanted = null; // the ways that are being requested

  /**
   * @param {Service} service a service with a routing engine
   * @param {Ways} ways stores the ways
   * @param {() => void} onFound called when new ways are known
   */
  constructor(service, ways, onFound) {
    this.#service = service;
    this.#ways = ways;
    this.#onFound = onFound;
  }

  /** Asks at a path for ways through these stops, a list of cities each, unless others are wanted soon. */
  want(path, wanted) {
    clearTimeout(this.#timer);
    this.#wanted = wanted;
    if (wanted.every((cities) => this.#ways.along(cities))) return;
    this.#timer = setTimeout(() => this.#ask(path, wanted), REST);
  }

  /** Drops the request for ways. */
  forget() {
    clearTimeout(this.#timer);
    this.#wanted = null;
  }

  /** The map is good without; why the engine has no way is said where costs are asked for. */
  async #ask(path, wanted) {
    const headers = { Accept: "application/geo+json" };
    const answer = await this.#service.ask(path, { headers }).then((response) => response.json(), () => null);
    if (this.#wanted !== wanted || !answer) return;
    // Lines come before the stops, in the order of the routes.
    wanted.forEach((cities, at) => this.#ways.keep(cities, placesOf(answer.features[at].geometry)));
    this.#onFound();
  }
}

/** The path at which the service tells the way of a tour of a front of a kind, or those of a plan's routes. */
export function pathOfWays(front, { movers }, { lengths }, index) {
  const geometry = "roads";
  if (movers) return `front/${front}?${new URLSearchParams({ plan: index, geometry })}`;
  return `tour?${new URLSearchParams({ front, first_at_most: lengths[0], geometry })}`;
}

/** The places of a line, which is cut where it crosses longitude 180. */
const placesOf = ({ type, coordinates }) => (type === "LineString" ? coordinates : coordinates.flat());
