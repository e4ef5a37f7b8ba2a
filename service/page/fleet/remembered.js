/** Remember in this browser what every dispatcher has, for the next file. */

const NAME = "paretour-everyday";
const isPair = (value) => value?.length === 2 && value.every(Number.isFinite);

export function remember(everyday) {
  try {
    localStorage.setItem(NAME, JSON.stringify(everyday));
  } catch {
    // Browsers can be told to keep nothing: then it is asked again.
  }
}

/** What is remembered, of which all or some may be missing. Another version of the page may have written it. */
export function remembered() {
  try {
    const { depot, shift, ...others } = JSON.parse(localStorage.getItem(NAME));
    return { ...others, ...(depot?.id && isPair(depot.location) && { depot }), ...(isPair(shift) && { shift }) };
  } catch {
    return {};
  }
}
