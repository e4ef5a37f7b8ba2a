/** The name of the file that is shown, and what was taken for granted when it was read. */

export class FileNotes {
  #element;

  /** @param {HTMLElement} element a live region, which is read out when it is filled */
  constructor(element) {
    this.#element = element;
  }

  show({ name, notes }) {
    const title = made("p", { textContent: name });
    const dismiss = made("button", { type: "button", className: "remove", textContent: "×" });
    dismiss.setAttribute("aria-label", `Dismiss the notes on ${name}`);
    dismiss.addEventListener("click", () => this.dismiss());
    title.append(" ", dismiss);
    const list = made("ul");
    list.append(...notes.map(({ text }) => made("li", { textContent: text })));
    this.#element.replaceChildren(title, ...(notes.length ? [list] : []));
  }

  dismiss() {
    this.#element.replaceChildren();
  }
}

const made = (tag, members) => Object.assign(document.createElement(tag), members);
