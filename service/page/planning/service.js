/** Call the service over HTTP, and follow its events. */

import { EventStream } from "./event_stream.js";

/** An error of the service, or that it did not answer. */
export class Problem extends Error {
  constructor({ code, detail, errors = [], columns, choices, wrong_cells: wrongCells }, retryAfter = null) {
    super(detail);
    Object.assign(this, { columns, choices, wrongCells }); // of files that cannot be read
    this.code = code;
    this.errors = errors;
    this.retryAfter = retryAfter; // seconds
  }
}

export class Service {
  /** @param {() => string} key the caller's API key, empty if there is none */
  constructor(key) {
    this.key = key;
  }

  async get(path, signal) {
    return content(await this.ask(path, { signal }));
  }

  /** The answer to a request; with `Prefer: respond-async` among the headers, that of its job. */
  async post({ path, body }, signal, headers = {}) {
    const options = { method: "POST", body: JSON.stringify(body), signal };
    options.headers = { "Content-Type": "application/json", ...headers };
    return content(await this.ask(path, options));
  }

  /** The request made from files, with notes on what was assumed. */
  async read(files, signal, columns = []) {
    const body = new FormData();
    for (const file of files) body.append("file", file);
    if (columns.length) body.append("columns", JSON.stringify(columns));
    return content(await this.ask("files", { method: "POST", body, signal }));
  }

  async delete(path) {
    await this.ask(path, { method: "DELETE" });
  }

  /** The events of a stream as `[name, data]`, until it ends or breaks. */
  async *events(path, signal) {
    const response = await this.ask(path, { signal });
    const events = response.body
      .pipeThrough(new TextDecoderStream())
      .pipeThrough(new EventStream());
    const reader = events.getReader();
    try {
      for (;;) {
        const { done, value } = await reader.read().catch(broken);
        if (done) return;
        yield [value.event, JSON.parse(value.data)];
      }
    } finally {
      reader.cancel().catch(() => {});
    }
  }

  /** The response if it is a success; throws a Problem otherwise. */
  async ask(path, options = {}) {
    const headers = { ...options.headers };
    if (this.key()) headers.Authorization = `Bearer ${this.key()}`;
    const response = await reached(path, { ...options, headers });
    if (!response.ok) throw await problem(response);
    return response;
  }
}

/** The JSON of an answer. A page of a proxy, such as one for signing in, is not an answer of the service. */
async function content(response) {
  const text = await whole(response.text());
  try {
    return JSON.parse(text);
  } catch {
    throw unexplained(response);
  }
}

/** A lost connection ends a stream like any other end; leaving the stream is an AbortError. */
function broken(error) {
  if (error.name === "AbortError") throw error;
  return { done: true };
}

const reached = (path, options) => whole(fetch(path, options));

/** A response, or its text, unless the network fails. */
async function whole(arriving) {
  try {
    return await arriving;
  } catch (error) {
    if (error.name === "AbortError") throw error;
    throw new Problem({ code: "unreachable", detail: "the service does not answer" });
  }
}

async function problem(response) {
  const seconds = Number(response.headers.get("Retry-After")) || null;
  const type = response.headers.get("Content-Type") ?? "";
  if (type.startsWith("application/problem+json")) return new Problem(await content(response), seconds);
  return unexplained(response, seconds);
}

const unexplained = ({ status }, seconds) =>
  new Problem({ code: "unexplained", detail: `the service answered ${status} without saying why` }, seconds);
