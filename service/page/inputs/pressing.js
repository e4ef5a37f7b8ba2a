/** Take typed text over when a button is clicked, not when it is pressed: the page would move it away. */

const buttonOf = ({ target }) => target.closest?.("button");

/** Has buttons take the focus when they are clicked. */
export function holdStill() {
  addEventListener("mousedown", (event) => buttonOf(event) && event.preventDefault());
  addEventListener("click", (event) => event.detail && buttonOf(event)?.focus({ preventScroll: true }), { capture: true });
}
