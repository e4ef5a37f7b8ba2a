/** Say what changes for whom, from the plan that is driven to another one of what is left. */

import { duration } from "../common/durations.js";
import { withCustomer } from "../inputs/details.js";
import { leftOf } from "./progress.js";

const MINUTE = 60; // seconds
const NEAR = 300; // seconds: a stop that is visited within as many of its time before stays as it was

/**
 * What changes at the stops, in sentences; how many stay as they were; when the `last` vehicle is back; and what changes for each vehicle, `{ name, before,
 * after }`, with the number of its `stops` left and when it is `back`, null of a vehicle that does not drive.
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
  const said = [
    ...moved.map(({ name, from, to }) => `${name} moves from ${from.name} to ${to.name}${words.shifted(from, to)}`),
    ...left.filter(({ from, to }) => !from && to).map(({ name, to, isNew: fresh }) => `${name} ${fresh ? "is new" : "was left out"}: ${to.name}${words.at(to)}`),
    ...left.filter(({ stop, from }) => from && skipped.has(stop)).map(({ name, from }) => `${name} is left out: ${from.name} does not come`),
    ...[...isNew].filter((stop) => skipped.has(stop)).map((stop) => `${called(stop)} is new, and is left out`),
    ...known.filter(({ stop, from }) => from && removed.has(stop)).map(({ name, from }) => `${name} is cancelled: ${from.name} does not come`),
    ...retimed.map(({ name, from, to }) => `${name} stays with ${to.name}${words.shifted(from, to)}`),
  ];
  return { said, same: stayed.length - retimed.length, last: words.last(vans, lanes), vehicles: vehiclesOf(vans, lanes, out, words) };
}

/** The visits that are left, by their stop, with the name of the vehicle. */
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
  const step = (from, to) => (differ(from, to) ? `, ${duration(MINUTE * Math.round(Math.abs(seconds(from, to)) / MINUTE))} ${seconds(from, to) > 0 ? "later" : "earlier"}` : ", at about the same time");
  const lastOf = (all) => Math.max(...all.map(({ visits }) => visits.at(-1).leaves));
  const last = (before, after) => (after.length ? `The last vehicle is back at ${said(lastOf(after))}${step({ begin: lastOf(before) }, { begin: lastOf(after) })}.` : "");
  return {
    differ,
    last,
    shifted: (from, to) => `${step(from, to)}: ${said(to.begin)}`,
    at: ({ begin }) => ` at ${said(begin)}`,
    back: ({ visits }) => said(visits.at(-1).leaves),
  };
}
