/** Say in one sentence when a vehicle visits a stop, and why it is late or waits there. */

import { withCustomer } from "../inputs/details.js";

/**
 * @param {{ name: string, visits: object[] }} lane the route of a vehicle, with what it does at each stop, by `visitTimes`
 * @param {number} at the place of the stop on it
 * @param {{ said: (time: number) => string, lasting: (time: number) => string }} clock puts times into words
 */
export function visitSentence({ name: named, visits }, at, { said, lasting }) {
  const visit = visits[at];
  const name = named.includes(", ") ? `${named},` : named; // with its shift
  const from = at ? ` from ${visits[at - 1].stop}` : "";
  const { kind, arrival, begin, waiting, rests, due, late, released } = visit;
  const stop = called(visit);
  if (kind === "start") {
    const shift = laterThanShift(visit, said);
    return `${stop}: ${name} sets off ${departure(visits, said)}${shift && `; its shift begins at ${shift}`}.`;
  }
  const arrives = `${name} arrives at ${said(arrival)}${from}`;
  if (kind === "end") return `${stop}: ${arrives}${late ? `, ${lasting(late)} after its shift ends at ${said(due)}` : " and is done"}.`;
  const waits = waiting ? ` and waits ${lasting(waiting)}` : "";
  const rest = rests.length ? `; the driver has a break from ${spansIn(rests, said).join(" and from ")}` : "";
  if (kind === "loading") return `${stop}: ${name} loads again at ${said(begin)}${waited(released, begin)}; it arrives at ${said(arrival)}${from}${waits}${rest}.`;
  return `${stop}: ${limitsOf(visit, said).map((each) => `${each}, `).join("")}begins ${said(begin)}${visit.closing && `, ${visit.closing}`}${punctual(visit, lasting)}; ${arrives}${waits}${waits && waitedFor(visit)}${rest}${tripOf(visits, at, said)}.`;
}

const waitedFor = ({ firsts }) => (firsts ? ` until ${firsts.join(" and ")} ${firsts.length > 1 ? "are" : "is"} done` : " for the window to open");
const called = ({ stop, customer }) => withCustomer(stop, customer);
const waited = (released, begin) => (released && released >= begin ? ", when its load is released" : "");

/** The sentence that a vehicle sets off later than its shift begins, and why; "" if it does not. */
export function departureNote(visits, said) {
  const shift = laterThanShift(visits[0], said);
  return shift && `Sets off ${departure(visits, said)}. The shift begins at ${shift}.`;
}

/** When a vehicle sets off, why if that is later than its shift begins, and when it is back. */
export function routeNote(visits, said) {
  const shift = laterThanShift(visits[0], said);
  const ends = `${visits.at(-1).kind === "end" ? "back" : "done"} at ${said(visits.at(-1).leaves)}.`;
  return shift ? `Sets off ${departure(visits, said)}; ${ends} The shift begins at ${shift}.` : `Sets off ${departure(visits, said)}, ${ends}`;
}

/** When the shift of a vehicle begins that sets off later; "" if none does. */
const laterThanShift = ({ shift, arrival }, said) => (arrival > shift && said(arrival) !== said(shift) ? said(shift) : "");

/** When a vehicle sets off, and what for, if it could do so earlier. */
function departure(visits, said) {
  const { arrival, released } = visits[0];
  const loaded = waited(released, arrival);
  const why = !loaded && laterThanShift(visits[0], said) ? reasonIn(visits, said) : "";
  return `at ${said(arrival)}${loaded}${why}`;
}

/**
 * Why a vehicle sets off when it does: as late as it can without being done later. If it still waits somewhere, the
 * stop is why that it must reach by then, before or where it waits; if not, the first that opens as its visit begins.
 */
function reasonIn(visits, said) {
  const waits = visits.findIndex(({ waiting }) => waiting);
  const before = waits < 0 ? visits : visits.slice(0, waits);
  const isAt = (time, by) => Number.isFinite(by) && said(time) === said(by);
  const closing = before.find(({ begin, by }) => isAt(begin, by)) ?? visits.slice(waits, waits + 1).find(({ arrival, by }) => isAt(arrival, by));
  if (closing && waits >= 0) return ` for ${called(closing)}, whose window closes at ${said(closing.closes)}${inHand(closing, said)}`;
  const opening = before.find(({ opens }) => opens !== undefined);
  return opening ? `, to be at ${called(opening)} when its window opens at ${said(opening.opens)}` : "";
}

/** That a stop must be reached before its window closes, if it must. */
const inHand = ({ closes, by }, said) => (by < closes ? ` and must be reached by ${said(by)}` : "");

/**
 * When a vehicle arrives, when the visit begins if that is later, the windows of the stop or when the visit is due, and how soon its
 * window closes, such as "12:13, waits until 13:00, window 13:00 to 15:00".
 */
export function arrivalIn({ arrival, begin, rests, closing, ...visit }, said) {
  const [arrives, begins] = [said(arrival), said(begin)];
  const later = arrives === begins ? "" : `${rests.length ? "begins" : "waits until"} ${begins}`;
  return [arrives, later, ...limitsOf(visit, said), closing].filter(Boolean).join(", ");
}

/** The windows of the stop of a visit, and when the visit is due, of those that are known. */
export function limitsOf({ windows, ...visit }, said) {
  const open = windows.length ? [`window ${spansIn(windows, said).join(" or ")}`] : [];
  return [...open, ...dueIn(visit, said)];
}

/** When a visit is due, in words, such as "due 10:00 to 10:30", in a list; none where it is not due. */
export function dueIn({ kind, wanted, due }, said) {
  if (kind !== "visit" || due === undefined) return [];
  return [`due ${wanted === undefined ? said(due) : spansIn([[wanted, due]], said)[0]}`];
}

/** Windows or breaks in words, such as "8:00 to 10:00". */
export const spansIn = (spans, said) => spans.map(([from, to]) => `${said(from)} to ${said(to)}`);

function punctual({ due, late, early }, lasting) {
  if (due === undefined) return "";
  if (early) return `, ${lasting(early)} early`;
  return late ? `, ${lasting(late)} late` : ", on time";
}

/** Why a late visit is late, if its vehicle had to wait for its load. */
function tripOf(visits, at, said) {
  const { begin, released } = visits.slice(0, at).findLast(({ kind }) => kind === "start" || kind === "loading") ?? {};
  return visits[at].late && released && released >= begin ? `; its load was released at ${said(released)}` : "";
}
