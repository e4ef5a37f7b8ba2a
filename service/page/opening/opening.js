/** Open files and examples, one at a time, or say what could not be opened. */

import { Examples } from "./examples.js";
import { FileNotes } from "./file_notes.js";
import { withEdited, withFleet, withTyped } from "./own_fleet.js";
import { Reading, read } from "./reading.js";
import { Surroundings } from "./surroundings.js";
import { areOfVehicles } from "./vehicle_files.js";
import { counted } from "../common/numbers.js";
import { clearFaults, showFault, showFaults } from "../planning/faults.js";
import { Problem } from "../planning/service.js";
import { say } from "../planning/status.js";

const MOST_COUNTED = 1000; // wrong cells: the service does not read on
const WAITING = "waiting"; // the code of files of vehicles that wait for stops
const element = (id) => document.getElementById(id);

export class Opening {
  #service;
  #page;
  #awaited = null; // the file of an example that will be shown, unless files are opened instead
  #refusal = null; // the refusal of such files, while that example is fetched nevertheless
  #vehiclesRead; // as JSON, before they were edited
  #stopsRead; // likewise
  #ofStops = []; // the files that were opened last, without a table of vehicles that joined them
  #ofVehicles = []; // files of vehicles that wait for stops
  #notes = new FileNotes(element("file-notes"), element("dismiss-notes"), element("columns"), {
    onDismissed: () => element("file").focus(),
    onChosen: (...chosen) => this.openFiles(...chosen),
  });

  /**
   * @param {{ leave: () => void, offer: () => void, onDone: () => void, open: (request: object, names: object[]) => void, recall: () => void, asked: () => object,
   *   plan: () => void, fail: (error: Problem, said: string) => void, settings: () => Promise<object | null>, started: () => Promise<void> }} page
   *   leaves any planning; offers what can be done when a reading begins or ends; is told that one is done; shows a request; fills in what is
   *   remembered of every day; has the request that is shown; plans it; shows an error, and what has failed; has the settings of the service; and knows when the first view is decided
   */
  constructor(service, result, page) {
    this.#service = service;
    this.#page = page;
    this.examples = new Examples(element("example"), element("about"));
    this.surroundings = new Surroundings(service, result);
    this.reading = new Reading(page.offer, page.onDone);
  }

  /** Takes all faults away, but for the refusal of files that an example is shown instead of. */
  clear() {
    clearFaults();
    if (this.#refusal) tellUnread(this.#refusal);
  }

  /** Shows no example once its fetching ends: something else is shown. */
  giveUp() {
    this.#awaited = null;
  }

  /** The title of the example, or the names of the files, that are shown; "" where stops were typed. */
  get title() {
    return this.examples.chosen?.title ?? this.#notes.name;
  }

  stop() {
    this.reading.end();
    if (this.#awaited) this.examples.forget();
    this.giveUp();
    say("Stopped.");
  }

  forget() {
    this.examples.forget();
    this.#ofStops = [];
    this.#ofVehicles = [];
    this.#notes.dismiss();
    this.surroundings.forget();
  }

  /** Runs a reading instead of any planning. A refusal of files stays visible while the example is fetched that replaces them. */
  run(words, task, refusal = null) {
    this.#page.leave();
    this.#refusal = refusal;
    this.clear();
    say(words);
    return this.reading.run(task);
  }

  openChosen() {
    this.openFiles([...element("file").files]);
    element("file").value = "";
  }

  /** Opens files as a request, or says why that is not possible; until then nothing can be planned. `columns` were chosen. */
  async openFiles(files, columns = []) {
    if (!files.length) return;
    const words = files.length > 1 ? "The files are being read." : "The file is being read.";
    try {
      await this.run(words, async ({ signal }) => {
        const { brought, opened, shown = opened } = await this.#joined(files, columns, signal);
        signal.throwIfAborted();
        const asked = this.examples.chosen ? {} : this.#page.asked();
        const ofStops = opened === files ? files : this.#ofStops;
        this.forget();
        const kept = withTyped((columns.length ? withEdited : withFleet)(brought, asked.vehicles, this.#vehiclesRead), opened !== files && asked, this.#stopsRead);
        this.#open(kept);
        if (brought.columns) this.#page.recall(); // what a table seldom says
        this.#ofStops = ofStops;
        this.#notes.show(shown, columns, kept);
      });
    } catch (error) {
      this.#notes.refused(files, columns, error);
      await this.#unread(error);
    }
  }

  /** Says that a folder cannot be opened. */
  refuseFolder(name) {
    const problem = new Problem({ code: "folder", detail: `${name} is a folder: drop its files` });
    this.#notes.refused([], [], problem);
    tellUnread(problem);
  }

  /** Opens what was read, and notes which of its vehicles nobody has edited. */
  #open({ members, objectives, vehicles }) {
    this.#page.open({ ...members, ...(vehicles && { vehicles }) }, objectives);
    const asked = this.#page.asked();
    if (!vehicles) this.#vehiclesRead = JSON.stringify(asked.vehicles);
    this.#stopsRead = JSON.stringify(asked.stops);
  }

  /** What was read from files, and these; a table of vehicles joins the files of stops that are open, or are opened next. */
  async #joined(files, columns, signal) {
    if (!columns.length && (await areOfVehicles(files))) {
      if (this.#ofStops.length) return this.#joining(files, columns, signal);
      this.#ofVehicles = files;
      throw new Problem({ code: WAITING, detail: `the vehicles of ${files.map(({ name }) => name).join(", ")} wait for their stops: open the table of these next` });
    }
    const opened = [...files, ...this.#ofVehicles.splice(0)];
    if (opened.length > files.length) return { brought: await this.#read(opened, columns, signal), opened: files, shown: opened };
    try {
      return { brought: await this.#read(files, columns, signal), opened: files };
    } catch (error) {
      const isOfVehicles = error.errors?.some(({ code }) => code === "vehicles-alone");
      if (!isOfVehicles || !this.#ofStops.length) throw error;
      return this.#joining(files, columns, signal);
    }
  }

  async #joining(files, columns, signal) {
    const opened = [...this.#ofStops, ...files];
    return { brought: await this.#read(opened, columns, signal), opened };
  }

  async #read(files, columns, signal) {
    try {
      return await read(this.#service, files, columns, (await this.#page.settings())?.roads ?? true, signal);
    } catch (error) {
      await this.#page.started(); // and the list says which example is shown instead
      throw error;
    }
  }

  /** Keeps what was shown, which can be planned; shows an example that was awaited. */
  async #unread(error) {
    tellUnread(error);
    if (!this.#awaited) return;
    if (await this.openExample(this.#awaited, error)) this.#page.plan();
    if (this.#refusal === error) this.#refusal = null;
  }

  /** Opens an example by its file. Returns false if it does not exist, or something else was opened meanwhile. */
  async openExample(file, refused) {
    if (!this.examples.choose(file)) return false;
    const { chosen } = this.examples;
    this.#awaited = file;
    this.#ofStops = [];
    this.#notes.dismiss();
    const fetched = async ({ signal }) => {
      const wanted = await this.#service.get(`examples/${file}`, signal);
      this.surroundings.begin(chosen);
      this.#page.open(wanted, chosen.objectives);
    };
    try {
      if (!(await this.run("The example is being opened.", fetched, refused))) return false;
    } catch (error) {
      this.giveUp();
      this.examples.forget();
      this.#page.fail(error, `The example “${chosen.title}” was not opened.`);
      return false;
    }
    this.examples.opened(this.#page.asked());
    this.surroundings.fetch();
    return true;
  }

  async planExample(file) {
    if (await this.openExample(file)) await this.#page.plan();
  }

  /** Plans the first example, or shows it if the files that are being read cannot be opened. */
  begin() {
    if (this.reading.isRunning) this.#awaited = this.examples.first;
    else this.planExample(this.examples.first);
  }
}

function tellUnread(error) {
  if (!(error instanceof Problem)) throw error;
  const { code, message, errors, wrongCells } = error;
  if (code === "unauthorized") showFaults(error);
  else if (code === WAITING) showFault("file", message);
  else if (wrongCells > 1) showFault("file", `not opened: ${countOf(wrongCells)} cannot be read`, listed(errors, wrongCells));
  else showFault("file", `not opened: ${message}`);
}

const countOf = (cells) => `${cells < MOST_COUNTED ? "" : "at least "}${counted(cells, "cell", "cells")}`;

/** The sentences on the first wrong cells, and how many more there are. */
function listed(errors, count) {
  const more = count - errors.length;
  return [...errors.map(({ detail }) => detail), ...(more ? [`and ${more.toLocaleString("en")} more`] : [])];
}
