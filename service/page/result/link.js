/** Write and read links to a front: `#front=ID&balance=B&asked=...`, with the request and the selected tour. */

const MOST = 16000; // characters, beyond which chats, mail and some servers cut addresses off

/**
 * The fragment of a link to a front.
 *
 * @param {string} id of the front
 * @param {number | undefined} balance of the selected tour
 * @param {{ request?: object, objectives: object[], limits?: (number | null)[], chosen: object }} asked the request, unless
 *   it is that of the example or not known; the names of the objectives; the limits on three or more of them; and the
 *   selected tour or plan, as of `chosenOf`
 * @param {string | null} example the file of the example
 * @returns {Promise<{ hash: string, whole: boolean }>} `whole` says whether the request was short enough; the
 *   selected tour is left out only if it alone is too long
 */
export async function fragment(id, balance, asked, example = null) {
  const front = `#front=${encodeURIComponent(id)}${balance === undefined ? "" : `&balance=${Number(balance.toFixed(6))}`}`;
  const { request, ...alone } = asked;
  const text = await packed(asked);
  const whole = text.length <= MOST;
  const shorter = whole || !request ? text : await packed(alone);
  const carried = shorter.length <= MOST ? `&asked=${shorter}` : "";
  return { hash: `${front}${carried}${example ? `&example=${encodeURIComponent(example)}` : ""}`, whole };
}

/** `{ id, balance, asked, example }` of a fragment, null where it names no front; the others may be missing. */
export async function linked(hash) {
  const members = new URLSearchParams(hash.slice(1));
  const id = members.get("front");
  if (!id) return null;
  const text = members.get("asked");
  const balance = Number(members.get("balance") ?? NaN);
  const asked = text && text.length <= MOST ? await unpacked(text) : null;
  return { id, balance: balance >= 0 && balance <= 1 ? balance : undefined, asked, example: members.get("example") };
}

async function packed(asked) {
  const deflated = through(JSON.stringify(asked), new CompressionStream("deflate-raw"));
  const bytes = new Uint8Array(await deflated.arrayBuffer());
  const text = Array.from(bytes, (byte) => String.fromCharCode(byte)).join("");
  return btoa(text).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}

async function unpacked(text) {
  try {
    const deflated = atob(text.replaceAll("-", "+").replaceAll("_", "/"));
    const bytes = Uint8Array.from(deflated, (character) => character.charCodeAt(0));
    return await through(bytes, new DecompressionStream("deflate-raw")).json();
  } catch {
    return null; // a truncated link still names its front
  }
}

const through = (data, stream) => new Response(new Blob([data]).stream().pipeThrough(stream));
