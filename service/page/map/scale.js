/** The bar that says how long a kilometre is on a map of the earth. */

import { made } from "../common/elements.js";

const AROUND = 40075016.686; // metres along the equator
const WORLD = 256; // pixels of the whole world at zoom 0
const LONGEST = 110; // pixels

/** The metres of a pixel in the middle of a map. */
export const metresPerPixel = (latitude, zoom) => (AROUND * Math.cos((latitude * Math.PI) / 180)) / (WORLD * 2 ** zoom);

/** The longest round length that fits, in words, and its pixels. */
export function barOf(metres) {
  const most = metres * LONGEST;
  const power = 10 ** Math.floor(Math.log10(most));
  const length = power * [5, 2, 1].find((times) => times * power <= most);
  const said = length < 1 ? `${Math.round(length * 100)} cm` : length < 1000 ? `${length} m` : `${(length / 1000).toLocaleString("en")} km`;
  return { said, pixels: Math.round(length / metres) };
}

export class ScaleBar {
  #map;
  #bar = made("div", { className: "scale", hidden: true });
  #placeAt = null; // longitude and latitude of a position on the map

  constructor(map) {
    this.#map = map;
    map.getContainer().append(this.#bar);
    map.on("move zoom viewreset resize", () => this.#draw());
  }

  /** Shows the bar on a map of the earth; `placeAt` gives longitude and latitude of a position, null hides it. */
  show(placeAt) {
    this.#placeAt = placeAt;
    this.#bar.hidden = !placeAt;
    this.#draw();
  }

  #draw() {
    if (!this.#placeAt) return;
    const [, latitude] = this.#placeAt(this.#map.getCenter());
    const { said, pixels } = barOf(metresPerPixel(latitude, this.#map.getZoom()));
    this.#bar.textContent = said;
    this.#bar.style.width = `${pixels}px`;
  }
}
