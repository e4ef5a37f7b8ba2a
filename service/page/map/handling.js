/** Take hold of the stops on a map: choose one, drag it, or move and delete it by keys. */

const REACH = { mouse: 9, pen: 14, touch: 22 }; // pixels from a stop within which it can be grabbed
const STILL = 4; // pixels that a pointer may move in a click
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

export class Handling {
  #map;
  #plane;
  #chosen;
  #held = null; // { city, from, moved }: the stop under a pointer
  #nudged = null; // where keys have moved the chosen stop so far
  #dragged = false; // whether the click to come is the end of a drag

  /**
   * @param {L.Map} map the map of the stops
   * @param {object} plane with `near(point, reach)`, the city at a point in pixels or null;
   *   `pointOf(city)`; `stride(fine)`, the pixels that an arrow key moves a stop; and `drag(city, point)` and
   *   `drop(city, point)`, called with the place where a stop is put
   * @param {ChosenStop} chosen the stop that is chosen; or an object like it that may be `placing` what it has chosen, by a click
   */
  constructor(map, plane, chosen) {
    this.#map = map;
    this.#plane = plane;
    this.#chosen = chosen;
    const container = map.getContainer();
    const listen = (kind, told) => container.addEventListener(kind, told, { capture: true, passive: false });
    listen("pointerdown", (event) => this.#press(event));
    listen("pointermove", (event) => this.#move(event));
    listen("pointerup", (event) => this.#release(event));
    listen("pointercancel", () => this.#letGo());
    listen("touchstart", (event) => this.#held && event.preventDefault()); // the page would scroll
    listen("click", (event) => this.#click(event));
    listen("keydown", (event) => this.#key(event));
    listen("keyup", (event) => event.key in ARROWS && this.#settle());
  }

  /** A finger moves the stop that it has chosen before, so that any other touch scrolls the page. */
  #press(event) {
    if (event.button !== 0 || !event.isPrimary) return;
    const city = this.#chosen.editable ? this.#at(event) : null;
    if (city === null || (event.pointerType === "touch" && city !== this.#chosen.city)) return;
    this.#held = { city, from: this.#point(event), moved: false, panning: this.#map.dragging.enabled() };
    this.#map.dragging.disable();
    this.#map.getContainer().setPointerCapture(event.pointerId);
  }

  #move(event) {
    if (!this.#held) return;
    const point = this.#point(event);
    this.#held.moved ||= point.distanceTo(this.#held.from) > STILL;
    if (this.#held.moved) this.#plane.drag(this.#held.city, point);
  }

  #release(event) {
    if (!this.#held) return;
    const { city, moved } = this.#held;
    this.#end();
    this.#dragged = moved && event.pointerType !== "touch";
    if (moved) this.#plane.drop(city, this.#point(event));
  }

  /** Puts the stop back if the browser ends a drag, or the key Escape. */
  #letGo() {
    if (!this.#held) return;
    const { city, moved } = this.#held;
    this.#end();
    this.#dragged = moved; // the click to come chooses nothing
    this.#plane.drag(city, this.#plane.pointOf(city));
  }

  #end() {
    if (this.#held.panning) this.#map.dragging.enable();
    this.#held = null;
  }

  #click(event) {
    if (this.#dragged) event.stopImmediatePropagation();
    else if (!this.#chosen.placing && !event.target.closest(".leaflet-control")) this.#chosen.choose(this.#at(event));
    this.#dragged = false;
  }

  #key(event) {
    const { city } = this.#chosen;
    if (event.target !== this.#map.getContainer()) return; // the zoom buttons have keys of their own
    if (event.key === "Escape" && this.#held) this.#letGo();
    else if (event.key === "Enter") this.#chosen.turn(event.shiftKey ? -1 : 1);
    else if (city === null) return;
    else if (event.key === "Escape") this.#chosen.choose(null);
    else if (!this.#chosen.editable) return;
    else if (event.key in ARROWS) this.#nudge(city, ARROWS[event.key], this.#plane.stride(event.shiftKey));
    else if (event.key === "Delete" || event.key === "Backspace") this.#chosen.remove();
    else return;
    event.preventDefault();
    event.stopImmediatePropagation(); // arrow keys would move the map as well
  }

  #nudge(city, [right, down], pixels) {
    this.#nudged = (this.#nudged ?? this.#plane.pointOf(city)).add([right * pixels, down * pixels]);
    this.#plane.drag(city, this.#nudged);
  }

  /** While an arrow key is held down, the stop is on its way. */
  #settle() {
    if (!this.#nudged) return;
    const point = this.#nudged;
    this.#nudged = null;
    if (this.#chosen.city !== null) this.#plane.drop(this.#chosen.city, point);
  }

  /** The stop at a pointer; null if there is none, or stops cannot be chosen. */
  #at(event) {
    if (!this.#chosen.choosable) return null;
    return this.#plane.near(this.#point(event), REACH[event.pointerType] ?? REACH.mouse);
  }

  #point(event) {
    return this.#map.mouseEventToContainerPoint(event);
  }
}
