/** The style sheet's colours, for the canvases of charts and maps. */

const dark = matchMedia("(prefers-color-scheme: dark)");

const known = new Map();
dark.addEventListener("change", () => known.clear());

/** The colour of a name, cached: asking the browser in every frame would make it compute all styles. */
export function colour(name) {
  if (!known.has(name)) {
    known.set(name, getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim());
  }
  return known.get(name);
}

/** Red, green and blue, 0 to 255, of a colour that the style sheet writes as #rrggbb. */
export function rgb(name) {
  const [red, green, blue] = colour(name).match(/[0-9a-f]{2}/gi);
  return [red, green, blue].map((part) => parseInt(part, 16));
}

/** Calls back whenever the page turns from light to dark or back. */
export const onSchemeChange = (draw) => dark.addEventListener("change", draw);
