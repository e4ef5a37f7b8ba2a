/** Follow a front that the service has already, by a link to it. */

const GONE = ["unknown-front", "front-expired"];

/**
 * The states of a stored front, as a planning yields them. One that the service has no more is
 * planned again, where the request is known; of one that no search was to improve, the network's is
 * all there is.
 */
export async function* stored(planning, id, request, searched) {
  try {
    for await (const state of planning.follow(id)) {
      yield searched ? state : { ...state, alone: state.answer, growth: [] };
    }
  } catch (error) {
    if (!request || !GONE.includes(error.code)) throw error;
    yield* planning.plan(request);
  }
}
