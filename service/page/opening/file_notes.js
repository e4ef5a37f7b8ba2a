/** The name of the open file, and notes on what was assumed when it was read. */

export class FileNotes {
  #status;
  #button;

  /**
   * @param {HTMLElement} status a live region, which is read out when it is filled
   * @param {HTMLButtonElement} button dismisses the notes
   * @param {() => void} onDismissed called once that was pressed and is gone, and the focus with it
   */
  constructor(status, button, onDismissed) {
    this.#status = status;
    this.#button = button;
    button.addEventListener("click", () => {
      this.dismiss();
      onDismissed();
    });
  }

  show({ name, notes }) {
    const list = made("ul");
    list.append(...notes.map(({ text }) => made("li", { textContent: text })));
    this.#status.replaceChildren(made("p", { textContent: name }), ...(notes.length ? [list] : []));
    this.#button.setAttribute("aria-label", `Dismiss the notes on ${name}`);
    this.#button.hidden = false;
  }

  dismiss() {
    this.#status.replaceChildren();
    this.#button.hidden = true;
  }
}

const made = (tag, members) => Object.assign(document.createElement(tag), members);
