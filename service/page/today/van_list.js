/** The vehicles of the plan that is driven, each with its stops: a press marks one as done or takes it back, another cancels it. */

import { made } from "../common/elements.js";
import { swatch } from "../fleet/route_styles.js";
import { limitsOf } from "../fleet/visit_sentence.js";
import { withCustomer } from "../inputs/details.js";
import { isThere } from "./said.js";

export class VanList {
  #element;
  #key;

  /**
   * @param {HTMLElement} key says what the signs at stops mean
   * @param {{ onTurn: (stop: string) => void, onCancel: (stop: string) => void, onOut: (name: string) => void }} told
   */
  constructor(element, key, { onTurn, onCancel, onOut }) {
    this.#element = element;
    this.#key = key;
    element.addEventListener("click", ({ target }) => {
      const { turn, cancel } = target.closest("button")?.dataset ?? {};
      if (turn !== undefined) onTurn(turn);
      else if (cancel !== undefined) onCancel(cancel);
    });
    element.addEventListener("change", ({ target }) => onOut(target.dataset.out));
  }

  /**
   * Shows vehicles, each as of `progressOf`, with its `style` and what is `said` of it. The focus stays where it is.
   *
   * @param {{ clock: object | null, out: Set<string>, removed: Set<string> }} day
   */
  show(vans, { clock, out, removed }) {
    const focused = this.#element.contains(document.activeElement) && document.activeElement.dataset;
    this.#element.replaceChildren(...vans.map((van) => vanItem(van, { clock, isOut: out.has(van.name), removed })));
    this.#key.hidden = !vans.some(({ isOut }) => isOut);
    const [name, value] = Object.entries(focused || {})[0] ?? [];
    if (name) this.#element.querySelector(`[data-${name}="${CSS.escape(value)}"]`)?.focus();
  }
}

function vanItem({ name, style, said, visits, at, leaves, isOut: hasLeft }, { clock, isOut, removed }) {
  const there = isThere({ visits, at, leaves }) && visits[at].stop;
  const box = made("input", { type: "checkbox", checked: isOut });
  box.dataset.out = name;
  box.setAttribute("aria-label", `${name} is out of service`);
  const head = made("div", { className: "head" }, made("b", {}, swatch(style), name), made("span", {}, said), made("label", { className: "check" }, box, "out of service"));
  const stops = visits.flatMap((visit, place) => (visit.kind === "visit" ? [stopItem(visit, { clock, isThere: visit.stop === there, isNext: hasLeft && !isOut && !visit.done && !visits.slice(at + 1, place).some(({ kind }) => kind === "visit"), removed })] : []));
  return made("li", { className: "van" }, head, made("ul", { className: "chips" }, ...stops));
}

function stopItem({ stop, customer, done, begin, ...visit }, { clock, isThere: isNow, isNext, removed }) {
  const isCancelled = !done && removed.has(stop);
  const when = clock ? ` ${clock.said(begin)}` : "";
  const [who] = (customer ?? "").split(", ");
  const open = clock ? limitsOf(visit, clock.said) : [];
  const turn = made("button", { type: "button", className: "of", disabled: isCancelled, title: [withCustomer(stop, customer), ...open].join(", ") }, `${isNow ? "● " : done ? "✓ " : isNext ? "→ " : ""}${stop}${who && ` ${who}`}${when}`);
  turn.dataset.turn = stop;
  turn.setAttribute("aria-pressed", String(done));
  const item = made("li", { className: isNow ? "done now" : done ? "done" : isCancelled ? "gone" : isNext ? "here" : "" }, turn);
  if (done) return item;
  const cancel = made("button", { type: "button", className: "cancel" }, isCancelled ? "↩" : "×");
  cancel.dataset.cancel = stop;
  cancel.setAttribute("aria-label", isCancelled ? `Bring ${stop} back` : `Cancel ${stop}`);
  item.append(cancel);
  return item;
}
