/** Keep what a tab shows while it is reloaded, or shows the guide: its stops, as in a link to its front. */

const NAME = "paretour-draft";

/** Keeps a link of this address, or null for nothing to keep. Returns false if the browser keeps nothing, or not so much. */
export function keepDraft(link) {
  try {
    sessionStorage.removeItem(NAME);
    if (link) sessionStorage.setItem(NAME, JSON.stringify({ ...link, hash: location.hash }));
    return true;
  } catch {
    return !link || Boolean(link.example); // an example is lost by nobody
  }
}

/** The link that this tab kept at this address; null without one. */
export function keptDraft() {
  try {
    const link = JSON.parse(sessionStorage.getItem(NAME));
    return link?.hash === location.hash ? link : null;
  } catch {
    return null; // browsers can be told to keep nothing
  }
}
