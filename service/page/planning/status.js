/** Say what the page is doing, and with which result. */

import { kindNamed } from "../common/kinds.js";
import { counted } from "../common/numbers.js";

const element = (id) => document.getElementById(id);

const SAID = {
  "warming-up":
    "The search is being compiled, once, for about a minute. The network’s front is shown as soon as there is one, and improves by itself.",
  queued: "This is the network’s front; the search waits for its turn.",
  running: "The search is improving the network’s front.",
};

/** Says a text only once in a row: screen readers read each change. */
export function say(text) {
  if (element("status").textContent === text) return;
  element("status").textContent = element("waiting").textContent = text;
}

// If the network has no front to show.
const SEARCH_ALONE = { queued: "The search waits for its turn.", running: "The search is running." };

/** The sentence for a state of a planning. */
export const sentence = (state) =>
  (!state.alone && SEARCH_ALONE[state.stage]) || SAID[state.stage] || ended(state);

function ended({ stage, answer }) {
  if (!answer) return "Stopped before anything was found.";
  const { front, points } = answer;
  const { one, many } = kindNamed(answer).noun;
  const found = `${counted(points, one, many)} found`;
  const shown = front.length < points ? `, the best ${front.length} of them shown` : "";
  return `${stage === "cancelled" ? "Stopped" : "Done"}: ${found}${shown}.`;
}
