/** Names and units of the two objectives. */

export const UNNAMED = [
  { name: "length 1", unit: "" },
  { name: "length 2", unit: "" },
];

export const titled = ({ name }) => name[0].toUpperCase() + name.slice(1);

/** The title with its unit, where there is room for that. */
export const withUnit = (objective) =>
  objective.unit && objective.unit.length < 10 ? `${titled(objective)}, ${objective.unit}` : titled(objective);
