/** Cities as text: a row of four numbers on each line. */

export const textOf = (rows) => rows.map((row) => row.join(", ")).join("\n");

/** Whether the row can be drawn. */
export const isCity = (row) => row.length === 4 && row.every(Number.isFinite);
