/** The request of a fleet as text, in a part of the form that unfolds. */

import { jsonOf } from "./fleet_request.js";

export class RequestText {
  #details;
  #asked = null;

  constructor(details) {
    this.#details = details;
    details.addEventListener("toggle", () => this.#write());
  }

  /** Shows a request; hides itself if there is none. */
  show(asked) {
    this.#asked = asked;
    this.#details.hidden = !asked;
    this.#write();
  }

  /** Writes nothing while it is folded: requests may be long. */
  #write() {
    const text = this.#asked && this.#details.open ? jsonOf(this.#asked) : "";
    this.#details.querySelector("pre").textContent = text;
  }
}
