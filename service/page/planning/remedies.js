/** Show what would help where a request is refused: a button for each change that the service has tried. */

import { made } from "../common/elements.js";
import { capital } from "../common/objectives.js";

export class Remedies {
  #place;
  #onChosen;

  /** @param {(remedy: { code: string, patch: object[] }) => void} onChosen changes the request, and plans it */
  constructor(place, onChosen) {
    this.#place = place;
    this.#onChosen = onChosen;
  }

  /** Shows the remedies of a problem in place of those before. */
  show({ errors: [first] }) {
    const found = first?.remedies ?? [];
    const button = (each) => made("button", { type: "button", textContent: capital(each.detail), onclick: () => this.#onChosen(each) });
    this.#place.replaceChildren(...(found.length ? ["What would help:"] : []), ...found.map(button));
  }

  reveal() {
    if (this.#place.hasChildNodes()) this.#place.scrollIntoView({ block: "nearest" });
  }

  clear() {
    this.#place.replaceChildren();
  }
}

/** A copy of a request that is changed by a JSON patch (RFC 6902), which adds members of objects or removes them. */
export function patched(request, patch) {
  const changed = structuredClone(request);
  for (const { op, path, value } of patch) {
    const parts = path.split("/").slice(1);
    const member = parts.pop();
    const object = parts.reduce((found, part) => found[part], changed);
    if (op === "remove" || value === null) delete object[member];
    else object[member] = value;
  }
  return changed;
}
