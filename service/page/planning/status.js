/** Say what the page is doing, and with which result. */

import { kindNamed } from "../common/kinds.js";
import { counted } from "../common/numbers.js";

const element = (id) => document.getElementById(id);

const SAID = {
  queued: "This is a quick first result: the search waits for its turn.",
  running: "The search is improving a quick first result.",
};

/** Says a text only once in a row: screen readers read each change. */
export function say(text) {
  if (element("status").textContent === text) return;
  element("status").textContent = element("waiting").textContent = text;
}

// If the network has no front to show.
const SEARCH_ALONE = { queued: "The search waits for its turn.", running: "The search is running." };
export const SURVEY = "The paths between the places of the map are being found.";

/** The sentence for a state of a planning; on a map, its search begins with a survey. */
export const sentence = (state, onMap = false) =>
  (onMap && state.stage === "running" && !state.answer && SURVEY) ||
  (state.stage === "kept" && `This is the ${kindNamed(state.answer).noun.one} of the link.`) ||
  (state.stage === "warming-up" && warmingUp(state)) ||
  (!state.alone && SEARCH_ALONE[state.stage]) || SAID[state.stage] || ended(state);

function warmingUp({ compiling, alone }) {
  const far = compiling
    ? `: ${Math.round(100 * compiling.share)} %, about ${Math.ceil(compiling.seconds_left)} s left`
    : "";
  const shown = alone ? "This is a quick first result" : "A quick first result is shown as soon as there is one";
  return `The search is being compiled, once${far}. ${shown}, and it improves by itself.`;
}

function ended({ stage, answer }) {
  if (!answer) return "Stopped before anything was found.";
  const { front, points } = answer;
  const { one, many } = kindNamed(answer).noun;
  const found = `${counted(points, one, many)} found`;
  const shown = front.length < points ? `, the best ${front.length} of them shown` : "";
  return [`${stage === "cancelled" ? "Stopped" : "Done"}: ${found}${shown}.`, ...doubts(answer)].join(" ");
}

/** The notes on the request, but for those on the file, which are shown already. */
function doubts({ notes = [] }) {
  const shown = element("file-notes").textContent;
  return notes.map(({ text }) => text).filter((text) => !shown.includes(text));
}
