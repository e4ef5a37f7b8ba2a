/** Say of a request for ways by road that the service has no routing engine, before it is planned. */

const MISSING = "This service has no routing engine, which knows ways by road";

/** What was read, with straight lines where the reader chose roads; where the file asks for them, with a note. */
export function withoutRoads(answer) {
  const { request, notes, name: file } = answer;
  const asked = request.objectives?.filter?.(isRoad) ?? [];
  if (!asked.length) return answer;
  const chosen = notes.find(({ code }) => code === "objectives");
  if (!chosen) {
    const names = asked.map(({ name }) => `“${name}”`).join(" and ");
    return { ...answer, notes: [...notes, { file, code: "no-router", text: `${MISSING}: have ${names} measured otherwise.` }] };
  }
  const straight = { name: "second distance", from: "great_circle" };
  const text = `${MISSING}: both objectives are straight lines, of which one tour is the best. A column of costs would be a second objective.`;
  return {
    ...answer,
    request: { ...request, objectives: request.objectives.map((each) => (isRoad(each) ? straight : each)) },
    notes: [...notes.filter((note) => note !== chosen), { ...chosen, text }],
  };
}

const isRoad = ({ from }) => ["road_time", "road_distance"].includes(from);
