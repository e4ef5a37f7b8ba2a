/** Show the rest of a tour or of a fleet's day that a link names. */

import { kindOf } from "../common/kinds.js";
import { Way } from "../planning/replanning.js";
import { FleetRest } from "./rest.js";

/**
 * The way by which the front of a link is shown; null if the front was not replanned.
 *
 * @param {{ request?: object, rest?: object } | null} carried by the link
 * @param {{ asked: object, instance: object, ids: string[] | null }} input the form, which shows the request of the link
 */
export function restIn(carried, { asked, instance, ids }) {
  if (!carried?.rest || !carried.request) return null;
  return kindOf(asked).path === "fleet" ? FleetRest.of(asked, carried.rest) : Way.of(instance, ids, carried.rest);
}
