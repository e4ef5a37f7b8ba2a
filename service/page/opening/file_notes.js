/** The name of the open file, notes on what was assumed when it was read, and what its columns were taken for. */

import { ColumnChoices } from "./column_choices.js";
import { made } from "../common/elements.js";

function noteItem({ code, text }) {
  const item = made("li", {}, text);
  item.dataset.code = code;
  return item;
}

export class FileNotes {
  #status;
  #button;
  #columns;
  #name = ""; // of what was opened last

  /**
   * @param {HTMLElement} status a live region, which is read out when it is filled
   * @param {HTMLButtonElement} button dismisses the notes
   * @param {HTMLDetailsElement} columns as of ColumnChoices
   * @param {{ onDismissed: () => void, onChosen: (files: File[], columns: object[]) => void }} told called once the
   *   button was pressed and is gone, and the focus with it; and with what was chosen for the columns of these files
   */
  constructor(status, button, columns, { onDismissed, onChosen }) {
    this.#status = status;
    this.#button = button;
    this.#columns = new ColumnChoices(columns, onChosen);
    button.addEventListener("click", () => {
      this.dismiss();
      onDismissed();
    });
  }

  /** Shows what was read from files, given what was chosen for their columns. */
  show(files, chosen, read) {
    const { name } = read;
    this.#name = name;
    this.#columns.show(files, chosen, read);
    const said = read.notes.filter(({ code }) => code !== "columns"); // these are lists to choose from
    const notes = [...new Map(said.map((note) => [note.text, note])).values()]; // several files may have the same
    const list = made("ul", {}, ...notes.map(noteItem));
    this.#status.replaceChildren(made("p", {}, name), ...(notes.length ? [list] : []));
    this.#button.setAttribute("aria-label", `Dismiss the notes on ${name}`);
    this.#button.hidden = false;
  }

  /** Shows the columns of files that cannot be read so, and names the file that is still open instead of its notes. */
  refused(files, chosen, problem) {
    this.#columns.show(files, chosen, problem);
    if (this.#name) this.#status.replaceChildren(made("p", {}, `Still open: ${this.#name}, as it was read before.`));
  }

  /** The name of what was opened last; "" once its notes are dismissed. */
  get name() {
    return this.#name;
  }

  dismiss() {
    this.#columns.clear();
    this.#name = "";
    this.#status.replaceChildren();
    this.#button.hidden = true;
  }
}
