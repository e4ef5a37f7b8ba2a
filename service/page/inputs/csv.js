/** Parse CSV: separated by commas, or by semicolons or tabs, beside which commas are decimal points. */

const COMMENT = /^\s*#/;

/**
 * The heading in lower case, empty where there is none, and the rows below it, all as text. Lines
 * without any separator are split where there is white space.
 */
export function parseTable(text) {
  const lines = text.replace(/^\ufeff/, "").split(/\r?\n/).filter((line) => line.trim() && !COMMENT.test(line));
  const first = lines[0] ?? "";
  const separator = [";", "\t", ","].find((each) => first.includes(each)) ?? " ";
  const rows = lines.map((line) => fieldsOf(line, separator).map((field) => dotted(field, separator)));
  const headed = rows.length > 0 && !rows[0].slice(rows[0].length > 1 ? 1 : 0).some(isNumber) && !isNumber(rows[0][0]);
  return { heading: headed ? rows.shift().map((field) => field.toLowerCase()) : [], rows };
}

export const isNumber = (field) => field !== "" && Number.isFinite(Number(field));

/** The fields of a line, without the quotation marks around them. */
function fieldsOf(line, separator) {
  if (separator === " ") return line.trim().split(/\s+/);
  const fields = [];
  let field = "";
  let quoted = false;
  for (const character of `${line}${separator}`) {
    if (character === '"') quoted = !quoted;
    if (character === separator && !quoted) {
      fields.push(unquoted(field.trim()));
      field = "";
    } else field += character;
  }
  return quoted ? [...fields, unquoted(field.slice(0, -1).trim())] : fields;
}

const unquoted = (field) => (/^".*"$/.test(field) ? field.slice(1, -1).replaceAll('""', '"') : field);

/** With a point for a decimal comma. */
const dotted = (field, separator) =>
  separator !== "," && /^[-+]?\d*,\d+(e[-+]?\d+)?$/i.test(field) ? field.replace(",", ".") : field;
