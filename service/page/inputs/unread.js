/** Keep what was typed and cannot be taken out of the request: its field is invalid, and says why, until something else is typed. */

import { tellFault } from "../planning/faults.js";
import { Problem } from "../planning/service.js";

const INVALID = "input:invalid, textarea:invalid";

/** Returns whether what was typed can be taken; if not, its field says the fault. */
export function isRead(field, readable, fault) {
  field.setCustomValidity(readable ? "" : fault);
  if (!readable) {
    field.setAttribute("aria-invalid", "true");
    tellFault(pointerOf(field).split("/")[1], fault);
  }
  return readable;
}

/** The fault of the first of these fields of a form; null if there is none. */
export function firstFault(form) {
  const field = form.querySelector(INVALID);
  return field && new Problem({ detail: field.validationMessage, errors: [{ pointer: pointerOf(field) }] });
}

/** Reads all of these fields of a form again, as other fields have changed; those that cannot be taken say their faults again. */
export function readAgain(form) {
  for (const field of form.querySelectorAll(INVALID)) field.dispatchEvent(new Event("change", { bubbles: true }));
}

/** The member of a request that a field is about. */
function pointerOf(field) {
  const { row, members, axis, member } = field.dataset;
  if (row) return `/${field.closest(".stops").id}/${row}/${members}`;
  return axis ? `/objectives/${axis}/${member}` : `/${field.id}`;
}
