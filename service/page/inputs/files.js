/** Read the files that people open or drop into the members of a request. */

import { membersOfTable, membersOfTables } from "./columns.js";
import { isCollection, stopsOf } from "./geojson.js";
import { OBJECTIVES, coverageOf, isOfMap, withoutMessage } from "./maps/map_request.js";
import { namesIn } from "../common/objectives.js";
import { isTsplib, pair } from "./tsplib.js";

/**
 * The members of a request that the files say, and what its objectives are called. A file that
 * cannot be read is an Error.
 */
export async function read(files) {
  if (files.some(isOfMap)) return { members: await coverageOf(files), objectives: OBJECTIVES };
  return request(await textsOf(files));
}

/** The same of text that was pasted. */
export const readPasted = (text) => request([{ name: "what was pasted", text }]);

/** Whether text is a request or a table with a heading, and no rows of cities alone. */
export const isRequest = (text) => /^\s*{/.test(text) || /^\s*[a-z"][^\n]*[,;\t][^\n]*\n/i.test(text);

function request(texts) {
  const members = membersOf(texts);
  return { members, objectives: namesIn(members) };
}

async function textsOf(files) {
  const texts = await Promise.all(
    [...files].map(async (file) => ({ name: file.name, text: await file.text() })),
  );
  return texts.sort((one, other) => (one.name < other.name ? -1 : 1));
}

function membersOf(texts) {
  if (texts.length > 2) throw new Error(`one file is wanted, or two with an objective each, got ${texts.length}`);
  if (texts.length === 2) return texts.some(({ text }) => isTsplib(text)) ? pair(texts) : membersOfTables(texts);
  const [{ name, text }] = texts;
  if (isTsplib(text)) throw new Error(`${name} is one plane: open it together with the other`);
  return /^\s*[[{]/.test(text) ? parsed(name, text) : membersOfTable({ name, text });
}

function parsed(name, text) {
  let given;
  try {
    given = JSON.parse(text);
  } catch (error) {
    throw new Error(`${name} must be JSON, and is not: ${error.message}`);
  }
  if (isCollection(given)) return stopsOf(name, given);
  return drawable(name, Array.isArray(given) ? { coordinates: given } : withoutMessage(name, given));
}

/** The members, of which those that are drawn are rows; all else is for the service to check. */
function drawable(name, members) {
  const { coordinates, grid, cost_layer, stops, vehicles, robots } = members ?? {};
  if (!members || typeof members !== "object") throw new Error(`${name} must be a request, got ${members}`);
  for (const [member, items] of Object.entries({ stops, vehicles, robots })) {
    if (items != null && !isObjects(items)) throw new Error(`${member} of ${name} must be a list of objects`);
  }
  for (const [member, rows] of Object.entries({ coordinates, grid, cost_layer })) {
    if (rows != null && !isRows(rows)) throw new Error(`${member} of ${name} must be rows of numbers`);
  }
  if (grid && !grid[0]?.length) throw new Error(`grid of ${name} must have a cell or more, got none`);
  if (grid && cost_layer && cost_layer.length !== grid.length) {
    const came = `${cost_layer.length} and ${grid.length}`;
    throw new Error(`cost_layer and grid of ${name} must have as many rows, got ${came}`);
  }
  return members;
}

const isObjects = (value) => Array.isArray(value) && value.every((each) => each && typeof each === "object");
const isRows = (value) => Array.isArray(value) && value.every(Array.isArray);
