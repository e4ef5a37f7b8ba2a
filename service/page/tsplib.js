/** TSPLIB files: one gives the positions of the cities in a plane. */

const POSITION = /^\s*\d+\s+(\S+)\s+(\S+)\s*$/;

export const isTsplib = (text) => /^\s*(EDGE_WEIGHT_TYPE|NODE_COORD_SECTION)\b/m.test(text);

/** The instance of two files about the same cities, the first objective's first. */
export function pair([first, second]) {
  const planes = [positions(first), positions(second)];
  if (planes[0].length !== planes[1].length) {
    const came = `${planes[0].length} and ${planes[1].length}`;
    throw new Error(`two TSPLIB files must have as many cities, got ${came}`);
  }
  return { coordinates: planes[0].map((place, city) => [...place, ...planes[1][city]]) };
}

function positions({ name, text }) {
  const section = text.split(/^\s*NODE_COORD_SECTION\s*:?\s*$/m)[1];
  if (section === undefined) throw new Error(`${name} must have a NODE_COORD_SECTION, got none`);
  const places = [];
  for (const line of section.trim().split(/\r?\n/)) {
    const found = POSITION.exec(line);
    if (!found) break;
    places.push([Number(found[1]), Number(found[2])]);
  }
  return places;
}
