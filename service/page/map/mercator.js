/** Longitude and latitude on a map whose pixels are those of map tiles (Web Mercator, EPSG:3857). */

const WORLD = 256; // pixels of the whole world at zoom 0
const MARGIN = 0.0003; // degrees around the places, so that a single one has room

export class Mercator {
  #bounds;

  constructor(bounds) {
    this.#bounds = bounds;
  }

  /** The frame that holds these places, pairs of longitude and latitude. */
  static around(places) {
    const frame = new Mercator(null);
    const [east, north] = [0, 1].map((axis) => places.map((place) => place[axis]));
    const corner = (pick, by) => frame.latlng([pick(...east) + by, pick(...north) + by]);
    frame.#bounds = places.length ? [corner(Math.min, -MARGIN), corner(Math.max, MARGIN)] : [[-WORLD, 0], [0, WORLD]];
    return frame;
  }

  get bounds() {
    return this.#bounds;
  }

  latlng([longitude, latitude]) {
    const sine = Math.sin((Math.max(-85, Math.min(85, latitude)) * Math.PI) / 180);
    return [WORLD * (Math.atanh(sine) / (2 * Math.PI) - 0.5), WORLD * (longitude / 360 + 0.5)];
  }

  place({ lat, lng }) {
    const sine = Math.tanh((lat / WORLD + 0.5) * 2 * Math.PI);
    return [360 * (lng / WORLD - 0.5), (Math.asin(sine) * 180) / Math.PI];
  }
}
