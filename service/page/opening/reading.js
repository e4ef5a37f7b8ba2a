/** Let the service read files, also dropped ones, and pasted text as if it were a file, one reading at a time. */

import { namesIn } from "../common/objectives.js";
import { withSoundDetails } from "../inputs/details.js";
import { inRows } from "../inputs/instance.js";
import { proposed } from "../inputs/map_proposal.js";
import { Problem } from "../planning/service.js";
import { withoutRoads } from "./roads.js";

const POINT = { code: "robot-radius", text: "The robot is taken for a point, so its path may touch walls: set its radius under Plan." };

/**
 * The request that the form opens, the names of its objectives, and the file's name with the notes on it and its
 * columns. `chosen` are columns that are to be taken for something else than their names say. `roads` says whether
 * the service has a routing engine.
 */
export async function read(service, files, chosen, roads, signal) {
  const sorted = files.toSorted((one, other) => (one.name < other.name ? -1 : 1)); // as file dialogs have no order
  await Promise.all(sorted.map(checked));
  const answer = await service.read(sorted, signal, chosen);
  const { request, planes, name, notes, columns, choices, details, unknown_cells: unknown } = roads ? answer : withoutRoads(answer);
  const { matrices, ...others } = request;
  // The form rounds distances itself, so that planes stay planes.
  const members = planes ? { ...others, coordinates: planes, rounded: true } : proposed(inRows(request));
  if (members.robot_radius === 0 && request.robot_radius === undefined) notes.push(POINT);
  if (unknown) members.unknownCells = unknown;
  return { members: withSoundDetails({ ...members, details }), objectives: namesIn(members), name, notes, columns, choices };
}

/** The reading that is running: `onChange` is called when it begins or ends, `onDone` when it is done. */
export class Reading {
  #running = null;
  #onChange;
  #onDone;

  constructor(onChange, onDone) {
    this.#onChange = onChange;
    this.#onDone = onDone;
  }

  get isRunning() {
    return this.#running !== null;
  }

  end() {
    this.#running?.abort();
    this.#running = null;
    this.#onChange();
  }

  /** Ends any other reading, and runs a task, which takes an AbortController. Returns false if it was ended. */
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

/** A file that the browser cannot read would look like a service that does not answer. */
async function checked(file) {
  const reader = file.stream().getReader();
  try {
    await reader.read();
    await reader.cancel();
  } catch {
    throw new Problem({ code: "unreadable-file", detail: `${file.name}: the browser cannot read it: choose it again` });
  }
}

/**
 * Marks an element while something is dragged over the page, and opens the files that are dropped. A
 * browser gives no content of folders, so only the name of the first one is passed on.
 */
export function takeDropped(marked, openFiles, onFolder) {
  for (const kind of ["dragover", "drop"]) addEventListener(kind, (event) => event.preventDefault());
  addEventListener("dragover", () => marked.classList.add("over"));
  addEventListener("dragleave", () => marked.classList.remove("over"));
  addEventListener("drop", ({ dataTransfer: { files, items } }) => {
    marked.classList.remove("over");
    const folder = [...items].map((item) => item.webkitGetAsEntry?.()).find((entry) => entry?.isDirectory);
    if (folder) onFolder(folder.name);
    else openFiles([...files]);
  });
}

/** Opens text of a file, wherever it is pasted; rows of numbers go into their box. */
export function takePasted(openFiles) {
  addEventListener("paste", (event) => {
    const file = pastedFile(event.clipboardData.getData("text"));
    if (!file) return;
    event.preventDefault();
    openFiles([file]);
  });
}

/** The file of text that is pasted; null for rows of numbers, and for a name or a number for a field. */
export function pastedFile(text) {
  const [first, ...others] = text.trim().split("\n");
  const isFile = /^[{[]/.test(first) || (others.length && /[^-+\d.,;e\s]/i.test(first));
  return isFile ? new File([text], "pasted text") : null;
}
