/** A Leaflet map of plain coordinates, moved and zoomed by mouse and keyboard. */

import "../vendor/leaflet/leaflet.js";
import { made, svgElement } from "../common/elements.js";

const { L } = globalThis;
const BY_FINGER = matchMedia("(pointer: coarse)").matches;

/** How a map is fitted to its bounds: with room beside them. */
export const fitting = (room) => ({ padding: [room, room], animate: false });

/** A ring around a place, in the style of this name, to be put on a map. */
export function ring(name, side) {
  const icon = L.divIcon({ className: `ring ${name}`, iconSize: [side, side], tooltipAnchor: [0, -side / 2] });
  return L.marker([0, 0], { icon, interactive: false, keyboard: false });
}

/** Says something beside a marker, on the side where the map has room for it. */
export function sayAt(marker, said) {
  const tip = marker.bindTooltip(said, { permanent: true, direction: "top" }).openTooltip().getTooltip();
  const [box, map] = [tip.getElement(), marker._map.getContainer()].map((each) => each.getBoundingClientRect());
  if (box.left < map.left) tip.options.direction = "right";
  else if (box.right > map.right) tip.options.direction = "left";
  else if (box.top < map.top) tip.options.direction = "bottom";
  tip.update();
}

const PANES = { streets: 300, tours: 350, stops: 400, names: 450 };

/**
 * A map with panes for streets, tours, stops and names, each above the one before. Its buttons are in the caption of its
 * figure, where they hide no stop: those that zoom, unless two fingers do, and one that fits the map to all of it.
 *
 * @param {{ name: string, fit: () => void }} whole the name of the last button, and what it does
 */
export function flatMap(element, whole, options) {
  const map = L.map(element, {
    crs: L.CRS.Simple,
    attributionControl: false,
    zoomAnimation: false,
    zoomControl: false,
    zoomSnap: 0,
    scrollWheelZoom: false, // the wheel scrolls the page
    dragging: !BY_FINGER, // so does one finger
    ...options,
  });
  element.closest("figure").querySelector("figcaption").append(buttonsOf(map, whole));
  for (const [name, height] of Object.entries(PANES)) map.createPane(name).style.zIndex = height;
  return map;
}

function buttonsOf(map, { name, fit }) {
  const buttons = BY_FINGER ? made("div", { className: "leaflet-bar" }) : L.control.zoom().addTo(map).getContainer();
  const button = made("button", { type: "button", className: "fit", title: name, ariaLabel: name, onclick: fit });
  const corners = svgElement("svg", { viewBox: "0 0 14 14", width: 14, height: 14, "aria-hidden": "true" });
  corners.append(svgElement("path", { d: "M1 5V1h4M9 1h4v4M13 9v4H9M5 13H1V9" }));
  button.append(corners);
  buttons.append(button);
  return buttons;
}
