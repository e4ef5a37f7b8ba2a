/** Read a FeatureCollection of points (GeoJSON, RFC 7946) as the stops of a request. */

import { MEASURED } from "./columns.js";

const STRUCTURE = ["type", "features", "bbox"]; // of every collection; other members are the request's

export const isCollection = (given) => given?.type === "FeatureCollection";

/** The request whose stops are the points. Where a feature is none, or has no id, an Error names it. */
export function stopsOf(name, collection) {
  const { features } = collection;
  if (!Array.isArray(features)) throw new Error(`${name} must have a list of features`);
  const stops = features.map((feature, number) => stop(feature, `features/${number} of ${name}`));
  const members = Object.entries(collection).filter(([member]) => !STRUCTURE.includes(member));
  return { objectives: MEASURED, ...Object.fromEntries(members), stops };
}

function stop(feature, where) {
  const { type, coordinates } = feature?.geometry ?? {};
  if (type !== "Point" || !Array.isArray(coordinates) || coordinates.length < 2) {
    throw new Error(`${where} must be a Point with a longitude and a latitude`);
  }
  return { id: idOf(feature, where), location: coordinates.slice(0, 2) };
}

function idOf({ id, properties }, where) {
  const found = [id, properties?.id, properties?.name].find((each) => ["string", "number"].includes(typeof each));
  if (found === undefined) throw new Error(`${where} must have an id, or a property id or name`);
  return String(found);
}
