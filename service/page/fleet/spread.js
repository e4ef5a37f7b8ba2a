/** Read and write by how much the times of a fleet vary from day to day, and say how surely a plan is on time. */

const [PER_CENT, MOST] = [100, 1000]; // the most per cent that the service takes
const [SURE, NEARLY] = [99.95, 99]; // per cent: from there on a rounded number would say "all"

/** What the times of a request are measured by; null if it has none. */
const timesIn = ({ clock, objectives }) => (typeof clock === "string" ? objectives.find(({ name }) => name === clock) : clock) ?? null;

/** By how many per cent the time of each leg varies; null if it does not, undefined if the times are those of several days. */
export function variesBy(asked) {
  const { spread, days } = timesIn(asked) ?? {};
  if (days?.length) return undefined;
  return spread == null ? null : Number((PER_CENT * spread).toPrecision(6));
}

/** The request with times that vary by so many per cent; null is for not at all. */
export function varyingBy(asked, percent) {
  const times = timesIn(asked);
  const varying = (each) => {
    if (each !== times) return each;
    const { spread: _, ...others } = each;
    return percent === null ? others : { ...others, spread: percent / PER_CENT };
  };
  return { ...asked, objectives: asked.objectives.map(varying), ...(typeof asked.clock === "object" && asked.clock && { clock: varying(asked.clock) }) };
}

/** Per cent as they are typed, null for nothing; undefined if they are not understood, or too many. */
export function percentTyped(text) {
  if (!text.trim()) return null;
  const [, number] = /^(\d+(?:[.,]\d+)?)\s*%?$/.exec(text.trim()) ?? [];
  const percent = Number(number?.replace(",", "."));
  return percent <= MOST ? percent : undefined;
}

/** How surely a plan is on time, as a sentence; "" if its times do not vary, or nothing has to be on time. */
export function onTimeSaid({ measures }) {
  const share = PER_CENT * measures?.on_time;
  if (!(share >= 0)) return "";
  const said = share < SURE ? share.toFixed(share < NEARLY ? 0 : 1) : share < PER_CENT ? "more than 99.9" : "100";
  return ` On an average day, ${said} % of the visits with a window or a due time are on time.`;
}
