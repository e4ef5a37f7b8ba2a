/** The list of examples, and the chosen one. */

import { keyOf } from "../inputs/instance.js";

export class Examples {
  #choice;
  #about;
  #all = [];
  #asked = null; // the request of the chosen example, as of keyOf

  /** @param {HTMLSelectElement} choice @param {HTMLElement} about where the story of an example stands */
  constructor(choice, about) {
    this.#choice = choice;
    this.#about = about;
  }

  /** Takes the list of examples; the first may be chosen by the page itself. */
  offer(all) {
    this.#all = all;
    this.#choice.append(...all.map(({ file, title }) => new Option(title, file)));
  }

  get first() {
    return this.#all[0].file;
  }

  get chosen() {
    return this.#all.find(({ file }) => file === this.#choice.value);
  }

  /** Chooses an example by its file, and shows its story. Returns false for a file that is not listed. */
  choose(file) {
    this.#choice.value = this.#all.some((example) => example.file === file) ? file : "";
    this.#about.textContent = this.chosen?.about ?? "";
    return Boolean(this.chosen);
  }

  forget() {
    this.choose("");
  }

  /** Stores the request of the chosen example, before anything is changed. */
  opened(asked) {
    this.#asked = keyOf(asked);
  }

  /** The file of the chosen example, if this is still its request; null otherwise. */
  unchanged(asked) {
    return asked && this.chosen && keyOf(asked) === this.#asked ? this.chosen.file : null;
  }
}
