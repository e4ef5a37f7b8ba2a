/** Place form and result beside each other, or on a narrow window one above the other. */

export const narrow = matchMedia("(max-width: 860px)");

/** On a narrow window, moves the result to the top while one is `wanted` or already there. */
export function arrange(form, result, wanted) {
  const main = form.parentElement;
  const above = main.firstElementChild === result;
  const moved = narrow.matches && Boolean(above || wanted);
  if (moved !== above) main[moved ? "prepend" : "append"](result); // moved, it loses the focus
}
