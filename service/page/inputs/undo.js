/** Take changes of what is planned back, and make them again. */

const MOST = 200; // changes
const TEXT = 'textarea, input:not([type="range"], [type="checkbox"], [type="file"])';

export class Undo {
  #past = []; // the last is what is shown
  #undone = [];
  #key = null; // of what is shown
  #going = false;
  #button;

  /**
   * @param {HTMLButtonElement} button takes back the last change, as Ctrl+Z does, which in a text that is being typed is the browser's
   * @param {(shown: object) => void} show shows what was noted
   */
  constructor(button, show) {
    this.#button = button;
    const go = (from, to) => {
      to.push(from.pop());
      this.#offer();
      this.#going = true;
      show(this.#past.at(-1));
      this.#going = false;
    };
    const back = () => this.#past.length > 1 && go(this.#past, this.#undone);
    const forth = () => this.#undone.length && go(this.#undone, this.#past);
    button.addEventListener("click", back);
    addEventListener("keydown", (event) => {
      const way = wayOf(event);
      if (!way || isTyping(event.target)) return;
      event.preventDefault();
      if (way === "back") back();
      else forth();
    });
  }

  /** Notes what is shown after a change; `key` differs where it does. */
  note(key, shown) {
    const isOther = key !== this.#key && !this.#going;
    this.#key = key;
    if (!isOther) return;
    this.#past = [...this.#past, shown].slice(-MOST);
    this.#undone = [];
    this.#offer();
  }

  #offer() {
    this.#button.disabled = this.#past.length < 2;
  }
}

function wayOf({ key, ctrlKey, metaKey, shiftKey }) {
  if (!ctrlKey && !metaKey) return null;
  if (key.toLowerCase() === "z") return shiftKey ? "forth" : "back";
  return key === "y" ? "forth" : null;
}

/** Whether a text is being typed, and not only has the cursor, as a cell of a table that is as it was. */
const isTyping = (field) => field.matches(TEXT) && field.value !== field.dataset.shown;
