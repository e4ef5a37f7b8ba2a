/** Put the page together: a request on the left, its front on the right. */

import { arrange, narrow } from "./result/arrangement.js";
import { keepDraft, keptDraft } from "./opening/draft.js";
import { ExportButtons } from "./result/export_buttons.js";
import { clearFaults, revealFault, showFaults } from "./planning/faults.js";
import { formOf, kindNamed, kindOf } from "./common/kinds.js";
import { detailsByStop } from "./inputs/details.js";
import { chosenOf, keptAnswer } from "./result/chosen.js";
import { linked } from "./result/link.js";
import { UNNAMED } from "./common/objectives.js";
import { namesShown } from "./fleet/units.js";
import { keysOf } from "./inputs/request_keys.js";
import { without } from "./inputs/instance.js";
import { offerNoRoads } from "./inputs/objective_fields.js";
import { Placing } from "./inputs/placing.js";
import { holdStill } from "./inputs/pressing.js";
import { Undo } from "./inputs/undo.js";
import { ReplanForm } from "./planning/replan_form.js";
import { Remedies, patched } from "./planning/remedies.js";
import { Way } from "./planning/replanning.js";
import { RequestForm } from "./inputs/request_form.js";
import { SURVEY, say, sentence } from "./planning/status.js";
import { Planning } from "./planning/planning.js";
import { stored } from "./planning/stored.js";
import { Opening } from "./opening/opening.js";
import { takeDropped, takePasted } from "./opening/reading.js";
import { Problem, Service } from "./planning/service.js";

const element = (id) => document.getElementById(id);
const DROPPED = "The plan was not of these stops and vehicles: Undo brings it back. What changes while it is driven is told below the plan.";
// Charts and maps are most of the page's bytes: the first view does not wait for them.
const [{ Result }, { Today, restIn }] = await Promise.all([import("./result/result.js"), import("./today/today.js")]);
const form = element("request");
const service = new Service(() => element("key").value.trim());
const result = new Result(service, {
  onClick: (...place) => [placing, replanForm, today, input].forEach((each) => each.clicked(...place)),
  onMove(...moved) {
    input.moveCity(...moved);
    if (input.priced) say("Moved. Costs given as a matrix did not change.");
  },
  onDelete: (city) => input.deleteCity(city),
  ofEnds: { onMove: (...moved) => input.moveEnd(...moved), onRefused: say },
  onServe: (...served) => (input.serve(...served), plan()),
  onSelected: (...selected) => today.select(...selected),
});
const input = new RequestForm(form, service, { onEdited: edited, onEnds: result.showEnds, onShaded: result.shade, settled });
const placing = new Placing(element("place"), element("place-help"), (row) => input.addCity(row), result.wait);
const exporting = new ExportButtons(service, screen, (problem) => fail(problem, ""));
const replanForm = new ReplanForm(replan, result.wait);
const today = new Today(service, result, { onReplan: replanFleet, onBack: showDriven });
const opening = new Opening(service, result, {
  leave,
  offer,
  onDone: () => planning || say(""),
  open,
  recall: () => input.recall(),
  asked: () => input.asked,
  plan,
  fail,
  settings: () => serviceSettings,
  started: () => started,
});
const remedies = new Remedies(element("remedies"), remedy);
const { examples, reading, surroundings } = opening;
const undo = new Undo(element("undo"), takeBack);

let way = null; // the way on which the front shown can be replanned
let objectives = UNNAMED; // the names in the front shown
let mostSeconds = Infinity; // of a plan
let planning = null; // the planning that is running
let answer = null; // the best front so far
let answered = null; // its request
let refusal = null; // the last request that was refused, and why
let last = null; // the state in which the last plan was done, its request, and what was chosen in it
let opened = 0; // how many requests were opened
let shownOf = 0; // how many there were when the front was shown
let shown = false; // whether anything was opened or typed

/** Opens a request in the form, and shows its stops under their objectives. */
function open(wanted, names) {
  opened += 1;
  change(wanted, names);
}

/** Shows what was shown before a change, or before something else was opened. */
function takeBack({ asked, names, example, number }) {
  const isOther = number !== opened || example !== examples.chosen?.file;
  opened = number;
  if (isOther) opening.forget();
  if (isOther && examples.choose(example)) surroundings.begin(examples.chosen);
  change({ ...asked, ...input.planning }, names);
  if (isOther && examples.chosen) surroundings.fetch();
}

function change(wanted, names) {
  reading.end();
  element("order").open = !kindOf(wanted).onGrid && formOf(wanted) !== "coordinates";
  input.open(wanted, names);
}

/**
 * Drops the front, as it is not of these stops, and shows the last again if they are as they were. Without an instance,
 * what was typed cannot be read, and the front stays.
 */
function edited(instance, fit) {
  shown = true;
  opening.giveUp();
  leave();
  opening.clear();
  remedies.clear();
  if (!reading.isRunning) say("");
  if (!instance) return;
  const { asked } = input;
  const brought = without(asked, ...Object.keys(input.planning));
  undo.note(keysOf(asked).brought, { asked: brought, names: input.objectives, example: examples.chosen?.file, number: opened });
  const isAsked = (request) => request && keysOf(request).planned === keysOf(asked).planned; // details are not planned
  const again = isAsked(last?.asked);
  if (answer && isAsked(answered)) {
    result.retell(input.instance);
    if (again) tell(last.state);
    return;
  }
  if (answer && answer === last?.state.answer) last.chosen = result.taken;
  result.name((objectives = input.objectives), input.ids);
  const isDropped = answer && kindNamed(answer).path === "fleet" && shownOf === opened;
  result.clear(instance, { fit });
  way = null;
  take(null);
  if (again) showAgain(last);
  else if (isAsked(refusal?.asked)) remedies.show(refusal.problem);
  else if (isDropped) say(DROPPED);
}

function showAgain({ state, chosen: { balance, limits, selected } }) {
  result.want(balance, selected.item, limits);
  show(state);
}

const tell = (state) => say(sentence(state, kindOf(input.asked).onGrid));

function take(found) {
  answer = found;
  exporting.show(found);
  placeResult();
  if (!found) [replanForm, today].forEach((each) => each.show(null));
}

/** What is on the screen; null if what was typed cannot be read. A replanned front has no request in the form. */
async function screen() {
  if (input.unread && !(await settled())) return null;
  const asked = way?.replanned ? null : answered;
  const known = way?.asked ?? answered;
  return {
    request: input.request,
    refused: input.refused,
    asked,
    known,
    linked: way?.replanned ? input.asked : answered,
    rest: way?.linked(input.asked),
    example: examples.unchanged(asked),
    title: opening.title,
    objectives,
    details: detailsByStop(way?.asked ?? input.asked),
    ...result.taken,
  };
}

const placeResult = () => arrange(form, element("result"), answer || planning);

/** Shows the states of a planning, which `states` asks it for; until the first one, says `waiting`. */
async function run(states, waiting = "A quick first result is being made.", failed = fail) {
  if (input.unread && !(await settled())) return;
  leave();
  const mine = (planning = new Planning(service, mostSeconds));
  opening.clear();
  remedies.clear();
  offer();
  placeResult();
  say(waiting);
  try {
    for await (const state of states(mine)) {
      if (mine.left) return;
      show(state);
    }
  } catch (error) {
    if (!mine.left) failed(error);
  } finally {
    if (planning === mine) ended();
  }
}

function ended() {
  // It was stopped before it had a job to report that.
  if (planning.left) say(answer ? sentence({ stage: "cancelled", answer }) : "Stopped.");
  planning = null;
  offer();
}

function show(state) {
  if (state.answer) {
    objectives = namesShown(state.answer, objectives, input.instance);
    result.name(objectives, way?.names ?? input.ids);
    result.show(way?.replanned ? { ...state, answer: way.answer(state.answer) } : state);
    answered = input.asked;
    shownOf = opened;
    take(state.answer);
    if (state.stage === "done" && formOf(input.instance)) {
      way ??= new Way(input.instance, input.ids, state.answer.cities);
      replanForm.show(way);
    }
    if (state.stage === "done" && kindNamed(state.answer).path === "fleet") today.show({ state, way, asked: way?.asked ?? input.asked });
    last = state.stage === "done" && !way?.replanned ? { asked: answered, state } : null;
  }
  tell(state);
}

function plan() {
  if (input.fault) return fail(input.fault);
  const onGrid = kindOf(input.asked).onGrid;
  return run((mine) => planned(mine.plan(input.request)), onGrid ? SURVEY : undefined);
}

/** Changes the request by a remedy, and plans it; where stops may be left out, most of them are to be visited. */
function remedy({ code, patch }) {
  change(patched(input.asked, patch), input.objectives);
  if (["leave-out", "leave-these-out"].includes(code)) result.want(0);
  element("result").focus({ preventScroll: !narrow.matches });
  plan();
}

/** Leaves the front before as it is until there is another one: the request may be refused. */
async function* planned(states) {
  for await (const state of states) {
    if (state.answer) {
      way = null;
      [replanForm, today].forEach((each) => each.show(null));
    }
    yield state;
  }
}

/** Plans the rest of the selected tour. */
async function replan() {
  clearFaults();
  try {
    const body = way.body(replanForm.changes, result.selected);
    const longer = way.with(replanForm.places);
    const { id } = answer;
    await run((mine) => replanned(mine.replan(id, body), longer), "The rest of the tour is being planned.");
  } catch (error) {
    fail(error);
  }
}

/** Plans what is left of the day of a fleet, beside the plan that is driven. */
async function replanFleet() {
  clearFaults();
  const refused = (error) => {
    if (!(error instanceof Problem)) throw error;
    say("Not planned: what is shown is the plan before.");
    today.refuse(error);
  };
  try {
    const { id, body, way: rest } = today.asked;
    await run((mine) => replanned(mine.replan(id, body), rest), "What is left of the day is being planned.", refused);
  } catch (error) {
    refused(error);
  }
}

/** Shows the front of the plan that is driven again, and that plan. */
function showDriven({ state, way: before }, plan) {
  leave();
  way = before;
  result.clear(way?.instance ?? input.instance, { fit: false, editable: !way });
  result.want(plan.balance, plan);
  show(state);
}

async function* replanned(states, longer) {
  for await (const state of states) {
    if (state.answer) {
      way = longer;
      result.replan(way.instance, way.names);
      if (way.preferred) result.want(undefined, way.preferred(way.answer(state.answer).front));
    }
    yield state;
  }
}

function leave() {
  planning?.leave();
  planning = null;
  offer();
}

/** Enables Plan while nothing is read or planned, and Stop while something is. */
function offer() {
  const busy = Boolean(planning || reading.isRunning);
  element("plan").disabled = busy;
  element("stop").disabled = !busy;
  form.setAttribute("aria-busy", String(busy));
}

async function stop() {
  if (reading.isRunning) opening.stop();
  await planning?.stop().catch((error) => fail(error, "Not stopped."));
}

/** Reads what was typed. Returns false if it cannot be read, which is shown, or if reading was ended. */
async function settled() {
  if (reading.isRunning) return false; // what is being read replaces what was typed
  try {
    return await opening.run("What was typed is being read.", (mine) => input.settle(mine));
  } catch (error) {
    fail(error);
    return false;
  }
}

/** Shows an error at its fields, and says what has failed: by default, planning. */
function fail(error, said = answer ? "Not planned: what is shown is the plan before." : "") {
  if (!(error instanceof Problem)) throw error;
  say(said);
  showFaults(error);
  remedies.show(error);
  refusal = { asked: input.asked, problem: error };
  if (!answer && error.errors[0]?.remedies) element("front-chart").setAttribute("aria-label", "There is no plan. What would help stands below Plan.");
  input.mark();
  const fault = revealFault(); // a phone shows the form below
  element("waiting").textContent = fault;
  remedies.reveal();
  return fault;
}

/** Opens the front that a link names. Returns false if it names none. */
async function openLinked(link) {
  if (!link) return false;
  if (!(await openAsked(link))) return true;
  if (!link.id) return true;
  way = restIn(link.asked, input);
  if (way) result.clear(way.instance, { editable: false });
  const carried = keptAnswer(link, way?.instance ?? input.instance, way?.names ?? input.ids);
  result.want(link.balance, carried?.front[0], link.asked?.limits);
  const request = !way && (link.asked?.request || examples.chosen) ? input.request : null;
  const known = { request, searched: input.asked.time_limit !== 0, carried };
  await run((mine) => stored(mine, link.id, known));
  return true;
}

/** Opens the request in a link. Returns false if something else was opened meanwhile. */
async function openAsked({ example, asked }) {
  opening.forget();
  if (examples.choose(example)) return opening.openExample(example);
  open(asked?.request ?? {}, asked?.objectives);
  return true;
}

/** What is shown, as a link; null where that is nothing, or an example without a front. */
function draft() {
  if (!shown) return null;
  const request = input.asked;
  const example = examples.unchanged(request);
  const { balance, limits, selected } = result.taken;
  const { id } = (selected && answer) || {};
  if (!id) return example ? null : { asked: { request, objectives } };
  const chosen = way?.replanned ? undefined : chosenOf(answer, selected.item, true);
  return { id, balance, example, asked: { request, objectives, limits, chosen, rest: way?.linked(request) } };
}

form.addEventListener("submit", (event) => {
  event.preventDefault();
  plan(); // on a phone this puts the result above the form
  if (narrow.matches) element("result").scrollIntoView();
});
form.addEventListener("input", ({ target }) => {
  element("file-fault").textContent = "";
  if (target.matches("#cities, [aria-invalid]:valid")) clearFaults();
});
holdStill();
narrow.addEventListener("change", placeResult);
element("stop").addEventListener("click", stop);
element("clear").addEventListener("click", () => {
  opening.forget();
  change({ coordinates: [] });
});
element("example").addEventListener("change", ({ target }) => opening.planExample(target.value));
element("file").addEventListener("change", () => opening.openChosen());
const openFiles = (files) => opening.openFiles(files);
takeDropped(element("drop"), openFiles, (name) => opening.refuseFolder(name));
takePasted(openFiles);
addEventListener("hashchange", async () => openLinked(await linked(location.hash)));
for (const leaving of ["beforeunload", "pagehide"]) {
  addEventListener(leaving, (event) => keepDraft(draft()) || event.preventDefault());
}

const serviceSettings = service.get("page/settings.json").catch(() => null);
const started = start();
offer(); // only now: before, the browser itself would send the form
opening.openChosen(); // while the page was being loaded
serviceSettings.then((settings) => {
  if (!settings) return;
  mostSeconds = settings.seconds;
  result.equip(settings, service);
  if (!settings.roads) offerNoRoads();
});

/** Opens what the address names, or else the first example, unless the user opened or typed something meanwhile. */
async function start() {
  try {
    examples.offer(await service.get("examples/index.json"));
  } catch (error) {
    if (!shown) open({ coordinates: [] });
    return fail(error);
  }
  if ((await openLinked(keptDraft() ?? (await linked(location.hash)))) || shown) return;
  opening.begin();
}
