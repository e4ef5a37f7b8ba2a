/** Follow a front that the service already has, by a link to it. */

import { Problem } from "./service.js";

const GONE = ["unknown-front", "front-expired"];
const FORGOTTEN = "the service no longer has the front of this link, and the link does not say which stops to plan again: open them, and press Plan";

/**
 * The states of a stored front, as a planning yields them. If the service no longer has the front, it is
 * planned again if the request is known. A front without a search is the network's front.
 */
export async function* stored(planning, id, request, searched) {
  try {
    for await (const state of planning.follow(id)) {
      yield searched ? state : { ...state, alone: state.answer, growth: [] };
    }
  } catch (error) {
    if (!GONE.includes(error.code)) throw error;
    if (!request) throw new Problem({ code: error.code, detail: FORGOTTEN });
    yield* planning.plan(request);
  }
}
