/** Links to a stored front, which carry the request that it answers: `#front=ID&request=...`. */

/** The link's fragment. The request is deflated, and in base64 as addresses may hold it. */
export async function fragment(id, request) {
  return `#front=${encodeURIComponent(id)}&request=${await packed(request)}`;
}

/** `{ id, request }` of a fragment, null where it names no front; the request may be missing. */
export async function linked(hash) {
  const members = new URLSearchParams(hash.slice(1));
  const id = members.get("front");
  if (!id) return null;
  const text = members.get("request");
  return { id, request: text ? await unpacked(text) : null };
}

async function packed(request) {
  const deflated = through(JSON.stringify(request), new CompressionStream("deflate-raw"));
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
    return null; // a link that was cut short still names its front
  }
}

const through = (data, stream) => new Response(new Blob([data]).stream().pipeThrough(stream));
