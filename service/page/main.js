/** The page, put together: a request on the left, its front on the right. */

import { ExportButtons } from "./result/export_buttons.js";
import { clearFaults, showFault, showFaults } from "./planning/faults.js";
import { isRequest, read, readPasted } from "./inputs/files.js";
import { kindOf } from "./inputs/instance.js";
import { linked } from "./result/link.js";
import { UNNAMED, namesIn } from "./common/objectives.js";
import { Placing } from "./inputs/placing.js";
import { ReplanForm } from "./planning/replan_form.js";
import { Way } from "./planning/replanning.js";
import { RequestForm } from "./inputs/request_form.js";
import { say, sentence } from "./planning/status.js";
import { Planning } from "./planning/planning.js";
import { Service } from "./planning/service.js";

const element = (id) => document.getElementById(id);
// Charts and maps are most of the page's bytes: what is seen first does not wait for them.
const { Result } = await import("./result/result.js");
const form = element("request");
const service = new Service(() => element("key").value.trim());
const narrow = matchMedia("(max-width: 860px)"); // the form stands above what it gives, not beside
const result = new Result((...place) => {
  placing.clicked(...place);
  replanForm.clicked(...place);
});
const input = new RequestForm(form, edited);
const placing = new Placing(element("place"), element("place-help"), (row) => input.addCity(row));
const exporting = new ExportButtons(service, screen);
const replanForm = new ReplanForm(replan);

let way = null; // on which the front that is shown may be replanned
let objectives = UNNAMED; // as the front that is shown calls them
let planning = null; // what is under way
let answer = null; // the best front so far
let opened = 0; // how many requests were, or are being fetched, so that none takes the place of a later one

/** Takes what is asked for into the form, and shows its stops under their objectives. */
function open(wanted, names) {
  opened += 1;
  element("order").open = !["coordinates", "grid"].includes(kindOf(wanted));
  input.open(wanted, names);
}

/** Whatever was planned is not of these stops. */
function edited(instance, fit) {
  leave();
  clearFaults();
  say("");
  result.name((objectives = input.objectives), input.ids);
  result.clear(instance, fit);
  way = null;
  answered(null);
}

function answered(found) {
  answer = found;
  exporting.show(found);
  arrange();
  if (!found) replanForm.show(null);
}

/** What is on the screen. The rest of a way was not asked for as the form says. */
function screen() {
  return {
    request: input.request,
    asked: way?.replanned ? null : input.asked,
    objectives,
    picture: result.selected && result.picture,
    balance: result.selected?.balance,
  };
}

/** Where the form and the result stand above each other, the result comes first once there is one. */
function arrange() {
  const main = element("result").parentElement;
  if (narrow.matches && answer) main.prepend(element("result"));
  else if (!narrow.matches) main.append(element("result"));
}

/** Shows what comes of a plan; `states` asks a planning for it, and until then `waiting` is said. */
async function run(states, waiting = "The network is building its front.") {
  input.settle();
  leave();
  const mine = (planning = new Planning(service));
  clearFaults();
  busy(true);
  say(waiting);
  try {
    for await (const state of states(mine)) {
      if (mine.left) return;
      show(state);
    }
  } catch (error) {
    if (!mine.left) fail(error);
  } finally {
    if (planning === mine) busy(false);
  }
}

function show(state) {
  if (state.answer) {
    if (state.answer.objectives) objectives = namesIn(state.answer);
    result.name(objectives, way?.names ?? input.ids);
    result.show(way?.replanned ? { ...state, answer: way.answer(state.answer) } : state);
    answered(state.answer);
    if (state.stage === "done" && !["fleet", "grid", "unknown"].includes(kindOf(input.instance))) {
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
  busy(false);
}

function busy(yes) {
  element("plan").disabled = yes;
  element("stop").disabled = !yes;
  form.setAttribute("aria-busy", String(yes));
}

async function stop() {
  const mine = planning;
  await mine?.stop().catch(fail);
  // It had no job yet that would say so.
  if (mine?.left && mine === planning) say(answer ? sentence({ stage: "cancelled", answer }) : "Stopped.");
}

function fail(error) {
  if (error.code === undefined) throw error;
  say("");
  showFaults(error);
}

function openChosen() {
  openFiles([...element("file").files]);
  element("file").value = "";
}

const openFiles = (files) => files.length && openBrought(() => read(files));

/** Opens what `reading` gives, or says why it gives nothing. */
async function openBrought(reading) {
  try {
    const { members, objectives: names } = await reading();
    forgetExample();
    open(members, names);
  } catch (error) {
    showFault("file", error.message);
  }
}

/** Text that is a request is opened, wherever it is pasted; rows of cities go into their box. */
function pasted(event) {
  const text = event.clipboardData.getData("text");
  if (!isRequest(text)) return;
  event.preventDefault();
  openBrought(() => readPasted(text));
}

async function openExample() {
  const example = examples.find(({ file }) => file === element("example").value);
  element("about").textContent = example?.about ?? "";
  if (!example) return;
  leave();
  say("The example is being opened.");
  const mine = (opened += 1);
  try {
    const wanted = await service.get(`examples/${example.file}`);
    if (opened > mine) return;
    open(wanted, example.objectives);
  } catch (error) {
    return fail(error);
  }
  await plan();
}

function forgetExample() {
  element("example").value = "";
  element("about").textContent = "";
}

/** Opens the front that the address names; false where it names none. */
async function openLinked() {
  const link = await linked(location.hash);
  if (!link) return false;
  forgetExample();
  open(link.asked?.request ?? {}, link.asked?.objectives);
  result.want(link.balance);
  const searched = link.asked?.request.time_limit !== 0;
  const states = (mine) => (searched ? mine.follow(link.id) : unsearched(mine.follow(link.id)));
  await run((mine) => (link.asked ? again(states(mine), mine) : states(mine)));
  return true;
}

/** A front that the service has no more is planned again. */
async function* again(states, mine) {
  try {
    yield* states;
  } catch (error) {
    if (!["unknown-front", "front-expired"].includes(error.code)) throw error;
    yield* mine.plan(input.request);
  }
}

/** Of a front that no search was to improve, the network's is all there is. */
async function* unsearched(states) {
  for await (const state of states) yield { ...state, alone: state.answer, growth: [] };
}

form.addEventListener("submit", (event) => {
  event.preventDefault();
  if (narrow.matches) element("result").scrollIntoView();
  plan();
});
narrow.addEventListener("change", arrange);
element("stop").addEventListener("click", stop);
element("clear").addEventListener("click", () => {
  forgetExample();
  open({ coordinates: [] });
});
element("example").addEventListener("change", openExample);
element("file").addEventListener("change", openChosen);
for (const kind of ["dragover", "drop"]) addEventListener(kind, (event) => event.preventDefault());
addEventListener("dragover", () => element("drop").classList.add("over"));
addEventListener("dragleave", () => element("drop").classList.remove("over"));
addEventListener("drop", (event) => {
  element("drop").classList.remove("over");
  openFiles([...event.dataTransfer.files]);
});
addEventListener("paste", pasted);
addEventListener("hashchange", openLinked);
openChosen(); // while the page was being loaded

service.get("page/tiles.json").then((tiles) => result.tile(tiles), () => {});
const examples = await service.get("examples/index.json");
element("example").append(...examples.map(({ file, title }) => new Option(title, file)));
if (!(await openLinked()) && !opened) {
  element("example").value = examples[0].file;
  await openExample();
}
