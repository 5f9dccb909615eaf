/** A car at a glance: its best efficiency, where, and how much it has driven. */

import { h } from "../core/dom.js";
import { km, measure, number, percent, plural } from "../core/format.js";

/** Mean consumption over the trips whose fuel is known. */
export const average = (car) => measure(car.litres_per_100km, "L/100 km", 1);

/** The card of a car; `heading` is the level that fits the page. */
export function carCard(car, heading = "h3") {
  const best = car.latest_map?.best;
  return h("a", { class: "card car-card", href: `/cars/${car.id}` },
    h(heading, {}, car.name),
    h("div", { class: "best" }, best
      ? [h("strong", {}, percent(best.efficiency)), h("span", { class: "quiet" }, `best, at ${number(best.rpm)} rpm and ${number(best.nm)} Nm`)]
      : [h("strong", { class: "quiet" }, "–"), h("span", { class: "quiet" }, "no efficiency map yet")]),
    h("dl", { class: "pairs" },
      h("dt", {}, plural(car.trip_count, "trip")), h("dd", {}, km(car.distance_m)),
      h("dt", {}, "Average"), h("dd", {}, average(car))));
}
