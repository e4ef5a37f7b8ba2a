/** Remember in this browser what every dispatcher has, for the next file. */

const NAME = "paretour-everyday";
const isNumbers = (value, count) => Array.isArray(value) && value.length === count && value.every(Number.isFinite);

export function remember(everyday) {
  try {
    localStorage.setItem(NAME, JSON.stringify(everyday));
  } catch {
    // Browsers can be told to keep nothing: then it is asked again.
  }
}

/** What is remembered, of which all or some may be missing. */
export function remembered() {
  try {
    return sound(JSON.parse(localStorage.getItem(NAME)) ?? {});
  } catch {
    return {};
  }
}

/** Other versions of the page may have written it. */
const sound = ({ depot, service, shift, speed, reload }) => ({
  ...(typeof depot?.id === "string" && isNumbers(depot.location, 2) && { depot }),
  ...(service >= 0 && { service }),
  ...(isNumbers(shift, 2) && { shift }),
  ...(speed > 0 && { speed }),
  reload: reload === true,
});
