/** The fields about the time of day: when tours may leave, and a picture of how the times of travel change. */

import { canDepart, canHaveDay, changingOver, clockIn, OWN, departuresIn, hoursFrom, hoursIn, hoursText, hoursTyped, leaving } from "./day.js";
import { svgElement } from "../common/elements.js";
import { isRead } from "../planning/faults.js";
import { timeOfDay, timeText } from "../common/durations.js";

const [HOUR, DAY, LATEST] = [3600, 86400, 864000]; // seconds
const ROOM = 2 * HOUR; // before the first of the hours, and after the last one
const [WIDTH, HEIGHT] = [100, 40]; // of the picture, in units that it is stretched by
const MARKS = 4; // below the picture, at most
const ENDS = ["departure", "departure-latest"];
const NOT_A_TIME = "Leaves at must be a time, as 7:30";
const NOT_HOURS = "Rush hours must be times and factors in order, as 7:00 1; 7:30 1.6; 9:30 1";

const GIVEN = {
  slices: "The times of travel at each hour came with the file.",
  traffic: "The times of travel at each hour are those of the routing engine.",
};

const element = (id) => document.getElementById(id);
const sliders = ENDS.map((id) => element(`${id}-slider`));
const fields = [...ENDS, "hours"].map(element);

export class DayForm {
  #asked = null;
  #onChange;

  /** @param {(changed: object) => void} onChange takes the changed request */
  constructor(onChange) {
    this.#onChange = onChange;
    for (const [axis, id] of ENDS.entries()) {
      element(id).addEventListener("change", ({ target }) => this.#typed(axis, target.value));
      sliders[axis].addEventListener("input", ({ target }) => this.#slid(axis, Number(target.value)));
      sliders[axis].addEventListener("change", () => this.#leave(sliders.map(({ value }) => Number(value))));
    }
    element("hours").addEventListener("change", ({ target }) => this.#change(target.value));
  }

  /** Takes a request that was opened: its time of day is unfolded if it has one. */
  open(asked) {
    for (const field of fields) field.setCustomValidity("");
    this.show(asked);
    element("day").open = canHaveDay(asked) && (departuresIn(asked) !== null || (!canDepart(asked) && hoursIn(asked).length > 0));
  }

  /** Shows a changed request; what is not understood stays in its field. */
  show(asked) {
    element("day").hidden = !canHaveDay(asked);
    if (element("day").hidden) return;
    this.#asked = asked;
    const [hours, times] = [hoursIn(asked), departuresIn(asked)];
    for (const [axis, id] of ENDS.entries()) write(element(id), times ? written(times[axis]) : "");
    element("departures").hidden = !canDepart(asked);
    element("departure-sliders").hidden = !times;
    if (times) for (const [axis, slider] of sliders.entries()) place(slider, scaleOf(hours, times), times[axis]);
    write(element("hours"), hoursFrom(asked) ? "" : hoursText(hours));
    element("hours").disabled = Boolean(hoursFrom(asked)) || isTimeless(asked);
    element("hours-help").textContent = helpOn(asked);
    draw(hours, times);
  }

  #typed(axis, text) {
    const found = timeOfDay(text);
    const isTime = !text.trim() || found <= LATEST;
    if (!isRead(element(ENDS[axis]), isTime, NOT_A_TIME)) return;
    if (found === undefined) return axis ? this.#leave([0, 0].map(() => departuresIn(this.#asked)?.[0])) : this.#leave(null);
    this.#leave(pushed(departuresIn(this.#asked) ?? [found, found], axis, found));
  }

  /** Follows a slider: the other one goes along where they would cross. */
  #slid(axis, value) {
    const times = pushed(sliders.map((slider) => Number(slider.value)), axis, value);
    for (const [at, slider] of sliders.entries()) {
      place(slider, scaleOf(hoursIn(this.#asked), departuresIn(this.#asked)), times[at]);
      element(ENDS[at]).setCustomValidity("");
      element(ENDS[at]).value = written(times[at]);
    }
    draw(hoursIn(this.#asked), times, departuresIn(this.#asked));
  }

  #leave(times) {
    this.#onChange(leaving(this.#asked, times?.[0] === undefined ? null : times));
  }

  #change(text) {
    const hours = hoursTyped(text);
    if (isRead(element("hours"), Boolean(hours), NOT_HOURS)) this.#onChange(changingOver(this.#asked, hours));
  }
}

function write(field, text) {
  if (field.validity.valid) field.value = text;
}

const written = (seconds) => timeText(Math.round(seconds)) ?? String(seconds);

/** Both times after one of them has changed, which takes the other along rather than passing it. */
const pushed = (times, axis, value) => times.map((time, at) => (at === axis ? value : axis ? Math.min(time, value) : Math.max(time, value)));

function helpOn(asked) {
  const brought = GIVEN[hoursFrom(asked)];
  if (brought) return brought;
  if (isTimeless(asked)) return "No objective is a time: measure one by road, or in straight lines at a speed.";
  return "From each time on, travel takes so much longer: 7:30 1.6 is 1.6 times as long.";
}

const isTimeless = (asked) => clockIn(asked) < 0 && clockIn(asked) !== OWN;

/** The first and the last second of the picture and its sliders: whole hours around all that is in it. */
function scaleOf(hours, times) {
  const inside = [...hours.map(([from]) => from), ...(times ?? [])];
  if (!hours.length) return [0, Math.max(DAY, ...inside.map((time) => DAY * Math.ceil(time / DAY)))];
  const [first, last] = [Math.min(...inside), Math.max(...inside)];
  return [Math.max(0, HOUR * Math.floor((first - ROOM) / HOUR)), Math.min(LATEST, HOUR * Math.ceil((last + ROOM) / HOUR))];
}

function place(slider, [from, to], time) {
  Object.assign(slider, { min: from, max: to, value: time });
  slider.setAttribute("aria-valuetext", written(Number(slider.value)));
}

/** Draws the hours as steps, and when tours may leave as a band; `scaled` are the times that the scale is for. */
function draw(hours, times, scaled = times) {
  element("hours-chart").hidden = !hours.length;
  if (!hours.length) return;
  const [from, to] = scaleOf(hours, scaled);
  const most = Math.max(...hours.map(([, factor]) => factor));
  const x = (time) => (WIDTH * (time - from)) / (to - from);
  const y = (factor) => HEIGHT - (0.85 * HEIGHT * factor) / most;
  const steps = hours.map(([begins, factor], at) => `${at ? `H${x(begins)}` : `M0 ${y(factor)}`}V${y(factor)}`).join("");
  const shapes = [
    svgElement("path", { d: `${steps}H${WIDTH}V${HEIGHT}H0Z`, class: "area" }),
    svgElement("path", { d: `${steps}H${WIDTH}`, class: "steps" }),
  ];
  if (times) shapes.push(svgElement("rect", { x: x(times[0]), y: 0, width: Math.max(x(times[1]) - x(times[0]), 0.7), height: HEIGHT, class: "leaves" }));
  const picture = svgElement("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, preserveAspectRatio: "none", "aria-hidden": true });
  picture.append(...shapes);
  const peak = hours.find(([, factor]) => factor === most);
  const said = labelAt(x(Math.max(peak[0], from)), `×${Number(most.toPrecision(3))}`, "peak");
  element("hours-chart").replaceChildren(picture, said, ...marks(from, to).map((time) => labelAt(x(time), written(time), "mark")));
  element("hours-chart").setAttribute("aria-label", `Times of travel over the day, as factors: ${hoursText(hours.map(([at, factor]) => [at, Number(factor.toPrecision(3))]))}`);
}

function labelAt(percent, text, className) {
  const made = Object.assign(document.createElement("span"), { textContent: text, className });
  made.style.left = `${percent}%`;
  return made;
}

/** Whole hours, evenly spread over the scale. */
function marks(from, to) {
  const step = HOUR * Math.max(1, Math.ceil((to - from) / HOUR / MARKS));
  return Array.from({ length: Math.floor((to - from) / step) + 1 }, (_, at) => from + at * step);
}
