/** Plan a request in two steps: the network's front at once, then the improved one. On maps, and of fleets, in one. */

import { kindOf } from "../common/kinds.js";
import { Problem } from "./service.js";

const GLANCE = 300; // milliseconds between two requests for a growing front
const MOST_WAIT = 5; // seconds between two attempts
const MANY = 1500; // stops: for more, the network's front may take longer than a search
const REFUSED = Symbol("the network has no plan");
// Of very many stops, only the search finds plans.
const SEARCH_ALONE = ["no-plan", "too-many-for-network"];
const FINAL = ["done", "cancelled", "failed"];

/**
 * A front being planned. It yields states `{ stage, alone, answer, growth }`: the front of the
 * network alone, if it is known; the best front so far; and its growth, in rows of seconds and
 * hypervolume. Stages: "warming-up" (it waits for the search, with `compiling` if it is known how
 * far that is), "queued", "running", "done" and "cancelled".
 */
export class Planning {
  #service;
  #mostSeconds; // of a plan
  #left = new AbortController();
  #id = null; // the id of the job, while there is one
  #own = false; // whether the job was begun here
  #stopped = null; // the front when it was stopped

  constructor(service, mostSeconds) {
    this.#service = service;
    this.#mostSeconds = mostSeconds;
  }

  async *plan(request) {
    const { time_limit: seconds = 1 } = request.body;
    // For a draft, a map would be surveyed twice, which takes longer than the search needs for its first front; and fleets
    // with windows, shipments or breaks would be refused by the network, where the search has its first plan as soon.
    const { onGrid, movers } = kindOf(request.body);
    const isSearched = onGrid || movers || stopsIn(request.body) > MANY;
    // A time that is refused is refused before a draft is shown.
    if (!(seconds >= 0 && seconds <= this.#mostSeconds) || (seconds !== 0 && isSearched)) return yield* this.#improved(request, null);
    for await (const alone of this.#alone(request)) {
      if (alone === null) yield { stage: "warming-up", alone: null, answer: null };
      else if (request.body.time_limit === 0) yield { stage: "done", alone, answer: alone, growth: [] };
      else yield* this.#improved(request, alone === REFUSED ? null : alone);
    }
  }

  /** Yields null each time that the service is not warm yet, and then the network's front. */
  async *#alone(request) {
    const { initial_tours, bound, ...body } = request.body;
    // Where the search follows, the network's tours come soonest without repairs, which plans have not.
    const soonest = body.time_limit === 0 ? {} : { repairs: 0 };
    try {
      yield* this.#patiently({ path: request.path, body: { ...body, time_limit: 0, ...soonest } });
    } catch (error) {
      if (!SEARCH_ALONE.includes(error.code) || body.time_limit === 0) throw error;
      yield REFUSED;
    }
  }

  async *#improved(request, alone) {
    yield { stage: "running", alone, answer: alone, growth: [] };
    for await (const job of this.#patiently(request, { Prefer: "respond-async" })) {
      this.#own = true;
      if (job) yield* this.follow(job.id, alone);
      else yield { stage: "warming-up", alone, answer: alone, growth: [] };
    }
  }

  /** The front of the rest of a way, given what has changed since its front was planned. */
  async *replan(id, body) {
    for await (const answer of this.#patiently({ path: `front/${id}/replan`, body })) {
      if (answer) yield { stage: "done", alone: null, answer, growth: [] };
      else yield { stage: "warming-up", alone: null, answer: null };
    }
  }

  /** The states of a front that the service already has. */
  async *follow(id, alone = null) {
    this.#id = id;
    const growth = alone ? [[0, alone.hypervolume]] : [];
    try {
      yield* this.#followed(`front/${id}`, alone, growth);
    } catch (error) {
      if (error.code !== "unknown-front" || !this.#stopped) throw error;
      // It ended just before it was stopped, so stopping deleted it.
      this.#id = null;
      yield { stage: "cancelled", alone, answer: grown(alone, this.#stopped), growth };
    }
  }

  async *#followed(path, alone, growth) {
    let answer = await this.#service.get(path, this.#signal);
    while (!FINAL.includes(answer.status)) {
      let looked = performance.now();
      let compiling = null;
      for await (const [name, data] of this.#service.events(`${path}/events`, this.#signal)) {
        if (name === "progress" && data.hypervolume > 0) growth.push([data.seconds, data.hypervolume]);
        if (FINAL.includes(data.status)) break;
        if (name === "compiling") {
          compiling = data;
          yield { stage: "warming-up", compiling, alone, answer: alone, growth };
          continue;
        }
        if (performance.now() < looked + GLANCE) continue;
        answer = await this.#service.get(path, this.#signal);
        if (FINAL.includes(answer.status)) break; // before the stream says so
        looked = performance.now();
        if (answer.status === "queued" && compiling) continue; // what is said of it still holds
        yield { stage: answer.status, alone, answer: grown(alone, answer), growth };
      }
      answer = await this.#service.get(path, this.#signal);
      // A stream that ended before the job did was cut off somewhere between.
      if (!FINAL.includes(answer.status)) await pause(1, this.#signal);
    }
    this.#id = null;
    if (answer.status === "failed") throw new Problem(answer.problem);
    yield { stage: answer.status, alone, answer: grown(alone, answer), growth };
  }

  /** Ends the plan with the best front so far, or without a front before its job has begun. */
  async stop() {
    if (this.#id) await this.#end(`front/${this.#id}`);
    else this.#left.abort();
  }

  /** Ends a job. A finished job stays as it is: deleting it would delete its front. */
  async #end(path) {
    const answer = await this.#service.get(path);
    if (FINAL.includes(answer.status)) return;
    this.#stopped = answer;
    await this.#service.delete(path).catch((error) => {
      if (error.code !== "unknown-front") throw error;
    });
  }

  /** Stops following the front, and ends its job if it was begun here. */
  leave() {
    this.#left.abort();
    if (this.#id && this.#own) this.#end(`front/${this.#id}`).catch(() => {});
  }

  get left() {
    return this.#signal.aborted;
  }

  get #signal() {
    return this.#left.signal;
  }

  /** Yields null each time that the service is not warm yet, and then the answer to a request. */
  async *#patiently(request, headers) {
    for (;;) {
      try {
        yield await this.#service.post(request, this.#signal, headers);
        return;
      } catch (error) {
        if (error.code !== "warming-up") throw error;
        yield null;
        await pause(Math.min(error.retryAfter ?? 1, MOST_WAIT), this.#signal);
      }
    }
  }
}

/** Until the search has found something, the network's front is the best there is; null without either. */
const grown = (alone, answer) => {
  if (answer.front.length) return answer;
  return alone && { ...alone, id: answer.id, terminated: answer.terminated };
};

const stopsIn = ({ coordinates, stops, matrices }) => (coordinates ?? stops ?? matrices?.[0] ?? []).length;

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
