/** Say what changes for whom, from the plan that is driven to another one of what is left. */

import { duration } from "../common/durations.js";
import { withCustomer } from "../inputs/details.js";
import { leftOf } from "./progress.js";

const MINUTE = 60; // seconds
const NEAR = 300; // seconds: a stop that is visited within as many of its time before stays as it was

/**
 * What changes at the stops, in sentences; how `many` of them stay as they were and change in which way, in one sentence; when the `last` vehicle is back; and
 * what changes for each vehicle, `{ name, before, after }`, with the number of its `stops` still to visit and when it is `back`, null of a vehicle that does not drive.
 *
 * @param {object[]} vans those of the plan that is driven, by `progressOf`
 * @param {object[]} lanes those of the other plan, `{ name, visits }`, by `progressOf` as well
 * @param {{ said: (time: number) => string, second: number } | null} clock puts times into words, and has their unit in seconds; null
 *   where that is not known
 * @param {{ out: Set<string>, removed: Set<string>, added: object[], unassigned: string[],
 *   customerOf: (stop: string) => string }} day what is out of service, cancelled, new, and left out of the other plan; and who is at a stop
 */
export function changesOf(vans, lanes, clock, { out, removed, added, unassigned, customerOf }) {
  const [before, after] = [vans, lanes].map(visitsIn);
  const words = wordsOf(clock);
  const stops = [...new Set([...before.keys(), ...after.keys()])];
  const isNew = new Set(added.map(({ id }) => id));
  const called = (stop) => withCustomer(stop, customerOf(stop));
  const known = stops.map((stop) => ({ stop, name: called(stop), from: before.get(stop), to: after.get(stop), isNew: isNew.has(stop) }));
  const left = known.filter(({ stop }) => !removed.has(stop));
  const moved = left.filter(({ from, to }) => from && to && from.name !== to.name);
  const stayed = left.filter(({ from, to }) => from && to && from.name === to.name);
  const retimed = stayed.filter(({ from, to }) => words.differ(from, to));
  const skipped = new Set(unassigned);
  const [fresh, others] = [true, false].map((each) => left.filter(({ from, to, isNew: isFresh }) => !from && to && isFresh === each));
  const dropped = left.filter(({ stop, from }) => from && skipped.has(stop));
  const unserved = [...isNew].filter((stop) => skipped.has(stop));
  const cancelled = known.filter(({ stop, from }) => from && removed.has(stop));
  const said = [
    ...moved.map(({ name, from, to }) => `${name} moves from ${from.name} to ${to.name}${words.shifted(from, to)}`),
    ...fresh.map(({ name, to }) => `${name} is new: ${to.name}${words.at(to)}`),
    ...others.map(({ name, to }) => `${name} was left out, and is now visited: ${to.name}${words.at(to)}`),
    ...dropped.map(({ name, from }) => `${name} is left out: ${from.name} no longer goes there`),
    ...unserved.map((stop) => `${called(stop)} is new, and is left out: nobody can go there`),
    ...cancelled.map(({ name, from }) => `${name} is cancelled: ${from.name} no longer goes there`),
    ...retimed.map(({ name, from, to }) => `${name} stays with ${to.name}${words.shifted(from, to)}`),
  ];
  const many = [
    [stayed.length - retimed.length, clock ? "stay as planned (within 5 min)" : "stay with their vehicle"],
    [retimed.length, "stay with their vehicle, but 5 min or more earlier or later"],
    [moved.length, "move to another vehicle"],
    [fresh.length, "are new"],
    [others.length, "were left out, and are now visited"],
    [dropped.length + unserved.length, "are left out"],
    [cancelled.length, "are cancelled"],
  ];
  return { said, many: manySaid(many), last: words.last(vans, lanes), vehicles: vehiclesOf(vans, lanes, out, words) };
}

/** How many stops change in each way, such as "Of 20 stops, 16 stay as planned, 3 move to another vehicle and 1 is new."; those of one way "all" do. */
function manySaid(many) {
  const there = many.filter(([count]) => count);
  const all = there.reduce((sum, [count]) => sum + count, 0);
  if (!all) return "";
  if (there.length === 1) return all === 1 ? `1 stop ${ofOne(there[0][1])}.` : `All ${all} stops still to visit ${there[0][1]}.`;
  const parts = there.map(([count, does]) => `${count} ${count === 1 ? ofOne(does) : does}`);
  return `Of ${all} stops, ${parts.slice(0, -1).join("; ")}; and ${parts.at(-1)}.`;
}

const ofOne = (does) => does.replace("stay ", "stays ").replace("move ", "moves ").replace("their", "its").replace("are ", "is ").replace("and are", "and is").replace("were ", "was ");

/** The visits that are still to be made, by their stop, with the name of the vehicle. */
function visitsIn(lanes) {
  const left = lanes.flatMap((lane) => lane.visits.filter(({ kind, done }) => kind === "visit" && !done).map((visit) => [visit.stop, { ...visit, name: lane.name }]));
  return new Map(left);
}

function vehiclesOf(vans, lanes, out, words) {
  const names = [...new Set([...vans, ...lanes].map(({ name }) => name))];
  const of = (all, name) => {
    const lane = all.find((each) => each.name === name);
    return lane ? { stops: leftOf(lane).length, back: words.back(lane) } : null;
  };
  const rows = names.map((name) => ({ name, before: of(vans, name), after: of(lanes, name), isOut: out.has(name) }));
  return rows.filter(({ before, after, isOut }) => isOut || after || before?.stops);
}

/** The words for times; none without a clock. */
function wordsOf(clock) {
  if (!clock) return { differ: () => false, shifted: () => "", at: () => "", back: () => "", last: () => "" };
  const { said, second } = clock;
  const seconds = (from, to) => (to.begin - from.begin) * second;
  const differ = (from, to) => Math.abs(seconds(from, to)) >= NEAR;
  const step = (from, to) => (differ(from, to) ? `, ${duration(MINUTE * Math.round(Math.abs(seconds(from, to)) / MINUTE))} ${seconds(from, to) > 0 ? "later" : "earlier"}` : "");
  const lastOf = (all) => Math.max(...all.map(({ visits }) => visits.at(-1).leaves));
  const last = (before, after) => (after.length ? `The last vehicle is back at ${said(lastOf(after))}${step({ begin: lastOf(before) }, { begin: lastOf(after) }) || ", as planned before"}.` : "");
  return {
    differ,
    last,
    shifted: (from, to) => `: ${said(to.begin)}${step(from, to)}`,
    at: ({ begin }) => ` at ${said(begin)}`,
    back: ({ visits }) => said(visits.at(-1).leaves),
  };
}
