/** Maps as parts of a picture: places, lines through them, and discs where these start; all in x and y. */

const SELECTED = { colour: "selected", dash: [] };
const DASHED = { colour: "pinned", dash: [5, 5] };

export const styleOfTour = (dashed) => (dashed ? DASHED : SELECTED);

/** The map of stops, with tours `{ cities, dashed }`, the last one selected; `lineOf` returns the line of a way. */
export function pictureOfTours(places, tours, lineOf) {
  const lines = tours.map(({ cities, dashed }) => ({ places: lineOf(cities), ...styleOfTour(dashed) }));
  return { places: places.filter(Boolean), lines, starts: startsOf(lines.slice(-1)) };
}

/** The map of stops at these places, with the routes of a plan, each `{ name, stops, style }`. */
export function pictureOfRoutes(places, routes, lineOf) {
  const lines = routes.map(({ name, stops, style }) => ({ name, places: lineOf(stops), ...style, cased: true }));
  const starts = [...new Set(routes.map(({ stops }) => stops[0]))];
  return { places, lines, starts: starts.map((stop) => ({ place: places[stop], colour: "ink" })) };
}

/** A disc in the colour of each line. */
export const startsOf = (lines) => lines.map(({ places, colour }) => ({ place: places[0], colour }));
