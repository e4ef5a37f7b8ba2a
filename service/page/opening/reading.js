/** Have the service read files, and text that is pasted as a file would be. */

import { namesIn } from "../common/objectives.js";
import { inRows } from "../inputs/instance.js";
import { proposed } from "../inputs/map_proposal.js";

/** What the form opens, the names of its objectives, and the file's name with what was taken for granted. */
export async function read(service, files) {
  const sorted = files.toSorted((one, other) => (one.name < other.name ? -1 : 1)); // as file dialogs have no order
  const { request, planes, name, notes } = await service.read(sorted);
  const { matrices, ...others } = request;
  // The form rounds distances itself, so that planes stay planes.
  const members = planes ? { ...others, coordinates: planes, rounded: true } : proposed(inRows(request));
  return { members, objectives: namesIn(members), name, notes };
}

/** The file of text that is pasted; null for rows of numbers, and for a name or a number for a field. */
export function pastedFile(text) {
  const [first, ...others] = text.trim().split("\n");
  const isFile = /^[{[]/.test(first) || (others.length && /[^-+\d.,;e\s]/i.test(first));
  return isFile ? new File([text], "pasted text") : null;
}
