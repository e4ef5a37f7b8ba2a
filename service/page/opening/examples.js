/** The examples that can be chosen, and the one that is. */

export class Examples {
  #choice;
  #about;
  #all = [];
  #asked = null; // for by the chosen one, as JSON

  /** @param {HTMLSelectElement} choice @param {HTMLElement} about where the story of an example stands */
  constructor(choice, about) {
    this.#choice = choice;
    this.#about = about;
  }

  /** Takes the list of examples, of which the first can be chosen by itself. */
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

  /** Chooses an example by its file, and tells its story; false where there is no such file. */
  choose(file) {
    this.#choice.value = this.#all.some((example) => example.file === file) ? file : "";
    this.#about.textContent = this.chosen?.about ?? "";
    return Boolean(this.chosen);
  }

  forget() {
    this.choose("");
  }

  /** Says what the chosen example asks for, before anything is changed. */
  opened(asked) {
    this.#asked = JSON.stringify(asked);
  }

  /** The file of the chosen example, if this is still what it asks for; null otherwise. */
  unchanged(asked) {
    return asked && this.chosen && JSON.stringify(asked) === this.#asked ? this.chosen.file : null;
  }
}
