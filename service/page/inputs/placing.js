/** Place cities by clicks: with two planes, first in one, then in the other. */

import { rounded } from "./places.js";
import { narrow } from "../result/arrangement.js";

export class Placing {
  #button;
  #help;
  #onCity;
  #onWaiting;
  #once;
  #waiting = null; // { plane, place } of a city that has no second place yet

  /**
   * @param {(row: number[]) => void} onCity called with each city that has all its places
   * @param {(plane: number, place: number[] | null) => void} onWaiting called with the place of a city
   *   that has one of two places, and with null once no city waits
   * @param {{ once?: boolean }} options whether only one city is placed
   */
  constructor(button, help, onCity, onWaiting, { once = false } = {}) {
    this.#button = button;
    this.#onWaiting = onWaiting;
    this.#once = once;
    this.#help = help;
    this.#onCity = onCity;
    button.addEventListener("click", () => {
      this.#turn(!this.#on);
      // A phone shows either the button or the map.
      if (narrow.matches && this.#on) help.scrollIntoView({ block: "end" });
    });
  }

  /** Takes a click into a plane, or into the only one. */
  clicked(plane, place, only = false) {
    if (!this.#on) return;
    if (only) return this.#done(place);
    if (this.#waiting && this.#waiting.plane !== plane) {
      const first = this.#waiting.place;
      this.#done(plane === 1 ? [...first, ...place] : [...place, ...first]);
    } else {
      this.#wait({ plane, place });
    }
  }

  /** Ends placing by clicks. */
  stop() {
    if (this.#on) this.#turn(false);
  }

  #done(row) {
    this.#turn(!this.#once && !narrow.matches);
    this.#onCity(row.map(rounded));
    if (narrow.matches) this.#button.scrollIntoView({ block: "center" });
  }

  get #on() {
    return this.#button.getAttribute("aria-pressed") === "true";
  }

  #turn(on) {
    this.#button.setAttribute("aria-pressed", String(on));
    this.#wait(null);
  }

  #wait(waiting) {
    this.#waiting = waiting;
    this.#onWaiting(waiting?.plane, waiting?.place ?? null);
    this.#say();
  }

  #say() {
    const next = this.#waiting ? `Now click where that is on the other map.` : "Click a place on a map.";
    this.#help.textContent = this.#on ? next : "";
  }
}
