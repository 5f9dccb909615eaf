/** Cars, or trips, ranked by how near they are driven to their best drives. */

import { get, query } from "../core/api.js";
import { checked, h, show } from "../core/dom.js";
import { km, litres, number } from "../core/format.js";
import { guarded } from "../core/notify.js";
import { paged, table } from "../core/ui.js";

const ROWS = 10;

function row(one, place) {
  const share = (100 * one.saved_l) / one.fuel_l;
  const name = one.trip_id ? [h("a", { href: `/trips/${one.trip_id}#score` }, one.trip_name), h("span", { class: "quiet" }, ` ${one.car_name}`)] : h("a", { href: `/cars/${one.car_id}` }, one.car_name);
  const n = (...content) => h("td", { class: "n" }, ...content);
  return h("tr", {}, n(number(place)), h("th", { scope: "row" }, name), n(h("strong", {}, number(one.score)), h("span", { class: "quiet" }, ` ±\u202f${number(one.score_sd, 1)}`)),
    n(litres(one.saved_l)), n(`${number(share, 1)}\u202f%`), n(number(one.trips)), n(km(one.distance_m)));
}

/** Wire a section that stays hidden while nothing is ranked; returns what fills and renews it. */
export function ranking(section, place, more) {
  const draw = async () => {
    const by = checked("rank-by");
    let count = 0;
    await paged((cursor) => get(`scores${query({ by, limit: ROWS, cursor })}`), (items, first) => {
      if (first) {
        count = 0;
        const th = (text, kind) => h("th", { scope: "col", class: kind }, text);
        show(place, table(by === "car" ? "Cars, the best driven first" : "Trips, the best driven first",
          h("tr", {}, th("", "n"), th(by === "car" ? "Car" : "Trip"), th("Score", "n"), th("Could have saved", "n"), th("of its fuel", "n"), th("Trips", "n"), th("Scored", "n")), []));
      }
      place.querySelector("tbody").append(...items.map((one) => row(one, (count += 1))));
      if (first) section.hidden = items.length === 0;
    }, more);
  };
  section.addEventListener("change", (event) => event.target.name === "rank-by" && guarded(draw));
  return draw;
}
