/** The service, as this page asks it. */

/** Why the service refused, or that it did not answer at all. */
export class Problem extends Error {
  constructor({ code, detail, errors = [] }, retryAfter = null) {
    super(detail);
    this.code = code;
    this.errors = errors;
    this.retryAfter = retryAfter; // seconds
  }
}

export class Service {
  /** @param {() => string} key the caller's API key, empty where there is none */
  constructor(key) {
    this.key = key;
  }

  async get(path, signal) {
    return (await this.ask(path, { signal })).json();
  }

  async post(path, body, signal) {
    const headers = { "Content-Type": "application/json" };
    const options = { method: "POST", headers, body: JSON.stringify(body), signal };
    return (await this.ask(path, options)).json();
  }

  /** The response, where it is one of success; a Problem is thrown otherwise. */
  async ask(path, options = {}) {
    const headers = { ...options.headers };
    if (this.key()) headers.Authorization = `Bearer ${this.key()}`;
    const response = await reached(path, { ...options, headers });
    if (!response.ok) throw await problem(response);
    return response;
  }
}

async function reached(path, options) {
  try {
    return await fetch(path, options);
  } catch (error) {
    if (error.name === "AbortError") throw error;
    throw new Problem({ code: "unreachable", detail: "the service does not answer" });
  }
}

async function problem(response) {
  const seconds = Number(response.headers.get("Retry-After")) || null;
  const type = response.headers.get("Content-Type") ?? "";
  if (type.startsWith("application/problem+json")) return new Problem(await response.json(), seconds);
  const detail = `the service answered ${response.status} without saying why`;
  return new Problem({ code: "unexplained", detail }, seconds);
}
