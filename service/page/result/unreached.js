/** Say how much of a robot's map no path leads to, and where; the boxes on the map have the same letters. */

import { counted, length } from "../common/numbers.js";
import { letterOf } from "../map/gridmap.js";

const element = (id) => document.getElementById(id);
const SAID = 2; // regions in the sentence

/** Shows what the service says of these cells; nothing without any. It describes the largest of very many regions. */
export function showUnreached(uncovered, side) {
  const regions = uncovered?.cells ? uncovered.regions : [];
  element("uncovered").textContent = regions.length ? sentence(uncovered, side) : "";
  element("unreached").hidden = regions.length <= SAID;
  element("unreached-list").replaceChildren(...regions.map((region) => Object.assign(document.createElement("li"), { textContent: described(region, side) })));
}

function sentence({ cells, square_metres, regions }, side) {
  const known = regions.reduce((sum, region) => sum + region.cells, 0);
  const where = `${known < cells ? "more than " : ""}${counted(regions.length, "region", "regions")}`;
  const all = `${length(square_metres)} m² (${counted(cells, "cell", "cells")}) in ${where} cannot be reached`;
  if (regions.length === 1 && known === cells) return `${all}: ${letterOf(0)}, ${place(regions[0])}.`;
  const largest = regions.slice(0, SAID).map((region, at) => `${letterOf(at)}, ${described(region, side)}`).join("; ");
  return `${all}${regions.length > SAID ? ", the largest" : ""}: ${largest}.`;
}

/** The area and the place of a region, counted from 1. */
const described = (region, side) => `${length(region.cells * side ** 2)} m² in ${place(region)}`;

const place = ({ box: [first, last] }) => `${span("row", first[0], last[0])}, ${span("column", first[1], last[1])}`;

const span = (one, from, to) => (from === to ? `${one} ${from + 1}` : `${one}s ${from + 1} to ${to + 1}`);
