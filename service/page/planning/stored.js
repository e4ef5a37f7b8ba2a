/** Follow a front that the service already has, by a link to it. */

import { Problem } from "./service.js";

const GONE = ["unknown-front", "front-expired"];
const FORGOTTEN = "the service no longer has the result of this link, and the link does not say which stops to plan again: open them, and press Plan";

/**
 * The states of a stored front, as a planning yields them. If the service no longer has the front, the state
 * "kept" shows the tour of the link, if it `carried` one, among the points of its front. If not, the front is planned again, if the request is
 * known. A front without a search is the network's front.
 *
 * @param {{ request: object | null, searched: boolean, carried: object | null }} known the request, whether it asks
 *   for a search, and the answer with the tour of the link
 */
export async function* stored(planning, id, { request, searched, carried }) {
  try {
    for await (const state of planning.follow(id)) {
      yield searched ? state : { ...state, alone: state.answer, growth: [] };
    }
  } catch (error) {
    if (!GONE.includes(error.code)) throw error;
    const alone = carried?.among ? { front: carried.among.map((lengths) => ({ lengths })) } : null;
    if (carried) return yield { stage: "kept", alone, answer: carried, growth: [], again: Boolean(request) };
    if (!request) throw new Problem({ code: error.code, detail: FORGOTTEN });
    yield* planning.plan(request);
  }
}
