/** Fill several cells of a table at once: with pasted cells of a spreadsheet, or with copies of one cell below it. */

const SEPARATED = /[^,;]*([,;])[^,;]*\1/; // at least three fields

/**
 * The cells of a pasted text, in rows; null for the text of a single cell, and for a table of its own, which is opened as a file.
 *
 * @param {string} text as a spreadsheet copies it, with tabs between columns
 * @param {number} room how many columns there are from the cell on
 */
export function blockOf(text, room) {
  const rows = text.replace(/\r?\n$/, "").split(/\r?\n/).map((line) => line.split("\t"));
  const width = Math.max(...rows.map((row) => row.length));
  const isTable = width === 1 && rows.every(([line]) => SEPARATED.test(line)) && /[a-z]/i.test(rows[0][0]);
  if (width * rows.length < 2 || width > room || isTable || /^\s*[{[]/.test(text)) return null;
  return rows;
}

/** The cells from this one on, each `{ row, column, text }`, with the texts of a block; what has no row is left out. */
export const cellsOf = (block, row, column, count) =>
  block.slice(0, Math.max(count - row, 0)).flatMap((texts, down) => texts.map((text, right) => ({ row: row + down, column: column + right, text: text.trim() })));

/** What is said of cells that were filled. */
export function filledSaid(cells, left) {
  const rest = left ? ` ${left === 1 ? "1 row was" : `${left} rows were`} left out: the table ends there.` : "";
  return `${cells === 1 ? "1 cell was" : `${cells} cells were`} filled.${rest} Undo takes that back.`;
}
