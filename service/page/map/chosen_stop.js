/** The stop that is chosen on the maps to be moved or deleted, and the help below them. */

const element = (id) => document.getElementById(id);
const HINTS = matchMedia("(pointer: coarse)").matches
  ? ["Tap a stop to choose it.", "Drag it where it belongs, or"]
  : ["Drag a stop to move it. Click one to choose it, or press Enter on a map.", "Drag it, or move it by arrow keys; the key Delete takes it away."];

export class ChosenStop {
  #city = null;
  #editable = false;
  #choosable = false;
  #count = 0;
  #nameOf = String;
  #onChosen;
  #onDelete;

  /**
   * @param {(city: number | null) => void} onChosen called with the stop that is chosen
   * @param {(city: number) => void} onDelete called with the stop to delete
   */
  constructor(onChosen, onDelete) {
    this.#onChosen = onChosen;
    this.#onDelete = onDelete;
    element("delete-stop").addEventListener("click", () => this.remove());
  }

  get city() {
    return this.#city;
  }

  /** Whether stops can be moved and deleted. */
  get editable() {
    return this.#editable;
  }

  /** Whether stops can be chosen: those that can be moved, and those of a fleet. */
  get choosable() {
    return this.#choosable;
  }

  /** Sets the names of the stops. */
  name(nameOf) {
    this.#nameOf = nameOf;
  }

  /**
   * Takes the number of stops, and whether they can be moved, or only chosen. The choice stays if the
   * stops are `kept` and none was added or deleted.
   */
  show(count, editable, kept, choosable = editable) {
    const chosen = editable && kept && count === this.#count ? this.#city : null;
    this.#count = count;
    this.#editable = editable && count > 0;
    this.#choosable = choosable && count > 0;
    this.choose(chosen);
  }

  choose(city) {
    this.#city = city;
    this.#onChosen(city);
    this.#say();
  }

  /** Chooses the next stop, or the one before; if none is chosen, the first or the last. */
  turn(by) {
    if (!this.#choosable) return;
    const from = this.#city ?? (by > 0 ? -1 : this.#count);
    this.choose((from + by + this.#count) % this.#count);
  }

  remove() {
    const city = this.#city;
    this.choose(null);
    this.#onDelete(city);
  }

  #say() {
    const [all, one] = HINTS;
    const said = this.#city === null ? all : `${this.#nameOf(this.#city)} is chosen. ${one}`;
    element("stop-help").textContent = this.#editable ? said : "";
    element("delete-stop").hidden = this.#city === null || !this.#editable;
  }
}
