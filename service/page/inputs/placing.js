/** Cities clicked into place: first in one plane, then the same city in the other. */

export class Placing {
  #button;
  #help;
  #onCity;
  #waiting = null; // { plane, place } of a city that has no second place yet

  /** @param {(row: number[]) => void} onCity told of each city that has both its places */
  constructor(button, help, onCity) {
    this.#button = button;
    this.#help = help;
    this.#onCity = onCity;
    button.addEventListener("click", () => this.#turn(!this.#on));
  }

  clicked(plane, place) {
    if (!this.#on) return;
    if (this.#waiting && this.#waiting.plane !== plane) {
      const first = this.#waiting.place;
      this.#onCity((plane === 1 ? [...first, ...place] : [...place, ...first]).map(rounded));
      this.#waiting = null;
    } else {
      this.#waiting = { plane, place };
    }
    this.#say();
  }

  get #on() {
    return this.#button.getAttribute("aria-pressed") === "true";
  }

  #turn(on) {
    this.#button.setAttribute("aria-pressed", String(on));
    this.#waiting = null;
    this.#say();
  }

  #say() {
    const next = this.#waiting ? `Now click where that city lies in plane ${2 - this.#waiting.plane}.` : "Click a place on either map.";
    this.#help.textContent = this.#on ? next : "";
  }
}

const rounded = (value) => Number(value.toPrecision(5));
