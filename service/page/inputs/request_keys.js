/** Tell whether requests are the same, writing each of them as text only once. */

import { SETTINGS } from "./fields.js";
import { keyOf, without } from "./instance.js";

const known = new WeakMap(); // the keys of requests, which never change

/** Two texts of a request: `planned` is that of all that is planned, without details, and `brought` of all but the settings. */
export function keysOf(request) {
  if (!known.has(request)) known.set(request, written(request));
  return known.get(request);
}

function written({ details, ...planned }) {
  const stops = keyOf(without(planned, ...SETTINGS));
  const settings = Object.fromEntries(SETTINGS.map((name) => [name, planned[name]]));
  return { planned: stops + JSON.stringify(settings), brought: stops + JSON.stringify(details) };
}
