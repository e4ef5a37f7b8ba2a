/** The buttons that copy what is on the screen, or save it as a file. */

import { columnsIn, withoutDetails } from "../inputs/details.js";
import { chosenOf, placeIn } from "./chosen.js";
import { areLocated, csvOfVisits, fillSheet, gpxOf, routesOf } from "./driver.js";
import { alone, csv, curl, download, withSelected } from "./exports.js";
import { fragment } from "./link.js";
import { pngOf, svgOf } from "./picture.js";
import { python } from "./python.js";
import { totalsOf } from "./totals.js";
import { csvOfPaths, drivenPaths, navPathsOf } from "./robot_paths.js";

const ALONE = "This link opens the result without its maps: the request is too long for an address.";
const NO_POSES = "Its path has no poses: its map has no origin. A map.yaml has one.";
const COPIED = "Copied"; // a button's text, for a moment after it was last pressed
const MOMENT = 1500; // ms
const OF_FRONT = ["link", "json", "csv", "geojson", "svg", "png", "stops-csv", "tour-json", "gpx", "print", "path-json", "path-csv"];

const KEPT_BY_SERVICE = ["json", "csv", "geojson"]; // what is made of the whole front

const element = (id) => document.getElementById(id);

export class ExportButtons {
  #shown = null;
  #service;

  /**
   * @param {Service} service the service that has the front
   * @param {() => Promise<{ request: object, refused: Problem | null, asked: object, known: object, linked: object, rest: object, example: string | null, objectives: object[],
   *   title: string, details: Function, picture: object, balance: number, driven: boolean, selected: object } | null>} screen what is on the
   *   screen, the request for a link and the rest of a day that it is of, what drivers are told of its stops as of `detailsByStop`, the file of its example, whether its lines can follow the streets, and the selected tour or
   *   plan, as of `routesOf`; null if the form cannot be read. `refused` is what the request would be refused for
   * @param {(problem: Problem) => string} mend shows what must be mended at its field, and returns it
   */
  constructor(service, screen, mend) {
    this.#service = service;
    const on = (id, act) =>
      element(id).addEventListener("click", async ({ target }) => {
        const shown = await screen();
        if (shown) act(shown, target);
      });
    const onRequest = (id, written) =>
      on(id, (shown, button) => {
        say(shown.refused ? `Mend this first, to copy it: ${mend(shown.refused)}` : "");
        if (!shown.refused) copy(written(shown), button);
      });
    onRequest("curl", ({ request }) => curl(request));
    onRequest("python", ({ request, balance }) => python(request, balance));
    for (const id of ["link", "link-details"]) on(id, (shown, button) => this.#copyLink(shown, button));
    on("json", () => download("front.json", "application/json", JSON.stringify(this.#shown)));
    on("csv", (shown) => download("front.csv", "text/csv", csv(this.#shown, shown, this.#place(shown))));
    on("geojson", (shown) => this.#saveGeojson(shown.driven, this.#place(shown)));
    on("stops-csv", (shown) => download("stops.csv", "text/csv", csvOfVisits(this.#routes(shown))));
    on("tour-json", (shown) => download("tour.json", "application/json", JSON.stringify(alone(this.#shown, this.#item(shown)))));
    on("gpx", (shown) => this.#saveGpx(this.#routes(shown)));
    on("print", (shown) => (this.#fillSheet(shown), print()));
    on("path-json", (shown) => this.#savePaths(shown, "path.json", "application/json", navPathsOf));
    on("path-csv", (shown) => this.#savePaths(shown, "path.csv", "text/csv", csvOfPaths));
    on("svg", ({ picture }) => download("front.svg", "image/svg+xml", svgOf(picture)));
    on("png", async ({ picture }) => download("front.png", "image/png", await pngOf(svgOf(picture))));
  }

  /** Takes a front to export, or null. */
  show(answer) {
    this.#shown = answer;
    say("");
    element("link-details").hidden = true;
    for (const id of OF_FRONT) element(id).disabled = !answer;
    element("paths").hidden = !answer?.places;
    if (answer?.kept) for (const id of KEPT_BY_SERVICE) element(id).disabled = true;
    if (answer?.stops?.every(({ location }) => location)) return;
    element("geojson").disabled = element("gpx").disabled = true;
  }

  /** The selected tour or plan as the service has it: tours of a rest are drawn among the stops before. */
  #item(shown) {
    return this.#shown.front[this.#place(shown)] ?? shown.selected.item;
  }

  /** Its place in the front; -1 if it is not there. */
  #place({ selected: { item } }) {
    return placeIn(this.#shown.front, item);
  }

  #routes({ selected, known, details }) {
    return routesOf(selected, this.#shown, known, details);
  }

  #fillSheet(shown) {
    const { selected, objectives, known, title } = shown;
    fillSheet(element("sheet"), this.#routes(shown), { title, date: new Date(), totals: totalsOf(selected, objectives, known) });
  }

  #saveGpx(routes) {
    if (!areLocated(routes)) return say("Not all of its stops have places.");
    download("tour.gpx", "application/gpx+xml", gpxOf(routes));
  }

  #savePaths(shown, name, type, written) {
    const paths = drivenPaths(this.#item(shown));
    say(paths ? "" : NO_POSES);
    if (paths) download(name, type, written(paths));
  }

  async #copyLink(shown, button) {
    const { asked, linked, rest, example, objectives, balance, limits } = shown;
    const chosen = chosenOf(this.#shown, this.#item(shown), Boolean(asked));
    const isWhole = button.id === "link-details";
    const request = example || !linked ? undefined : isWhole ? linked : withoutDetails(linked);
    const known = { request, objectives, limits, chosen, rest: rest && (isWhole ? rest : withoutDetails(rest)) };
    const { hash, whole } = await fragment(this.#shown.id, balance, known, example);
    history.replaceState(null, "", hash);
    const left = request && whole && !isWhole ? columnsIn(linked) : "";
    say(request && !whole ? ALONE : left && `The link leaves out ${left}, which you and the drivers see.`);
    element("link-details").hidden = !left && !isWhole;
    await copy(location.href, button);
  }

  /** Streets are refused for very many stops: then the lines are straight, with a note. */
  async #saveGeojson(driven, selected) {
    const streets = driven && (await this.#geojson("?geometry=roads").catch(({ message }) => say(straight(message))));
    download("front.geojson", "application/geo+json", withSelected(streets || (await this.#geojson("")), selected));
  }

  async #geojson(query) {
    const headers = { Accept: "application/geo+json" };
    return (await this.#service.ask(`front/${this.#shown.id}${query}`, { headers })).text();
  }
}

const straight = (message) => `The lines in the file go straight from stop to stop: ${message}.`;

function say(text) {
  element("link-help").textContent = text;
}

const said = new Map(); // buttons that show they were pressed: their own text, and the timer that restores it

async function copy(text, button) {
  await navigator.clipboard.writeText(text);
  const { label, timer } = said.get(button) ?? { label: button.textContent };
  clearTimeout(timer);
  button.textContent = COPIED;
  const back = () => {
    button.textContent = label;
    said.delete(button);
  };
  said.set(button, { label, timer: setTimeout(back, MOMENT) });
}
