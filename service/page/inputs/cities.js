/** Cities as text: a row of four numbers on each line. */

/** The rows. What is no number stays as it is, for the service to name. */
export function rowsOf(text) {
  const lines = text.split(/\r?\n/).filter((line) => line.trim());
  return lines.map((line) => line.trim().split(/\s*[,;\t]\s*|\s+/).map(cell));
}

export const textOf = (rows) => rows.map((row) => row.join(", ")).join("\n");

/** Whether the row can be drawn. */
export const isCity = (row) => row.length === 4 && row.every(Number.isFinite);

function cell(text) {
  const number = Number(text);
  return text === "" || Number.isNaN(number) ? text : number;
}
