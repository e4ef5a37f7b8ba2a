/** Links to a stored front with the selected tour and what was asked for: `#front=ID&balance=B&asked=...`. */

const MOST = 16000; // characters, beyond which chats, mail and some servers cut addresses off

/**
 * The link's fragment, with the file of the example, or with the request, deflated and in base64 for
 * addresses. `whole` says whether the request was short enough to be in it.
 */
export async function fragment(id, balance, asked, example = null) {
  const front = `#front=${encodeURIComponent(id)}${balance === undefined ? "" : `&balance=${Number(balance.toFixed(6))}`}`;
  if (example) return { hash: `${front}&example=${encodeURIComponent(example)}`, whole: true };
  if (!asked) return { hash: front, whole: false };
  const text = await packed(asked);
  const whole = text.length <= MOST;
  return { hash: whole ? `${front}&asked=${text}` : front, whole };
}

/** `{ id, balance, asked, example }` of a fragment, null where it names no front; the others may be missing. */
export async function linked(hash) {
  const members = new URLSearchParams(hash.slice(1));
  const id = members.get("front");
  if (!id) return null;
  const text = members.get("asked");
  const balance = Number(members.get("balance") ?? NaN);
  const asked = text ? await unpacked(text) : null;
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
