/** Say in one sentence when a vehicle visits a stop, and why it is late or waits there. */

/**
 * @param {{ name: string, visits: object[] }} lane the route of a vehicle, with what it does at each stop, by `visitTimes`
 * @param {number} at the place of the stop on it
 * @param {{ said: (time: number) => string, lasting: (time: number) => string }} clock puts times into words
 */
export function visitSentence({ name: named, visits }, at, { said, lasting }) {
  const visit = visits[at];
  const name = named.includes(", ") ? `${named},` : named; // with its shift
  const from = at ? ` from ${visits[at - 1].stop}` : "";
  const { stop, kind, arrival, begin, waiting, rests, due, late, released } = visit;
  if (kind === "start") {
    const shift = laterThanShift(visit, said);
    return `${stop}: ${name} ${leaving(visits, said)}${shift && `; its shift is from ${shift}`}.`;
  }
  const arrives = `${name} arrives at ${said(arrival)}${from}`;
  if (kind === "end") return `${stop}: ${arrives}${late ? `, ${lasting(late)} after its shift ends at ${said(due)}` : " and is done"}.`;
  const waits = waiting ? ` and waits ${lasting(waiting)}` : "";
  const rest = rests.length ? `; the driver has a break from ${spansIn(rests, said).join(" and from ")}` : "";
  if (kind === "loading") return `${stop}: ${name} loads again at ${said(begin)}${waited(released, begin)}; it arrives at ${said(arrival)}${from}${waits}${rest}.`;
  return `${stop}: ${asked(visit, said)}begins ${said(begin)}${visit.closing && `, ${visit.closing}`}${punctual(visit, lasting)}; ${arrives}${waits}${waits && " for it to open"}${rest}${tripOf(visits, at, said)}.`;
}

const waited = (released, begin) => (released && released >= begin ? ", when its load is released" : "");

/** The sentence that a vehicle leaves later than its shift begins, and why; "" if it does not. */
export function departureNote(visits, said) {
  const shift = laterThanShift(visits[0], said);
  return shift && `Shift from ${shift}; ${leaving(visits, said)}.`;
}

/** When the shift of a vehicle begins that leaves later; "" if none does. */
const laterThanShift = ({ shift, arrival }, said) => (arrival > shift && said(arrival) !== said(shift) ? said(shift) : "");

/**
 * When a vehicle leaves, and what for, if it could leave earlier: it would wait at the first stop that opens when it is visited.
 * That is not why if the vehicle waits all the same, there or before.
 */
function leaving(visits, said) {
  const { arrival, released } = visits[0];
  const loaded = waited(released, arrival);
  const opening = visits.find(({ opens, waiting }) => opens !== undefined || waiting);
  const inTime = opening && opening.opens !== undefined && !opening.waiting;
  const why = inTime && !loaded && laterThanShift(visits[0], said);
  return `leaves at ${said(arrival)}${loaded}${why ? `, to be at ${opening.stop} when it opens at ${said(opening.opens)}` : ""}`;
}

/** What the stop asks for: when it is open, and when a visit is due. */
function asked({ windows, due }, said) {
  return `${windows.length ? `open ${spansIn(windows, said).join(" or ")}, ` : ""}${due === undefined ? "" : `due ${said(due)}, `}`;
}

/** When a vehicle arrives, when the visit begins if that is later, and how soon its window closes, such as "12:13, waits until 13:00". */
export function arrivalIn({ arrival, begin, rests, closing }, said) {
  const [arrives, begins] = [said(arrival), said(begin)];
  const later = arrives === begins ? "" : `${rests.length ? "begins" : "waits until"} ${begins}`;
  return [arrives, later, closing].filter(Boolean).join(", ");
}

/** Windows or breaks in words, such as "8:00 to 10:00". */
export const spansIn = (spans, said) => spans.map(([from, to]) => `${said(from)} to ${said(to)}`);

function punctual({ due, late }, lasting) {
  if (due === undefined) return "";
  return late ? `, ${lasting(late)} late` : ", on time";
}

/** Why a late visit is late, if its vehicle had to wait for its load. */
function tripOf(visits, at, said) {
  const { begin, released } = visits.slice(0, at).findLast(({ kind }) => kind === "start" || kind === "loading") ?? {};
  return visits[at].late && released && released >= begin ? `; its load was released at ${said(released)}` : "";
}
