/** The reading that is running, of files, of an example or of typed text: there is one at most, and it can be ended. */

import { Problem } from "../planning/service.js";

export class Ongoing {
  #running = null;
  #onChange;
  #onDone;

  /** @param {{ onChange: () => void, onDone: () => void }} told called when a reading begins or ends, and when one is done */
  constructor({ onChange, onDone }) {
    this.#onChange = onChange;
    this.#onDone = onDone;
  }

  get isRunning() {
    return this.#running !== null;
  }

  /** Ends the reading that is running. */
  end() {
    this.#running?.abort();
    this.#running = null;
    this.#onChange();
  }

  /** Runs a reading, and ends any other; `task` takes an AbortController. Returns false if it was ended. */
  async run(task) {
    this.end();
    const mine = (this.#running = new AbortController());
    this.#onChange();
    try {
      await task(mine);
      return true;
    } catch (error) {
      if (mine.signal.aborted && (error.name === "AbortError" || error instanceof Problem)) return false;
      throw error;
    } finally {
      if (this.#running === mine) {
        this.end();
        this.#onDone();
      }
    }
  }
}
