/** Take what was typed over with the click on a button, not before: a page that changes in between moves the button away. */

const buttonOf = ({ target }) => target.closest?.("button");

/** From now on, buttons take the focus from a field when they are clicked, and not when the mouse is pressed. */
export function holdStill() {
  addEventListener("mousedown", (event) => {
    if (buttonOf(event)) event.preventDefault();
  });
  addEventListener("click", (event) => event.detail && buttonOf(event)?.focus({ preventScroll: true }), { capture: true });
}
