/** Help to choose by a few questions, which the service asks: which of these is best? One click each. */

import { amount } from "../common/amounts.js";
import { made } from "../common/elements.js";
import { counted } from "../common/numbers.js";
import { titled } from "../common/objectives.js";
import { Problem } from "../planning/service.js";

const QUESTIONS = 3;

const element = (id) => document.getElementById(id);

export class Asking {
  #service;
  #onChosen;
  #front = null; // `{ id, objectives, noun }` of the front that can be asked about
  #picks = [];

  /** @param {(index: number) => void} onChosen called with the tour or plan that the picks have led to */
  constructor(service, onChosen) {
    this.#service = service;
    this.#onChosen = onChosen;
    element("ask").addEventListener("click", () => this.#ask([]));
    element("ask-back").addEventListener("click", () => this.#ask(this.#picks.slice(0, -1)));
    element("ask-end").addEventListener("click", () => this.#end());
  }

  /** Offers to ask about a front that the service keeps; null if there is none with a choice. */
  show(front) {
    if (front?.id === this.#front?.id) return;
    this.#front = front;
    element("ask").hidden = !front;
    element("question").hidden = true;
  }

  async #ask(picks) {
    const { id } = this.#front;
    const path = `front/${encodeURIComponent(id)}/questions?questions=${QUESTIONS}&picks=${picks.join()}`;
    try {
      const question = await this.#service.get(path);
      if (this.#front?.id === id) this.#take(question, picks);
    } catch (error) {
      if (!(error instanceof Problem)) throw error;
      element("ask-fault").textContent = error.message;
    }
  }

  #take({ left, options, number }, picks) {
    this.#picks = picks;
    element("ask-fault").textContent = "";
    if (number !== undefined) {
      this.#onChosen(number);
      return this.#end();
    }
    element("question").hidden = false;
    element("ask").hidden = true;
    element("ask-back").disabled = !picks.length;
    element("question-said").textContent = `Question ${QUESTIONS - left + 1} of ${QUESTIONS}: which do you like best?`;
    element("options").replaceChildren(...options.map((option, at) => this.#card(option, at)));
    element("options").firstChild.focus();
  }

  #card({ point, best, within_reach: count }, at) {
    const { objectives, noun } = this.#front;
    const parts = objectives.map((objective, axis) => lengths(objective, best[axis], point[axis]));
    const reach = made("small", {}, `${counted(count, noun.one, noun.many)} to choose from`);
    const card = made("button", { type: "button", className: "option" }, ...parts, ...(count > 1 ? [reach] : []));
    card.addEventListener("click", () => this.#ask([...this.#picks, at]));
    return card;
  }

  #end() {
    element("question").hidden = true;
    element("ask").hidden = false;
    element("ask").focus();
  }
}

/** What an objective is at most if a card is picked, and at best; one value if it is a tour or plan. */
function lengths(objective, least, most) {
  const [low, high] = [least, most].map((value) => amount(value, objective));
  const said = low === high ? [made("b", {}, low)] : [made("b", {}, `at most ${high}`), ` or as little as ${low}`];
  return made("span", {}, made("span", { className: "name" }, titled(objective)), " ", ...said, " ");
}
