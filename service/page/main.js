/** The page: a request on the one side, its front on the other. */

import { isCity, rowsOf, textOf } from "./cities.js";
import { csv, curl, download } from "./exports.js";
import { clearFaults, showFault, showFaults } from "./faults.js";
import { Fields } from "./fields.js";
import { read } from "./files.js";
import { counted } from "./numbers.js";
import { UNNAMED } from "./objectives.js";
import { Placing } from "./placing.js";
import { plan } from "./planning.js";
import { Result } from "./result.js";
import { Service } from "./service.js";

const element = (id) => document.getElementById(id);
const form = element("request");
const fields = new Fields(form, element("fields"), element("more-fields"));
const service = new Service(() => element("key").value.trim());
const placing = new Placing(element("place"), element("place-help"), placed);
const result = new Result((plane, place) => placing.clicked(plane, place));

let rest = {}; // members of the request that have no field here
let running = null; // the AbortController of the plan under way
let answer = null;

function request() {
  return { path: "front", body: { coordinates: rowsOf(element("cities").value), ...rest, ...fields.members } };
}

/** Takes the members of a request into the form, and shows its cities under their objectives. */
function open(members, objectives = UNNAMED) {
  result.name(objectives);
  const { coordinates = [], ...others } = fields.take(members);
  rest = others;
  element("cities").value = textOf(coordinates);
  edited();
}

/** Whatever was planned is not of these cities. */
function edited(fit = true) {
  halt();
  clearFaults();
  const rows = rowsOf(element("cities").value);
  element("count").textContent = counted(rows.length, "city", "cities");
  result.clear(rows.filter(isCity), fit);
  answered(null);
}

function placed(row) {
  const rows = [...rowsOf(element("cities").value), row];
  element("cities").value = textOf(rows);
  edited(false);
}

function answered(found) {
  answer = found;
  for (const id of ["json", "csv"]) element(id).disabled = !found;
}

function say(text) {
  if (element("status").textContent !== text) element("status").textContent = text;
}

const SAID = {
  "warming-up": "This is the network’s front. The search is being compiled, which happens once and takes half a minute: the front improves as soon as it is ready.",
  improving: "This is the network’s front; the search is improving it.",
  done: "",
};

async function run() {
  halt();
  running = new AbortController();
  const { signal } = running;
  clearFaults();
  busy(true);
  say("The network is building its front.");
  try {
    for await (const state of plan(service, request(), signal)) {
      if (signal.aborted) break;
      result.show(state.alone, state.answer);
      answered(state.answer);
      say(SAID[state.stage] || ended(state.answer));
    }
  } catch (error) {
    if (!signal.aborted) fail(error);
  } finally {
    if (running?.signal === signal) busy(false);
  }
}

function busy(yes) {
  element("plan").disabled = yes;
  element("stop").disabled = !yes;
  form.setAttribute("aria-busy", String(yes));
}

function halt() {
  running?.abort();
  busy(false);
}

function stop() {
  halt();
  say(answer ? "Stopped: this is the network’s front." : "Stopped.");
}

function ended({ front, points }) {
  const shown = front.length < points ? `, the best ${front.length} of them shown` : "";
  return `Done: ${counted(points, "tour", "tours")} found${shown}.`;
}

function fail(error) {
  if (error.code === undefined) throw error;
  say("");
  showFaults(error);
}

async function openFiles(files) {
  if (!files.length) return;
  try {
    open(await read(files));
    element("example").value = "";
    say("");
  } catch (error) {
    showFault("file", error.message);
  }
}

async function openExample() {
  const example = examples.find(({ file }) => file === element("example").value);
  if (!example) return;
  try {
    open(await service.get(`examples/${example.file}`), example.objectives);
    await run();
  } catch (error) {
    fail(error);
  }
}

async function copy(text, button) {
  await navigator.clipboard.writeText(text);
  const label = button.textContent;
  button.textContent = "Copied";
  setTimeout(() => (button.textContent = label), 1500);
}

form.addEventListener("submit", (event) => {
  event.preventDefault();
  run();
});
element("stop").addEventListener("click", stop);
element("cities").addEventListener("input", () => edited());
element("clear").addEventListener("click", () => open({}));
element("example").addEventListener("change", openExample);
element("file").addEventListener("change", (event) => {
  openFiles([...event.target.files]);
  event.target.value = "";
});
element("curl").addEventListener("click", (event) => copy(curl(request()), event.target));
element("json").addEventListener("click", () =>
  download("front.json", "application/json", JSON.stringify(answer)),
);
element("csv").addEventListener("click", () => download("front.csv", "text/csv", csv(answer.front)));
for (const kind of ["dragover", "drop"]) addEventListener(kind, (event) => event.preventDefault());
addEventListener("dragover", () => element("drop").classList.add("over"));
addEventListener("dragleave", () => element("drop").classList.remove("over"));
addEventListener("drop", (event) => {
  element("drop").classList.remove("over");
  openFiles([...event.dataTransfer.files]);
});

const examples = (await service.get("examples/index.json")).filter(({ path }) => path === "/front");
element("example").append(...examples.map(({ file, title }) => new Option(title, file)));
element("example").value = examples[0].file;
await openExample();
