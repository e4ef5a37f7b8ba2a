/** The bar that says how long a metre or a kilometre is on a map. */

import { made } from "../common/elements.js";

const AROUND = 40075016.686; // metres along the equator
const WORLD = 256; // pixels of the whole world at zoom 0
const METRES = { cm: 0.01, m: 1, km: 1000 };
const LONGEST = 110; // pixels

/** The metres of a pixel of a map of the earth at zoom 0. */
export const metresAt = (latitude) => (AROUND * Math.cos((latitude * Math.PI) / 180)) / WORLD;

/** The metres of one in the plane of an objective; undefined if its unit is not a length. */
export const metresOf = (objective) => METRES[objective?.unit];

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
  #metres = null; // of a pixel at zoom 0, given a position on the map

  constructor(map) {
    this.#map = map;
    map.getContainer().append(this.#bar);
    map.on("move zoom viewreset resize", () => this.#draw());
  }

  /** Shows the bar; `metres` gives the metres of a pixel at zoom 0 in a position of the map, null hides the bar. */
  show(metres) {
    this.#metres = metres;
    this.#bar.hidden = !metres;
    this.#draw();
  }

  #draw() {
    if (!this.#metres) return;
    const { said, pixels } = barOf(this.#metres(this.#map.getCenter()) / 2 ** this.#map.getZoom());
    this.#bar.textContent = said;
    this.#bar.style.width = `${pixels}px`;
  }
}
