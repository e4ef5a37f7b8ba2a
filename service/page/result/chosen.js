/** Carry the selected tour or plan in a link, and show it where the service no longer keeps its front. */

import { kindNamed } from "../common/kinds.js";

const MOST_POINTS = 30; // of a front, which a link carries: 60 numbers
const DIGITS = 5; // of each
const NUMBERS = ["angle", "departure", "kept"];

/**
 * The selected tour or plan of an answer, with what it takes to draw it. A tour leaves out the names of its
 * stops if the request is `known`: they follow from their numbers. `points` are the lengths of some of its front, if there are two.
 */
export function chosenOf({ kind, closed, places, front, among }, item, known) {
  const { stops, ...numbered } = item;
  return { kind, closed, places, item: known ? numbered : item, points: among ?? pointsOf(front) };
}

/** The lengths of at most so many tours of a front, both ends among them, as a chart can show; undefined unless there are two. */
export function pointsOf(front) {
  if (front.length < 2 || front[0].lengths.length !== 2) return undefined;
  const last = Math.min(front.length, MOST_POINTS) - 1;
  const shown = Array.from({ length: last + 1 }, (_, at) => front[Math.round((at * (front.length - 1)) / last)]);
  return shown.map(({ lengths }) => lengths.map((value) => Number(value.toPrecision(DIGITS))));
}

/**
 * An answer with nothing but the tour or plan of a link; null if the link has none, or one that does not fit
 * the request: links come from anywhere.
 *
 * @param {{ id: string, asked: { chosen?: object, objectives?: object[] } | null }} link as of `linked`
 * @param {object} instance the request, as far as it is known
 * @param {string[] | null} ids the names of its stops
 */
export function keptAnswer({ id, asked }, instance, ids) {
  const { chosen, objectives } = asked ?? {};
  const known = { ids, cities: citiesIn(instance, chosen) };
  if (!isSound(chosen, known) || !isNamed(objectives, chosen.item.lengths.length)) return null;
  const { kind, closed, places } = chosen;
  const among = arePoints(chosen.points) ? chosen.points : undefined;
  return { id, kind, closed, places, objectives, kept: true, stops: instance.stops, points: 1, among, front: [withNames(chosen.item, ids)] };
}

/** The index in a front of the tour or plan of a link; -1 if it is not there. */
export function placeIn(front, wanted) {
  const sought = orderOf(wanted);
  return front.findIndex((item) => orderOf(item) === sought);
}

/** What makes a tour or plan what it is: its stops in their order, by whom, and when it leaves. */
const orderOf = ({ departure, tour, stops, routes }) =>
  JSON.stringify(routes?.map(({ vehicle, robot, shift, stops: visited, tour: visits }) => [vehicle, robot, shift, visited ?? visits]) ?? [departure, stops ?? tour]);

const withNames = (item, ids) => (ids && item.tour ? { ...item, stops: item.tour.map((city) => ids[city]) } : item);

/** How many places the tours of a request go through; Infinity if that is not known. */
const citiesIn = ({ coordinates, stops, matrices, grid }, chosen) =>
  (grid ? chosen?.places : (coordinates ?? stops ?? matrices?.[0]))?.length || Infinity;

const isNamed = (objectives, count) =>
  Array.isArray(objectives) && objectives.length === count && objectives.every((each) => each?.name && typeof each.name === "string");

function isSound(chosen, known) {
  const kind = typeof chosen?.kind === "string" ? kindNamed(chosen) : null;
  const { item, places } = chosen ?? {};
  if (!kind?.noun || !isRow(item?.lengths) || item.lengths.length < 2 || item.lengths.length > 4) return false;
  if (!isMeasured(item) || (kind.onGrid && !isRows(places))) return false;
  return kind.movers ? isPlan(item, kind.movers, known) : isTour(item, kind, known);
}

/** Whether all that is said of a tour or plan beside its stops is numbers. */
const isMeasured = (item) => isRow(NUMBERS.map((name) => item[name] ?? 0)) && isPlaced(item);

/** Whether it says where it stands in its front: by a balance under two objectives, by losses under more. */
const isPlaced = ({ lengths, balance, losses }) =>
  lengths.length === 2 ? Number.isFinite(balance) : isRow(losses) && losses.length === lengths.length;

const isTour = ({ tour, stops, times, path }, { onGrid }, known) =>
  isVisits(tour, known) && isTexts(stops, tour) && isAlong(times, known.cities) && (!onGrid || isPath(path));

const isPlan = ({ lengths, routes, measures = {}, unassigned = [] }, movers, known) =>
  Array.isArray(routes) && isRow(Object.values(measures)) && isTexts(unassigned, unassigned) && routes.every((route) => isRoute(route, lengths, movers, known));

function isRoute(route, lengths, { by, through }, known) {
  if (typeof route?.[by] !== "string" || !isRow(route.lengths) || route.lengths.length !== lengths.length) return false;
  if (through === "tour") return isVisits(route.tour, known) && isPath(route.path);
  const { stops, arrivals } = route;
  return Array.isArray(stops) && isTexts(stops, stops) && (!known.ids || stops.every((stop) => known.ids.includes(stop))) && isAlong(arrivals, stops.length);
}

const isVisits = (tour, { cities }) =>
  Array.isArray(tour) && tour.length > 0 && tour.every((city) => Number.isInteger(city) && city >= 0 && city < cities);
const isTexts = (texts, beside) =>
  texts === undefined || (Array.isArray(texts) && texts.length === beside.length && texts.every((text) => typeof text === "string"));
const arePoints = (points) => isRows(points) && points.length > 1 && points.length <= MOST_POINTS && points.every(({ length }) => length === 2);
const isRow = (row) => Array.isArray(row) && row.every(Number.isFinite);
const isRows = (rows) => Array.isArray(rows) && rows.every(isRow);
const isPath = (path) => isRows(path?.cells);
const isAlong = (times, most) => times === undefined || (isRow(times) && times.length <= most + 1);
