/** The style sheet's colours, for what is drawn on a canvas. */

const dark = matchMedia("(prefers-color-scheme: dark)");

export const colour = (name) =>
  getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

/** Calls back whenever the page turns from light to dark or back. */
export const onSchemeChange = (draw) => dark.addEventListener("change", draw);
