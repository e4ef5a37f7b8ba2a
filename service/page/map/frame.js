/** Scale a plane's own units to a map whose longer side is 100. */

const SIDE = 100;

export class Frame {
  #origin;
  #unit;
  #size;

  constructor(origin, unit, size) {
    this.#origin = origin;
    this.#unit = unit;
    this.#size = size;
  }

  /** The frame that holds these places, in any unit; a square for one place or none. */
  static around(places) {
    if (places.length < 2) {
      const [x, y] = places[0] ?? [SIDE / 2, SIDE / 2];
      return new Frame([x - SIDE / 2, y - SIDE / 2], 1, [SIDE, SIDE]);
    }
    const least = [Infinity, Infinity];
    const most = [-Infinity, -Infinity];
    for (const place of places) {
      for (const axis of [0, 1]) {
        least[axis] = Math.min(least[axis], place[axis]);
        most[axis] = Math.max(most[axis], place[axis]);
      }
    }
    const sides = [most[0] - least[0], most[1] - least[1]];
    const unit = Math.max(...sides) / SIDE || 1;
    return new Frame(least, unit, sides.map((side) => side / unit));
  }

  /** How much in the plane is one on the map. */
  get unit() {
    return this.#unit;
  }

  get bounds() {
    return [[0, 0], [this.#size[1], this.#size[0]]];
  }

  latlng([x, y]) {
    return [(y - this.#origin[1]) / this.#unit, (x - this.#origin[0]) / this.#unit];
  }

  place({ lat, lng }) {
    return [this.#origin[0] + lng * this.#unit, this.#origin[1] + lat * this.#unit];
  }
}
