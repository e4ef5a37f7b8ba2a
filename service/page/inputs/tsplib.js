/** Read a TSPLIB file: the coordinates or the costs of one objective. */

import { rounded } from "./distances.js";

const HEADINGS = ["NODE_COORD_SECTION", "EDGE_WEIGHT_SECTION", "DISPLAY_DATA_SECTION", "EOF"];

export const isTsplib = (text) => /^\s*(EDGE_WEIGHT_TYPE|NODE_COORD_SECTION)\b/m.test(text);

/**
 * What two files about the same cities ask for, the first objective's first: distances that are
 * rounded, by the definition of EUC_2D, or two matrices where a file gives costs.
 */
export function pair(texts) {
  const planes = texts.map(said);
  const [one, other] = planes.map(({ rows }) => rows.length);
  if (one !== other) throw new Error(`two TSPLIB files must have as many cities, got ${one} and ${other}`);
  if (planes.every(({ placed }) => placed)) {
    const [first, second] = planes;
    return { coordinates: first.rows.map((place, city) => [...place, ...second.rows[city]]), rounded: true };
  }
  return { matrices: planes.map(({ placed, rows }) => (placed ? rounded(rows) : rows)) };
}

/** Rows of one file: places in a plane, or costs. */
function said({ name, text }) {
  const { facts, sections } = parsed(text);
  const kind = facts.EDGE_WEIGHT_TYPE ?? "nothing";
  const way = facts.EDGE_WEIGHT_FORMAT ?? "nothing";
  const cities = facts.DIMENSION ?? "nothing";
  if (!/^\d+$/.test(cities)) throw new Error(`DIMENSION of ${name} must be a whole number, got ${cities}`);
  const rowsOf = (section, width) => table(`${section} of ${name}`, sections[section], Number(cities), width);
  if (kind === "EUC_2D") {
    return { placed: true, rows: rowsOf("NODE_COORD_SECTION", 3).map(([, x, y]) => [x, y]) };
  }
  if (kind === "EXPLICIT" && way === "FULL_MATRIX") {
    return { placed: false, rows: rowsOf("EDGE_WEIGHT_SECTION", Number(cities)) };
  }
  const demand = "must be EUC_2D, or EXPLICIT with EDGE_WEIGHT_FORMAT FULL_MATRIX";
  throw new Error(`EDGE_WEIGHT_TYPE of ${name} ${demand}, got ${kind} with ${way}`);
}

/** What stands before the sections, and the words of each. */
function parsed(text) {
  const facts = {};
  const sections = {};
  let words = null; // of the section that a line is in
  for (const line of text.split(/\r?\n/).map((each) => each.trim())) {
    if (HEADINGS.includes(line)) words = sections[line] ??= [];
    else if (words) words.push(...(line.match(/\S+/g) ?? []));
    else if (line.includes(":")) facts[line.split(":", 1)[0].trim()] = line.slice(line.indexOf(":") + 1).trim();
  }
  return { facts, sections };
}

function table(name, words = [], height, width) {
  if (words.length !== height * width) {
    const demand = `${height} rows of ${width} numbers, as DIMENSION says`;
    throw new Error(`${name} must have ${demand}, got ${words.length} numbers`);
  }
  const wrong = words.find((word) => !Number.isFinite(Number(word)));
  if (wrong !== undefined) throw new Error(`${name} must hold numbers, got "${wrong.slice(0, 60)}"`);
  return Array.from({ length: height }, (_, row) => words.slice(row * width, (row + 1) * width).map(Number));
}
