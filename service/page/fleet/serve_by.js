/** Choose the vehicle that serves the chosen stop of a fleet. */

const element = (id) => document.getElementById(id);

export class ServeBy {
  #stop = null; // the id of the chosen stop

  /** @param {(stop: string, vehicle: string) => void} onServe called with a stop, and the type of vehicles for it or "" */
  constructor(onServe) {
    element("serve-by").addEventListener("change", ({ target }) => onServe(this.#stop, target.value));
  }

  /** Offers the vehicles of a request for a stop; none without a stop, or for one where vehicles start, end or load. */
  show(stop, known) {
    this.#stop = stop;
    const [asked, types] = [known.stops.get(stop), [...known.types]];
    const isDepot = types.some(([, { start, end, reload }]) => [start, end, ...reload].includes(stop));
    element("serve").hidden = !asked || isDepot;
    if (!asked) return;
    element("serve-by").replaceChildren(new Option("any vehicle", ""), ...types.map(([id]) => new Option(id)));
    element("serve-by").value = asked.vehicle ?? "";
  }
}
