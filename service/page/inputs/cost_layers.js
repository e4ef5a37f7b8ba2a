/** List the cost layers of a robot's map: what each holds, which one shades the map, its name, and a button that takes it away. */

import { made } from "../common/elements.js";
import { counted, length } from "../common/numbers.js";
import { DISTANCE } from "../common/objectives.js";
import { isOwnName } from "../planning/faults.js";

const element = (id) => document.getElementById(id);

/** The cost layers of a request, each `{ name, layer }`; one that the request does not name has no name. */
export const layersOf = ({ grid, cost_layer: layer, cost_layers: layers }) =>
  (grid && (Array.isArray(layers) ? layers : layer ? [{ name: null, layer }] : [])) || [];

export class CostLayers {
  #told;
  #layers = []; // as they are shown

  /**
   * @param {{ onName: (at: number, name: string) => void, onShade: (at: number) => void, onRemove: (at: number) => void }}
   *   told called with the place of the layer that is named, shades the map from now on, or is taken away
   */
  constructor(told) {
    this.#told = told;
    const list = element("layers-list");
    list.addEventListener("change", ({ target }) => this.#changed(target));
    list.addEventListener("click", ({ target }) => target.dataset.remove && told.onRemove(Number(target.dataset.remove)));
  }

  /** Shows the layers of a request: one without a name by this title, `fixed` if it cannot be taken away. A name that cannot be taken stays. */
  show(request, title, fixed) {
    const layers = layersOf(request);
    const same = layers.length === this.#layers.length && layers.every(({ layer }, at) => layer === this.#layers[at].layer);
    const typed = same ? [...element("layers-list").querySelectorAll(":invalid")] : [];
    this.#layers = layers;
    element("layers").hidden = !layers.length;
    const rows = layers.map((item, at) => row(item, at, { title, fixed, request, alone: layers.length === 1 }));
    element("layers-list").replaceChildren(...rows);
    for (const { dataset, value, validationMessage } of typed) {
      const field = Object.assign(rows[dataset.at].firstChild, { value });
      field.setCustomValidity(validationMessage);
    }
  }

  /** Takes another name, unless it is one of the others; without letters it stays as it was. */
  #changed(field) {
    if (field.name === "shaded") return this.#told.onShade(Number(field.value));
    const names = [DISTANCE, ...this.#layers].map(({ name }) => name);
    const at = Number(field.dataset.at);
    const [before] = names.splice(at + 1, 1);
    const name = field.value.trim() || before;
    if (isOwnName(field, name, names, "cost layer")) this.#told.onName(at, name);
  }
}

function row({ name, layer }, at, { title, fixed, request, alone }) {
  const called = name ?? title;
  const shade = input({ type: "radio", name: "shaded", value: String(at), checked: at === (request.shaded ?? 0) }, `Shade the map by ${called}`);
  const shades = made("label", { hidden: alone }, shade, "shades the map");
  const named = name === null
    ? made("b", {}, called)
    : input({ value: name, autocomplete: "off", maxLength: 100 }, `Name of cost layer ${at + 1}`);
  named.dataset.at = at;
  const holds = made("span", { className: "help" }, held(layer, request.grid));
  const remove = made("button", { type: "button", className: "remove", hidden: fixed }, "×");
  remove.dataset.remove = at;
  remove.setAttribute("aria-label", `Take ${called} away`);
  return made("li", {}, named, remove, holds, shades);
}

function input(members, label) {
  const field = made("input", members);
  field.setAttribute("aria-label", label);
  return field;
}

const known = new WeakMap(); // what layers hold: a large map has a million cells

/** What a layer costs on the free cells, in words; it says so where it decides nothing. */
function held(layer, grid) {
  if (!known.has(layer)) known.set(layer, counts(layer, grid));
  return known.get(layer);
}

function counts(layer, grid) {
  let [least, most, without, free] = [Infinity, -Infinity, 0, 0];
  grid.forEach((cells, row) =>
    cells.forEach((blocked, column) => {
      if (blocked) return;
      const cost = layer[row]?.[column];
      [least, most] = [Math.min(least, cost), Math.max(most, cost)];
      without += cost === 0;
      free += 1;
    }),
  );
  if (!free || !Number.isFinite(least)) return "";
  if (most === 0) return "0 on every free cell: it decides nothing";
  if (least === most) return `${length(most)} on every free cell: it only repeats the distance`;
  const nothing = without ? `, 0 on ${counted(without, "free cell", "free cells")}` : "";
  return `${length(least)} to ${length(most)} a metre${nothing}`;
}
