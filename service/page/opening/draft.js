/** Keep what a tab shows while it is reloaded, or shows the guide: its stops, as in a link to its front. */

const NAME = "paretour-draft";

/** Keeps a link of this address, or null for nothing to keep. Returns false if it is too long for the browser's storage. */
export function keepDraft(link) {
  sessionStorage.removeItem(NAME);
  try {
    if (link) sessionStorage.setItem(NAME, JSON.stringify({ ...link, hash: location.hash }));
    return true;
  } catch {
    return false;
  }
}

/** The link that this tab kept at this address; null without one. */
export function keptDraft() {
  const link = JSON.parse(sessionStorage.getItem(NAME));
  return link?.hash === location.hash ? link : null;
}
