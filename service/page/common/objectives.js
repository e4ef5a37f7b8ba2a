/** Names and units of the two objectives. */

export const UNNAMED = [
  { name: "length 1", unit: "" },
  { name: "length 2", unit: "" },
];

/** The names in a request or an answer; UNNAMED if it has none. */
export function namesIn({ objectives }) {
  const named = objectives?.length === 2 && objectives.every((each) => each?.name && typeof each.name === "string");
  return named ? objectives.map(({ name, unit }) => ({ name, unit: typeof unit === "string" ? unit : "" })) : UNNAMED;
}

export const titled = ({ name }) => name[0].toUpperCase() + name.slice(1);

/** The unit, if it is short enough to stand beside a number. */
export const shortUnit = ({ unit }) => (unit && unit.length < 10 ? unit : "");

/** The title with its unit, if there is room for that. */
export const withUnit = (objective) =>
  shortUnit(objective) ? `${titled(objective)}, ${objective.unit}` : titled(objective);
