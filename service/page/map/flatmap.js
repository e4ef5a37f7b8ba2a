/** A Leaflet map of plain coordinates, moved and zoomed by mouse and keyboard. */

import "../vendor/leaflet/leaflet.js";

const { L } = globalThis;
const BY_FINGER = matchMedia("(pointer: coarse)").matches;

/** How a map is fitted to its bounds: with room beside them. */
export const fitting = (room) => ({ padding: [room, room], animate: false });

/** A ring around a place, in the style of this name, to be put on a map. */
export function ring(name, side) {
  const icon = L.divIcon({ className: `ring ${name}`, iconSize: [side, side], tooltipAnchor: [0, -side / 2] });
  return L.marker([0, 0], { icon, interactive: false, keyboard: false });
}

const PANES = { streets: 300, tours: 350, stops: 400, names: 450 };

/** A map with panes for streets, tours, stops and names, each above the one before; its zoom buttons are in the caption of its figure, where they hide no stop. */
export function flatMap(element, options) {
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
  if (!BY_FINGER) element.closest("figure").querySelector("figcaption").append(L.control.zoom().addTo(map).getContainer());
  for (const [name, height] of Object.entries(PANES)) map.createPane(name).style.zIndex = height;
  return map;
}
