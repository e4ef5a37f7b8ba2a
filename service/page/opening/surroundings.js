/** The surroundings of an example's stops: streets, places by name, and the streets of its tours. */

export class Surroundings {
  #service;
  #result;
  #example = null; // the example whose surroundings are drawn

  constructor(service, result) {
    this.#service = service;
    this.#result = result;
  }

  /** Draws the surroundings that come before the stops. */
  begin(example) {
    this.#example = example;
    this.#result.surround({ ...drawn(example), awaited: Boolean(example.streets) });
  }

  /** Draws the surroundings that come after the stops. The maps work without them. */
  async fetch() {
    const example = this.#example;
    const [streets, legs] = await Promise.all([example.streets, example.legs].map((file) => this.#get(file)));
    if (this.#example === example) this.#result.surround({ ...drawn(example), streets, legs });
  }

  forget() {
    this.#example = null;
    this.#result.surround({});
  }

  async #get(file) {
    return file ? this.#service.get(`examples/${file}`).catch(() => null) : null;
  }
}

/** Places by name, and the corners of a box that holds the streets of all tours. */
const drawn = ({ places, extent }) => ({ places, extent });
