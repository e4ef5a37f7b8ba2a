/** From a request to its front: first the network's alone, then the one that the search improves. */

const MOST_WAIT = 5; // seconds between two attempts

/**
 * What there is to show, as it comes: `{ stage, alone, answer }`.
 *
 * `alone` is the front of the network, `answer` the best so far. Stages: "warming-up", where the
 * search is not compiled yet, "improving", and "done".
 */
export async function* plan(service, request, signal) {
  const { initial_tours, bound, ...body } = request.body;
  const alone = await service.post(request.path, { ...body, time_limit: 0 }, signal);
  if (request.body.time_limit === 0) {
    yield { stage: "done", alone, answer: alone };
    return;
  }
  yield { stage: "improving", alone, answer: alone };
  for (;;) {
    try {
      const answer = await service.post(request.path, request.body, signal);
      yield { stage: "done", alone, answer };
      return;
    } catch (error) {
      if (error.code !== "warming-up") throw error;
      yield { stage: "warming-up", alone, answer: alone };
      await pause(Math.min(error.retryAfter ?? 1, MOST_WAIT), signal);
    }
  }
}

function pause(seconds, signal) {
  return new Promise((resolve, reject) => {
    const timer = setTimeout(resolve, 1000 * seconds);
    const abort = () => {
      clearTimeout(timer);
      reject(signal.reason);
    };
    signal.addEventListener("abort", abort, { once: true });
  });
}
