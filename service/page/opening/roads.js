/** Say before planning that a request needs a routing engine, and that the service has none. */

const MISSING = "This service has no routing engine for costs by road";

/** The answer with straight lines if the reader chose roads; with a note if the file itself asks for roads. */
export function withoutRoads(answer) {
  const { request, notes, name: file } = answer;
  const asked = request.objectives?.filter?.(isRoad) ?? [];
  if (!asked.length) return answer;
  const chosen = notes.find(({ code }) => code === "objectives");
  if (!chosen) {
    const names = asked.map(({ name }) => `“${name}”`).join(" and ");
    return { ...answer, notes: [...notes, { file, code: "no-router", text: `${MISSING}: choose another measure for ${names}.` }] };
  }
  const straight = { name: "second distance", from: "great_circle" };
  const text = `${MISSING}: both objectives are straight lines, so one tour is the best under both. A column of costs would be a second objective.`;
  return {
    ...answer,
    request: { ...request, objectives: request.objectives.map((each) => (isRoad(each) ? straight : each)) },
    notes: [...notes.filter((note) => note !== chosen), { ...chosen, text }],
  };
}

const isRoad = ({ from }) => ["road_time", "road_distance"].includes(from);
