/** The page, put together: a request on the left, its front on the right. */

import { Examples } from "./opening/examples.js";
import { ExportButtons } from "./result/export_buttons.js";
import { clearFaults, showFault, showFaults } from "./planning/faults.js";
import { FileNotes } from "./opening/file_notes.js";
import { formOf, kindOf } from "./common/kinds.js";
import { linked } from "./result/link.js";
import { UNNAMED, namesIn } from "./common/objectives.js";
import { Placing } from "./inputs/placing.js";
import { ReplanForm } from "./planning/replan_form.js";
import { Way } from "./planning/replanning.js";
import { RequestForm } from "./inputs/request_form.js";
import { say, sentence } from "./planning/status.js";
import { Planning } from "./planning/planning.js";
import { stored } from "./planning/stored.js";
import { pastedFile, read } from "./opening/reading.js";
import { Surroundings } from "./opening/surroundings.js";
import { takeDropped } from "./opening/dropping.js";
import { Problem, Service } from "./planning/service.js";

const element = (id) => document.getElementById(id);
// Charts and maps are most of the page's bytes: what is seen first does not wait for them.
const { Result } = await import("./result/result.js");
const form = element("request");
const service = new Service(() => element("key").value.trim());
const narrow = matchMedia("(max-width: 860px)"); // the form stands above what it gives, not beside
const result = new Result({
  onClick: (...place) => [placing, replanForm].forEach((each) => each.clicked(...place)),
  onMove(...moved) {
    input.moveCity(...moved);
    if (input.priced) say("Moved. Costs that were given as a matrix stay as they are.");
  },
  onDelete: (city) => input.deleteCity(city),
});
const input = new RequestForm(form, service, edited, settled);
const placing = new Placing(element("place"), element("place-help"), (row) => input.addCity(row), result.wait);
const examples = new Examples(element("example"), element("about"));
const fileNotes = new FileNotes(element("file-notes"), element("dismiss-notes"), () => element("file").focus());
const surroundings = new Surroundings(service, result);
const exporting = new ExportButtons(service, screen);
const replanForm = new ReplanForm(replan, result.wait);

let way = null; // on which the front that is shown may be replanned
let objectives = UNNAMED; // as the front that is shown calls them
let planning = null; // what is under way
let reading = null; // what ends the reading of files, of an example or of typed text that is under way
let answer = null; // the best front so far
let shown = false; // whether anything was opened or typed
let awaited = null; // the file of an example that is to be shown, unless files are opened in its place
let refusal = null; // of such files, while that example is fetched all the same

/** Takes what is asked for into the form, and shows its stops under their objectives. */
function open(wanted, names) {
  giveUp();
  element("order").open = !kindOf(wanted).onGrid && formOf(wanted) !== "coordinates";
  input.open(wanted, names);
}

/** Whatever was planned is not of these stops. */
function edited(instance, fit) {
  shown = true;
  awaited = null;
  leave();
  clear();
  if (!reading) say("");
  result.name((objectives = input.objectives), input.ids);
  result.clear(instance, { fit });
  way = null;
  answered(null);
}

function answered(found) {
  answer = found;
  exporting.show(found);
  arrange();
  if (!found) replanForm.show(null);
}

/** What is on the screen; null where what was typed cannot be read. The rest of a way was not asked for as the form says. */
async function screen() {
  if (input.unread && !(await settled())) return null;
  const asked = way?.replanned ? null : input.asked;
  return {
    request: input.request,
    asked,
    example: examples.unchanged(asked),
    objectives,
    ...result.taken,
  };
}

/** Where form and result stand above each other, the result comes first from when one is planned. */
function arrange() {
  const [main, shown] = [form.parentElement, element("result")];
  const above = main.firstElementChild === shown;
  const wanted = narrow.matches && Boolean(above || answer || planning);
  if (wanted !== above) main[wanted ? "prepend" : "append"](shown); // moved, it loses the focus
}

/** Shows what comes of a plan; `states` asks a planning for it, and until then `waiting` is said. */
async function run(states, waiting = "The network is building its front.") {
  if (input.unread && !(await settled())) return;
  leave();
  const mine = (planning = new Planning(service));
  clear();
  offer();
  arrange();
  say(waiting);
  try {
    for await (const state of states(mine)) {
      if (mine.left) return;
      show(state);
    }
  } catch (error) {
    if (!mine.left) fail(error);
  } finally {
    if (planning === mine) ended();
  }
}

function ended() {
  // It was stopped before it had a job that would say so.
  if (planning.left) say(answer ? sentence({ stage: "cancelled", answer }) : "Stopped.");
  planning = null;
  offer();
}

function show(state) {
  if (state.answer) {
    if (state.answer.objectives) objectives = namesIn(state.answer);
    result.name(objectives, way?.names ?? input.ids);
    result.show(way?.replanned ? { ...state, answer: way.answer(state.answer) } : state);
    answered(state.answer);
    if (state.stage === "done" && formOf(input.instance)) {
      way ??= new Way(input.instance, input.ids, state.answer.cities);
      replanForm.show(way);
    }
  }
  say(sentence(state));
}

function plan() {
  way = null;
  replanForm.show(null);
  return run((mine) => mine.plan(input.request));
}

/** Plans what is left of the selected tour. */
async function replan() {
  clearFaults();
  try {
    const body = way.body(replanForm.changes, result.selected.tour);
    const longer = way.with(replanForm.places);
    const { id } = answer;
    await run((mine) => replanned(mine.replan(id, body), longer), "What is left is being planned.");
  } catch (error) {
    if (!(error instanceof Problem)) throw error;
    showFault("replan", error.message);
  }
}

async function* replanned(states, longer) {
  for await (const state of states) {
    if (state.answer) {
      way = longer;
      result.replan(way.instance, way.names);
    }
    yield state;
  }
}

function leave() {
  planning?.leave();
  planning = null;
  offer();
}

/** Whatever is being read is not wanted any more. */
function giveUp() {
  reading?.abort();
  reading = null;
  offer();
}

/** Offers to plan while nothing is read or planned, and to stop while something is. */
function offer() {
  const busy = Boolean(planning || reading);
  element("plan").disabled = busy;
  element("stop").disabled = !busy;
  form.setAttribute("aria-busy", String(busy));
}

function clear() {
  clearFaults();
  if (refusal) tellUnread(refusal);
}

async function stop() {
  if (reading) {
    giveUp();
    if (awaited) examples.forget();
    awaited = null;
    say("Stopped.");
  }
  await planning?.stop().catch(fail);
}

/**
 * Reads in the place of whatever is read or planned; `task` takes an AbortController. False where it was
 * given up. A refusal of files goes on being told while the example is fetched that is shown instead.
 */
async function whileReading(words, task, told = null) {
  leave();
  giveUp();
  const mine = (reading = new AbortController());
  refusal = told;
  clear();
  offer();
  say(words);
  try {
    await task(mine);
    return true;
  } catch (error) {
    if (mine.signal.aborted && (error.name === "AbortError" || error instanceof Problem)) return false;
    throw error;
  } finally {
    if (reading === mine) {
      giveUp();
      if (!planning) say("");
    }
  }
}

/** Has what was typed read; false where it cannot be, which is told, or where that was given up. */
async function settled() {
  if (reading) return false; // and takes the place of what was typed
  try {
    return await whileReading("What was typed is being read.", (mine) => input.settle(mine));
  } catch (error) {
    fail(error);
    return false;
  }
}

function fail(error) {
  if (!(error instanceof Problem)) throw error;
  say("");
  showFaults(error);
  element("waiting").textContent = document.querySelector(".fault:not(:empty)").textContent; // a phone shows the form below
}

function openChosen() {
  openFiles([...element("file").files]);
  element("file").value = "";
}

/** Opens the request that files are, or says why they are none; until then nothing can be planned. */
async function openFiles(files) {
  if (!files.length) return;
  const words = files.length > 1 ? "The files are being read." : "The file is being read.";
  try {
    await whileReading(words, async ({ signal }) => {
      const brought = await brings(files, signal);
      signal.throwIfAborted();
      forgetExample();
      open(brought.members, brought.objectives);
      fileNotes.show(brought);
    });
  } catch (error) {
    await unread(error);
  }
}

async function brings(files, signal) {
  try {
    return await read(service, files, (await equipment)?.roads ?? true, signal);
  } catch (error) {
    await started; // and with it is known which example is shown instead
    throw error;
  }
}

/** What was shown stays, and can be planned; an example that was awaited is shown. */
async function unread(error) {
  tellUnread(error);
  if (!awaited) return;
  if (await openExample(awaited, error)) plan();
  if (refusal === error) refusal = null;
}

function tellUnread(error) {
  if (!(error instanceof Problem)) throw error;
  if (error.code === "unauthorized") showFaults(error);
  else showFault("file", `not opened: ${error.message}`);
}

function tellFolder(name) {
  tellUnread(new Problem({ code: "folder", detail: `${name} is a folder: drop its files` }));
}

/** Text as of a file is opened, wherever it is pasted; rows of numbers go into their box. */
function pasted(event) {
  const file = pastedFile(event.clipboardData.getData("text"));
  if (!file) return;
  event.preventDefault();
  openFiles([file]);
}

/** Opens an example by its file; false where there is none, or another was opened meanwhile. */
async function openExample(file, refused) {
  if (!examples.choose(file)) return false;
  const { chosen } = examples;
  awaited = file;
  fileNotes.dismiss();
  const fetched = async ({ signal }) => {
    const wanted = await service.get(`examples/${file}`, signal);
    surroundings.begin(chosen);
    open(wanted, chosen.objectives);
  };
  try {
    if (!(await whileReading("The example is being opened.", fetched, refused))) return false;
  } catch (error) {
    awaited = null;
    examples.forget();
    fail(error);
    return false;
  }
  examples.opened(input.asked);
  surroundings.fetch();
  return true;
}

async function planExample(file) {
  if (await openExample(file)) await plan();
}

function forgetExample() {
  examples.forget();
  fileNotes.dismiss();
  surroundings.forget();
}

/** Opens the front that the address names; false where it names none. */
async function openLinked() {
  const link = await linked(location.hash);
  if (!link) return false;
  if (!(await openAsked(link))) return true;
  result.want(link.balance);
  const request = link.asked || examples.chosen ? input.request : null;
  const searched = input.asked.time_limit !== 0;
  await run((mine) => stored(mine, link.id, request, searched));
  return true;
}

/** Opens what a link was asked for; false where something else was opened meanwhile. */
async function openAsked({ example, asked }) {
  forgetExample();
  if (examples.choose(example)) return openExample(example);
  open(asked?.request ?? {}, asked?.objectives);
  return true;
}

form.addEventListener("submit", (event) => {
  event.preventDefault();
  if (narrow.matches) element("result").scrollIntoView();
  plan();
});
form.addEventListener("input", ({ target }) => {
  element("file-fault").textContent = "";
  if (target.id === "cities") clearFaults();
});
narrow.addEventListener("change", arrange);
element("stop").addEventListener("click", stop);
element("clear").addEventListener("click", () => {
  forgetExample();
  open({ coordinates: [] });
});
element("example").addEventListener("change", ({ target }) => planExample(target.value));
element("file").addEventListener("change", openChosen);
takeDropped(element("drop"), openFiles, tellFolder);
addEventListener("paste", pasted);
addEventListener("hashchange", openLinked);

const equipment = service.get("page/map.json").catch(() => null);
const started = start();
offer(); // from now on: before, the browser itself would send the form
openChosen(); // while the page was being loaded
equipment.then((map) => map && result.equip(map, service));

/** Opens what the address names, or else the first example, unless something was opened or typed meanwhile. */
async function start() {
  examples.offer(await service.get("examples/index.json"));
  if ((await openLinked()) || shown) return;
  if (reading) awaited = examples.first;
  else planExample(examples.first);
}
