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
  const { stop, kind, arrival, begin, due, late, released } = visit;
  if (kind === "start") return `${stop}: ${name} leaves at ${said(arrival)}${waited(released, arrival)}.`;
  const arrives = `${name} arrives at ${said(arrival)}${from}`;
  if (kind === "end") return `${stop}: ${arrives}${late ? `, ${lasting(late)} after its shift ends at ${said(due)}` : " and is done"}.`;
  const waits = begin > arrival ? ` and waits ${lasting(begin - arrival)}` : "";
  if (kind === "loading") return `${stop}: ${name} loads again at ${said(begin)}${waited(released, begin)}; it arrives at ${said(arrival)}${from}${waits}.`;
  return `${stop}: ${asked(visit, said)}begins ${said(begin)}${punctual(visit, lasting)}; ${arrives}${waits}${waits && " for it to open"}${tripOf(visits, at, said)}.`;
}

const waited = (released, begin) => (released && released >= begin ? ", when its load is released" : "");

/** What the stop asks for: when it is open, and when a visit is due. */
function asked({ windows, due }, said) {
  const open = windows.map(([opens, closes]) => `${said(opens)} to ${said(closes)}`).join(" or ");
  return `${open && `open ${open}, `}${due === undefined ? "" : `due ${said(due)}, `}`;
}

function punctual({ due, late }, lasting) {
  if (due === undefined) return "";
  return late ? `, ${lasting(late)} late` : ", on time";
}

/** Why a late visit is late, if its vehicle had to wait for its load. */
function tripOf(visits, at, said) {
  const { begin, released } = visits.slice(0, at).findLast(({ kind }) => kind === "start" || kind === "loading") ?? {};
  return visits[at].late && released && released >= begin ? `; its load was released at ${said(released)}` : "";
}
