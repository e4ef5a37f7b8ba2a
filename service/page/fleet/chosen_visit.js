/** The stop that is chosen in a lane or on a map, and the sentence that says when it is visited, and why it is late. */

import { counted } from "../common/numbers.js";
import { visitSentence } from "./visit_sentence.js";

const HINT = "Click a stop, on the map or in a line below, to read here when it is visited.";

export class ChosenVisit {
  #element;
  #lanes; // the Lanes that mark it
  #onChoose;
  #onStop;
  #stop = null; // its id
  #plan = { routes: [] };
  #shown = []; // the lanes that are shown
  #clock = null;

  /**
   * @param {(stop: string | null) => void} onChoose called with the stop that is chosen in a lane
   * @param {(stop: string | null) => void} onStop called with the stop that is chosen anywhere
   */
  constructor(element, lanes, onChoose, onStop) {
    this.#element = element;
    this.#lanes = lanes;
    this.#onChoose = onChoose;
    this.#onStop = onStop;
  }

  /** Takes another plan, in which the same stop stays chosen. */
  show(plan, lanes, clock) {
    [this.#plan, this.#shown, this.#clock] = [plan, lanes, clock];
    this.#element.hidden = !clock;
    this.chooseStop(this.#stop);
  }

  /** Chooses the stop at a place of a lane. */
  choose(place) {
    const { stop } = this.#shown[place.lane].visits[place.at];
    this.#onChoose(stop);
    this.#stop = stop;
    this.#onStop(stop);
    this.#mark(place);
  }

  /** Chooses a stop by its id; null chooses none. */
  chooseStop(stop) {
    this.#stop = stop;
    this.#onStop(stop);
    const places = stop === null ? [] : this.#placesOf(stop);
    if (places.length <= 1 && stop !== null && this.#clock) return this.#mark(places[0] ?? null);
    this.#lanes.choose(null);
    this.#element.textContent = stop !== null && places.length ? `${stop}: ${counted(places.length, "visit", "visits")} of vehicles that start, load or end there.` : HINT;
  }

  #mark(place) {
    this.#lanes.choose(place);
    this.#element.textContent = place ? visitSentence(this.#shown[place.lane], place.at, this.#clock) : this.#unvisited;
  }

  get #unvisited() {
    return this.#plan.unassigned?.includes(this.#stop) ? `${this.#stop} is left out of this plan.` : HINT;
  }

  #placesOf(stop) {
    return this.#shown.flatMap(({ visits }, lane) => visits.flatMap((visit, at) => (visit.stop === stop ? [{ lane, at }] : [])));
  }
}
